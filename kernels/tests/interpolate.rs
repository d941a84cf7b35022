//! Shading normals: the formulas, and what they promise where meshes are coarse, odd or broken.

mod common;
mod shading;

use common::Source;
use huygens_kernels::interpolate::{HORIZON, towards};
use huygens_kernels::lanes::{Fx, Ux};
use huygens_kernels::octahedral;
use huygens_kernels::vec3::Vec3x;
use shading::{Patch, ROUNDING, V, cross, direction, dot, plus, splat, unit, wide};

fn decode(code: u32) -> V {
    wide(octahedral::decode(Ux::splat(code)).lane(0))
}

#[test]
fn normals_survive_their_codes() {
    let mut source = Source(1);
    let mut worst = 0.0f64;
    let axes = (0..27).map(|i| [i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1].map(f64::from));
    let axes = axes.filter(|v| dot(*v, *v) > 0.0);
    let random = (0..100_000).map(|_| direction(&mut source));
    for v in axes.chain(random) {
        let v = unit(v);
        let code = octahedral::encode(v);
        assert_ne!(code, octahedral::NONE);
        for scale in [2f64.powi(-900), 2f64.powi(900)] {
            assert_eq!(octahedral::encode(v.map(|c| c * scale)), code);
        }
        let off = cross(decode(code), v);
        worst = worst.max(dot(off, off).sqrt());
    }
    assert!(worst < 7e-5, "{worst}");
    for axis in [
        [1.0, 0.0, 0.0],
        [0.0, -1.0, 0.0],
        [0.0, 0.0, 1.0],
        [0.0, 0.0, -1.0],
    ] {
        assert_eq!(decode(octahedral::encode(axis)), axis);
    }
    for none in [[0.0; 3], [f64::NAN, 0.0, 1.0], [f64::INFINITY, 0.0, 0.0]] {
        assert_eq!(octahedral::encode(none), octahedral::NONE);
    }
}

fn assert_near(found: V, expected: V, bound: f64, what: &str) {
    let off = plus(found, -1.0, expected);
    assert!(
        dot(off, off).sqrt() <= bound,
        "{what}: {found:?} {expected:?} {bound}"
    );
}

#[test]
fn normals_are_mixed_by_weights_on_the_side_of_the_front() {
    let mut source = Source(2);
    for i in 0..2000 {
        let patch = Patch::random(&mut source, [1e-15, 1.0, 1e12][i % 3]);
        let flat = patch.flat();
        let [e1, e2] = patch.edges();
        let sine = dot(cross(unit(e1), unit(e2)), flat);
        if sine < 1e-2 {
            continue;
        }
        let (u, v) = (source.unit(), source.unit());
        let (u, v) = if u + v > 1.0 {
            (1.0 - u, 1.0 - v)
        } else {
            (u, v)
        };
        let [a, b, c] = [0, 1, 2].map(|k| decode(patch.normals[k]));
        let (s, t) = (f64::from(u), f64::from(v));
        let mixed = plus(plus(a.map(|x| x * (1.0 - s - t)), s, b), t, c);
        let length = dot(mixed, mixed).sqrt();
        // The flat normal's own error (edges of few roundings, over the sine) decides the side.
        if length < 1e-3 || dot(mixed, flat).abs() < 1e-4 {
            continue;
        }
        let expected = unit(mixed).map(|x| x * dot(mixed, flat).signum());
        let found = patch.at(u, v);
        // Ten roundings of terms of at most 1, over the length.
        assert_near(
            wide(found.normal.lane(3)),
            expected,
            16.0 * ROUNDING / length,
            "normal",
        );
        let [x, y] = found.uv.map(|x| f64::from(x.as_array()[5]));
        for (found, i) in [(x, 0), (y, 1)] {
            let [p, q, r] = [0, 1, 2].map(|k| f64::from(patch.uvs[k][i]));
            let exact = p + s * (q - p) + t * (r - p);
            assert!((found - exact).abs() <= 6.0 * ROUNDING, "{found} {exact}");
        }
    }
}

#[test]
fn what_a_triangle_lacks_is_replaced() {
    let mut source = Source(3);
    let whole = Patch::random(&mut source, 1.0);
    let flat = wide(
        Patch {
            normals: vec![],
            ..Patch::random(&mut Source(3), 1.0)
        }
        .at(0.2, 0.3)
        .normal
        .lane(0),
    );
    assert_near(flat, whole.flat(), 16.0 * ROUNDING, "no table");
    for broken in 0..3 {
        let mut patch = Patch::random(&mut Source(3), 1.0);
        patch.normals[broken] = octahedral::NONE;
        patch.uvs[broken] = [f32::NAN; 2];
        let found = patch.at(0.2, 0.3);
        assert_eq!(wide(found.normal.lane(0)), flat);
        assert_eq!(found.uv.map(|x| x.as_array()[0]), [0.0; 2]);
        assert_eq!(found.uv_per_length.as_array()[0], 0.0);
        assert_eq!(found.gradient_u.lane(0), [0.0; 3]);
        // A frame all the same.
        let (t, b) = (wide(found.tangent.lane(0)), wide(found.bitangent.lane(0)));
        assert!((dot(t, t) - 1.0).abs() < 1e-6 && dot(t, flat).abs() < 1e-6);
        assert_near(b, cross(flat, t), 1e-6, "bitangent");
    }
    let mut short = Patch::random(&mut Source(3), 1.0);
    short.normals.truncate(2);
    assert_eq!(wide(short.at(0.2, 0.3).normal.lane(0)), flat);
    // Normals that cancel: the middle between opposite ones.
    let mut opposite = Patch::random(&mut Source(3), 1.0);
    opposite.normals = [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]
        .map(octahedral::encode)
        .to_vec();
    assert_eq!(wide(opposite.at(0.5, 0.0).normal.lane(0)), flat);
    // Equal corners in (u, v).
    let mut point = Patch::random(&mut Source(3), 1.0);
    point.uvs = vec![[0.25, 0.5]; 3];
    let found = point.at(0.2, 0.3);
    assert_eq!(found.uv.map(|x| x.as_array()[0]), [0.25, 0.5]);
    assert!(wide(found.tangent.lane(0)).iter().all(|c| c.is_finite()));
    assert_eq!(found.gradient_v.lane(0), [0.0; 3]);
}

/// Where (u, v) are linear in the position, the frame and gradients are known, whatever the
/// triangle, its scale and its winding.
#[test]
fn gradients_and_tangents_of_a_linear_map() {
    let mut source = Source(4);
    for i in 0..600 {
        let scale = [1e-12f32, 1.0, 1e12][i % 3];
        let mut patch = Patch::random(&mut source, 1.0);
        let [e1, e2] = patch.edges();
        let flat = patch.flat();
        let sine = dot(cross(unit(e1), unit(e2)), flat);
        if sine < 0.05 {
            continue;
        }
        let (gu, gv) = (direction(&mut source), direction(&mut source));
        let in_plane = |g: V| plus(g, -dot(g, flat), flat);
        let (gu, gv) = (in_plane(gu), in_plane(gv));
        let determinant = dot(cross(gu, gv), flat);
        if determinant.abs() < 0.05 {
            continue;
        }
        patch.uvs = patch
            .vertices
            .map(|p| [dot(wide(p), gu) as f32, dot(wide(p), gv) as f32])
            .to_vec();
        patch.normals = vec![octahedral::encode(flat); 3];
        patch.vertices = patch.vertices.map(|p| p.map(|c| c * scale));
        let found = patch.at(0.3, 0.3);
        // Corners are rounded to 1, (u, v) to 2 roundings of 1; differences of both are divided by
        // the triangle's shape once, and frames by the map's.
        let bound = 64.0 * ROUNDING / (sine * determinant.abs());
        let down = |v: Vec3x| wide(v.lane(1)).map(|c| c * f64::from(scale));
        assert_near(down(found.gradient_u), gu, bound, "gradient of u");
        assert_near(down(found.gradient_v), gv, bound, "gradient of v");
        let per = f64::from(found.uv_per_length.as_array()[0]) * f64::from(scale);
        assert!(
            (per / determinant.abs().sqrt() - 1.0).abs() <= bound,
            "{per}"
        );
        // u rises along the tangent at equal v; the normal is off by its code.
        let t = wide(found.tangent.lane(1));
        let along = unit(cross(gv, flat)).map(|c| c * determinant.signum());
        assert_near(t, along, bound + 1e-4, "tangent");
        let b = wide(found.bitangent.lane(1));
        assert!(dot(b, gv) > 0.0 && dot(b, t).abs() < 1e-6);
    }
}

#[test]
fn a_flat_normal_map_and_a_level_bump_change_nothing() {
    let mut source = Source(5);
    for _ in 0..100 {
        let patch = Patch::random(&mut source, 1.0);
        let found = patch.at(0.25, 0.5);
        let normal = wide(found.normal.lane(0));
        let up = found.mapped(Vec3x::splat([0.5, 0.5, 1.0]), Fx::splat(3.0));
        assert_near(wide(up.lane(0)), normal, 4.0 * ROUNDING, "map");
        let level = found.bumped(Fx::ZERO, Fx::ZERO);
        assert_near(wide(level.lane(0)), normal, 4.0 * ROUNDING, "bump");
        // The texel of +x is the tangent, and 0 of it, by strength 0, the normal.
        let x = found.mapped(Vec3x::splat([1.0, 0.5, 0.5]), Fx::ONE);
        assert_near(
            wide(x.lane(0)),
            wide(found.tangent.lane(0)),
            4.0 * ROUNDING,
            "tangent",
        );
        let none = found.mapped(Vec3x::splat([1.0, 0.0, 0.5]), Fx::ZERO);
        assert_near(wide(none.lane(0)), normal, 0.0, "no direction");
    }
}

/// A slope of 1 in x: the normal leans against it by 45 degrees.
#[test]
fn a_bump_map_is_the_normal_of_the_displaced_surface() {
    let patch = Patch {
        vertices: [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]],
        normals: vec![],
        uvs: vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]],
    };
    // The height rises by 2 over u = 0..1, which is 2 scene units.
    let bent = patch.at(0.1, 0.1).bumped(Fx::splat(2.0), Fx::ZERO);
    let half = 0.5f64.sqrt();
    assert_near(
        wide(bent.lane(0)),
        [-half, 0.0, half],
        8.0 * ROUNDING,
        "slope",
    );
}

#[test]
fn mirror_directions_leave_the_surface() {
    let mut source = Source(6);
    let mut bent = 0;
    for i in 0..20_000 {
        let (geometric, g) = splat(direction(&mut source));
        let mut o = direction(&mut source);
        // A third of them grazing.
        if i % 3 == 0 {
            o = plus(plus(o, -dot(o, g), g), f64::from(source.unit()) * 1e-3, g);
        }
        let (omega_o, o) = splat(o.map(|c| c * dot(o, g).signum()));
        let cos = dot(o, g);
        if cos <= 2f64.powi(-14) {
            continue;
        }
        let n = direction(&mut source);
        let (shading, n) = splat(if i % 2 == 0 { plus(n, 1.5, g) } else { n });
        let found = wide(towards(shading, geometric, omega_o).lane(2));
        let mirror = |n: V| plus(o.map(|c| -c), 2.0 * dot(n, o), n);
        let least = f64::from(HORIZON) * cos;
        assert!((dot(found, found) - 1.0).abs() < 8.0 * ROUNDING);
        assert!(dot(found, o) > 0.0, "{g:?} {o:?} {n:?}");
        let height = dot(mirror(found), g);
        assert!(height > 0.0, "{g:?} {o:?} {n:?}");
        if cos > 2f64.powi(-10) {
            assert!(height >= 0.5 * least, "{g:?} {o:?} {n:?}");
        }
        // Each cosine is off by a few roundings.
        let rounding = 12.0 * ROUNDING;
        if dot(n, g) > rounding && dot(n, o) > rounding && dot(mirror(n), g) > least + rounding {
            assert_eq!(found, n, "changed without need");
        } else if dot(n, g) < -rounding
            || dot(n, o) < -rounding
            || dot(mirror(n), g) < least - rounding
        {
            bent += 1;
            // Not further than to the horizon.
            assert!(height <= 2.0 * least + rounding, "{height} {least}");
        }
    }
    assert!(bent > 2000, "{bent}");
    // Straight on, with a normal that faces away: nothing is left but the geometric one.
    let (up, g) = splat([0.0, 0.0, 1.0]);
    let found = towards(Vec3x::splat([0.0, 0.0, -1.0]), up, up);
    assert_near(wide(found.lane(0)), g, 4.0 * ROUNDING, "straight");
}

/// Normals that lean away from omega_o, further and further: the bent ones follow without a jump,
/// so that ten times smaller steps give ten times smaller steps, or nearly.
#[test]
fn bending_begins_smoothly() {
    let (up, _) = splat([0.0, 0.0, 1.0]);
    let largest = |degrees: f64, steps: u32| {
        let o = degrees.to_radians();
        let (omega_o, _) = splat([o.sin(), 0.0, o.cos()]);
        let normal = |i: u32| {
            let a = 1.5 * f64::from(i) / f64::from(steps);
            let (shading, _) = splat([-a.sin(), 0.3 * a, a.cos()]);
            wide(towards(shading, up, omega_o).lane(0))
        };
        let step = |i: u32| {
            let d = plus(normal(i + 1), -1.0, normal(i));
            dot(d, d).sqrt()
        };
        (0..steps).map(step).fold(0.0, f64::max)
    };
    for degrees in [10.0, 45.0, 80.0, 89.0] {
        let (coarse, fine) = (largest(degrees, 1500), largest(degrees, 15_000));
        assert!(fine < 0.2 * coarse, "{degrees}: {coarse} {fine}");
    }
}
