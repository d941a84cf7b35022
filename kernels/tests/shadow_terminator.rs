//! Where light ends on coarse meshes with smooth normals.

mod common;
mod shading;

use common::Source;
use huygens_kernels::interpolate::terminator;
use huygens_kernels::lanes::Fx;
use huygens_kernels::octahedral;
use shading::{Patch, ROUNDING, direction, dot, plus, splat, wide};

#[test]
fn the_terminator_factor_is_that_of_its_formula() {
    let mut source = Source(7);
    for _ in 0..20_000 {
        let (geometric, g) = splat(direction(&mut source));
        let (shading, n) = splat(plus(direction(&mut source), 1.2, g));
        let (omega_i, i) = splat(direction(&mut source));
        let coherence = 1.0 - 0.3 * source.unit();
        let found = terminator(shading, geometric, omega_i, Fx::splat(coherence));
        let found = f64::from(found.as_array()[4]);
        assert!((0.0..=1.0).contains(&found));
        let (cos, cos_alpha) = (dot(n, i), dot(g, n) * f64::from(coherence));
        if dot(g, i) <= 0.0 {
            assert_eq!(found, 0.0, "light from below");
            continue;
        }
        if cos.abs() < 1e-2 || cos_alpha.abs() < 1e-2 {
            continue;
        }
        let tan = |cos: f64| (1.0 - cos * cos).max(0.0).sqrt() / cos;
        let ratio = (2.0 - 2.0 * tan(cos) * tan(cos_alpha)).clamp(0.0, 1.0);
        let expected = if cos > 0.0 && cos_alpha > 0.0 {
            ratio * (ratio * (1.0 - ratio) + 1.0)
        } else {
            0.0
        };
        // Squares of cosines are off by 8 roundings, the product of sines by the root of that where
        // it vanishes, all of it twice over the product of cosines; the cubic's slope is at most 4/3.
        let bound = 4.0 * (8.0 * ROUNDING).sqrt() * tan(cos).max(tan(cos_alpha)).abs().max(1.0);
        assert!(
            (found - expected).abs() <= bound / (cos * cos_alpha).abs(),
            "{found} {expected}"
        );
    }
}

/// Radiance over a coarse globe with normals of the sphere under a light far away, as a diffuse
/// surface shows it, at points along its equator: with the factor; without it; of the sphere.
fn globe(segments: u32, phase: f64) -> Vec<(f64, f64, f64)> {
    let point = |longitude: f64, latitude: f64| {
        let a = longitude / f64::from(segments) * std::f64::consts::TAU;
        [
            a.cos() * latitude.cos(),
            latitude.sin(),
            -a.sin() * latitude.cos(),
        ]
    };
    let (light, l) = splat(point(phase, 0.1));
    let mut seen = Vec::new();
    for i in 0..2 * segments {
        // Triangles about the equator, tip up and tip down, each from the middle of its western slope
        // to that of its eastern one.
        let (west, height) = (0.5 * f64::from(i), 1.0 / f64::from(segments));
        let up = i % 2 == 0;
        let corners = if up {
            [(0.0, -height), (1.0, -height), (0.5, height)]
        } else {
            [(0.5, -height), (1.0, height), (0.0, height)]
        };
        let corners = corners.map(|(longitude, latitude)| point(west + longitude, latitude));
        let patch = Patch {
            vertices: corners.map(|p| p.map(|c| c as f32)),
            normals: corners.map(octahedral::encode).to_vec(),
            uvs: vec![],
        };
        let (geometric, g) = splat(patch.flat());
        assert!(dot(g, corners[0]) > 0.0, "wound inwards");
        for k in 0..=64 {
            let u = 0.5 * k as f32 / 64.0;
            let at = patch.at(u, if up { 0.5 } else { 0.5 - u });
            let cos = dot(wide(at.normal.lane(0)), l).max(0.0);
            let factor = terminator(at.normal, geometric, light, at.coherence);
            let hard = if dot(g, l) > 0.0 { cos } else { 0.0 };
            seen.push((cos * f64::from(factor.as_array()[0]), hard, cos));
        }
    }
    seen
}

/// On globes of several finenesses: never brighter than the sphere, dark only within the strip where
/// triangles can be, and no edge of a triangle where light falls off at once.
#[test]
fn a_coarse_globe_has_no_hard_terminator() {
    for segments in [12, 24, 48] {
        let (mut soft_step, mut hard_step) = (0.0f64, 0.0f64);
        let (mut soft, mut whole) = (0.0, 0.0);
        // A slope leans by a quarter of a segment against its triangle's middle, a corner by half of
        // one, in longitude, and by 1 / segments in latitude.
        let alpha = (std::f64::consts::PI + 1.0) / f64::from(segments);
        for phase in 0..8 {
            let seen = globe(segments, f64::from(phase) / 16.0);
            for pair in seen.windows(2) {
                soft_step = soft_step.max((pair[0].0 - pair[1].0).abs());
                hard_step = hard_step.max((pair[0].1 - pair[1].1).abs());
            }
            for (shown, _, sphere) in seen {
                assert!(shown <= sphere);
                // tan theta tan alpha is below 1/2 there: but for rounding, nothing is taken.
                if sphere > (1.0 / (2.0 * alpha.tan())).atan().cos() {
                    assert!(shown >= sphere * (1.0 - 1e-6), "{shown} {sphere}");
                }
                soft += shown;
                whole += sphere;
            }
        }
        println!(
            "{segments} segments: steps {soft_step:.4} with the factor, {hard_step:.4} without; \
             {:.4} of the sphere's light",
            soft / whole
        );
        // Points lie 1/128 of a segment apart. What is shown has a slope of 1 by the cosine and, where
        // the factor is not 1, of at most 4/3 * 2 tan(alpha) / cos^2(theta) times the cosine, which is
        // at least sin(alpha): below 4.
        let apart = std::f64::consts::TAU / f64::from(segments) / 128.0;
        assert!(soft_step <= 4.0 * apart, "{segments}: {soft_step}");
        // Which without the factor does not hold.
        assert!(hard_step > 4.0 * apart, "the light does not try it");
    }
}
