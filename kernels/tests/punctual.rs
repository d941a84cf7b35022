//! Lights of no area: is their light that of their twins in f64, and are discs drawn by their pdf?

mod common;

use common::{CORNERS, Source, Suite};
use huygens_kernels::lanes::{Fx, LANES, Ux};
use huygens_kernels::light::{Departure, LightSample, PUNCTUAL, Punctual, beyond, sample_light};
use huygens_kernels::rays::NO_PRIMITIVE;
use huygens_kernels::surface::Anchor;
use huygens_kernels::tables::{Lights, Tables};
use huygens_kernels::vec3::Vec3x;

/// Half a unit in the last place of 1: one rounding.
const ROUNDING: f64 = 1.0 / 16_777_216.0;

fn tables<'a>(punctual: &'a [Punctual], keep: &'a [f32], source: &'a [u32]) -> Tables<'a> {
    Tables {
        lights: Lights {
            keep,
            alias: &[0, 1, 2, 3][..keep.len()],
            source,
            punctual,
            ..Lights::default()
        },
        ..Tables::default()
    }
}

/// A surface at the origin that faces up, with a visible clearance.
fn anchor(both_sides: bool) -> Anchor {
    Anchor {
        point: Vec3x::splat([0.0; 3]),
        normal: Vec3x::splat([0.0, 1.0, 0.0]),
        clearance: Fx::splat(0.125),
        both_sides: if both_sides {
            Fx::ZERO.simd_eq(Fx::ZERO)
        } else {
            Fx::ZERO
        },
    }
}

fn sample(light: Punctual, both_sides: bool, u: [Fx; 4]) -> LightSample {
    let lights = [light];
    sample_light(
        &tables(&lights, &[1.0], &[PUNCTUAL]),
        &anchor(both_sides),
        u,
    )
}

/// Numbers in every lane.
fn numbers(source: &mut Source) -> [Fx; 4] {
    std::array::from_fn(|_| source.unit_lanes())
}

#[test]
fn points_and_spots_shine_by_the_square_of_the_distance_and_the_smooth_step() {
    let mut source = Source(31);
    for _ in 0..4096 {
        let place = source.direction().map(|c| 3.0 * c);
        let axis = source.direction();
        let spot = source.unit() < 0.5;
        let (edge, full) = (0.3f32, 0.3 + 0.6 * source.unit());
        let light = Punctual {
            place,
            value: [2.0, 3.0, 5.0],
            selection: 0.25,
            axis,
            edge: if spot { edge } else { -3.0 },
            slope: if spot {
                (full - edge).recip().min(f32::MAX)
            } else {
                1.0
            },
            density: 1.0,
            ..Punctual::default()
        };
        let drawn = sample(light, true, numbers(&mut source));
        // The ray starts on the light's side of the surface.
        let start = f64::from(if place[1] < 0.0 { -0.125f32 } else { 0.125 });
        let to = [
            f64::from(place[0]),
            f64::from(place[1]) - start,
            f64::from(place[2]),
        ];
        let r2: f64 = to.iter().map(|c| c * c).sum();
        let dot: f64 = (0..3).map(|c| f64::from(axis[c]) * to[c]).sum();
        let cos = -dot / r2.sqrt();
        let t = ((cos - f64::from(edge)) / f64::from(full - edge)).clamp(0.0, 1.0);
        let smooth = if spot { t * t * (3.0 - 2.0 * t) } else { 1.0 };
        // The step's slope is at most 1.5 over the width of the edge; its square root's is infinite
        // at 0, which the absolute part covers. A dozen roundings for the cosine.
        let width = if spot { f64::from(full - edge) } else { 1.0 };
        let tolerance = (12.0 / width + 12.0) * ROUNDING * 5.0 / r2;
        assert_eq!(drawn.origin.lane(0), [0.0, start as f32, 0.0]);
        assert_eq!(drawn.primitive.to_array(), [NO_PRIMITIVE; LANES]);
        assert!(drawn.delta.all());
        assert_eq!(drawn.weight(Fx::splat(7.0)).to_array(), [1.0; LANES]);
        assert_eq!(drawn.pdf.to_array(), [0.25; LANES]);
        assert_eq!(drawn.t_max.to_array(), [1.0; LANES]);
        if !drawn.valid.all() {
            assert!(smooth * 5.0 / r2 <= tolerance, "dark where it is not valid");
            continue;
        }
        for (c, value) in [2.0, 3.0, 5.0].into_iter().enumerate() {
            let found = f64::from(drawn.radiance.lane(0)[c]);
            assert!((found - value * smooth / r2).abs() <= tolerance, "{found}");
            let segment = f64::from(drawn.segment.lane(0)[c]);
            assert!((segment - to[c]).abs() <= 4.0 * ROUNDING);
        }
    }
}

#[test]
fn light_from_below_counts_only_where_it_passes_through() {
    let mut source = Source(33);
    let sun = Punctual {
        place: [0.6, -0.8, 0.0],
        value: [1.0; 3],
        selection: 1.0,
        distant: true,
        density: 1.0,
        ..Punctual::default()
    };
    assert!(sample(sun, false, numbers(&mut source)).valid.none());
    let through = sample(sun, true, numbers(&mut source));
    assert!(through.valid.all() & through.delta.all());
    assert_eq!(through.origin.lane(0), [0.0, -0.125, 0.0]);
    // A delta light's direction is its place, to the bit.
    assert_eq!(through.direction.lane(5), sun.place);
    assert_eq!(through.radiance.lane(5), [1.0; 3]);
}

#[test]
fn discs_are_drawn_uniformly_and_found_where_they_are_drawn() {
    const RINGS: usize = 8;
    const SECTORS: usize = 8;
    let mut suite = Suite::default();
    // Half angles in degrees: the sun's, a wide one, more than a hemisphere.
    for (k, degrees) in [0.2665f64, 25.0, 120.0].into_iter().enumerate() {
        let extent = 2.0 * (0.5 * degrees.to_radians()).sin().powi(2);
        let place = Source(35 + k as u64).direction();
        let light = Punctual {
            place,
            value: [4.0, 5.0, 6.0],
            selection: 0.5,
            distant: true,
            extent: extent as f32,
            density: (1.0 / (std::f64::consts::TAU * extent)) as f32,
            ..Punctual::default()
        };
        let lights = [light];
        let tables = tables(&lights, &[1.0], &[PUNCTUAL]);
        let mut source = Source(41 + k as u64);
        let mut cells = [0u64; RINGS * SECTORS];
        let mut found_at_all = 0usize;
        const DRAWS: usize = 1 << 16;
        // A frame about the disc's middle.
        let axis = place.map(f64::from);
        let helper = if axis[0].abs() < 0.5 {
            [1.0, 0.0, 0.0]
        } else {
            [0.0, 1.0, 0.0]
        };
        let cross = |a: [f64; 3], b: [f64; 3]| -> [f64; 3] {
            std::array::from_fn(|c| {
                a[(c + 1) % 3] * b[(c + 2) % 3] - a[(c + 2) % 3] * b[(c + 1) % 3]
            })
        };
        let dot = |a: [f64; 3], b: [f64; 3]| (0..3).map(|c| a[c] * b[c]).sum::<f64>();
        let s = cross(axis, helper);
        let s = s.map(|c| c / dot(s, s).sqrt());
        let t = cross(axis, s);
        for _ in 0..DRAWS / LANES {
            let drawn = sample_light(&tables, &anchor(true), numbers(&mut source));
            assert!(drawn.valid.all() & drawn.delta.none());
            let from = Departure {
                origin: Vec3x::splat([0.0; 3]),
                direction: drawn.direction,
                leaves: Ux::splat(NO_PRIMITIVE),
                both_sides: Fx::ZERO,
            };
            let mut calls = 0;
            beyond(&tables, &from, |radiance, pdf| {
                calls += 1;
                // The first is the sky, which this scene has not.
                if calls == 1 {
                    assert_eq!(pdf.to_array(), [0.0; LANES]);
                    return;
                }
                assert_eq!(pdf.to_array(), drawn.pdf.to_array());
                found_at_all += (0..LANES)
                    .filter(|&l| radiance.lane(l) == [4.0, 5.0, 6.0])
                    .count();
            });
            assert_eq!(calls, 2);
            for lane in 0..LANES {
                let d = drawn.direction.lane(lane).map(f64::from);
                let chord: [f64; 3] = std::array::from_fn(|c| d[c] - axis[c]);
                // 1 - cos is uniform over a cap (Archimedes).
                let ring = 0.5 * dot(chord, chord) / extent;
                let sector = dot(d, t).atan2(dot(d, s)) / std::f64::consts::TAU + 0.5;
                let cell = |x: f64, n: usize| ((x * n as f64) as usize).min(n - 1);
                cells[cell(ring, RINGS) * SECTORS + cell(sector, SECTORS)] += 1;
            }
        }
        suite.test_uniform(&format!("{degrees} degrees"), &cells);
        // Only what rounding carries over the edge is not found: directions are off by a few
        // roundings, the share of the disc that near its edge is twice that over its radius.
        let chord = (2.0 * extent).sqrt();
        let missed = DRAWS - found_at_all;
        let expected = DRAWS as f64 * 2.0 * 6.0 * ROUNDING / chord;
        assert!(
            (missed as f64) <= 8.0 + 2.0 * expected,
            "{degrees}: {missed} missed"
        );
    }
    suite.finish();
}

#[test]
fn numbers_at_their_ends_give_finite_samples() {
    for extent in [0.0f32, 1e-5, 0.5, 2.0] {
        let light = Punctual {
            place: [0.0, 1.0, 0.0],
            value: [1.0; 3],
            selection: 1.0,
            distant: true,
            extent,
            density: 1.0,
            ..Punctual::default()
        };
        for u in CORNERS {
            let all = Fx::new(CORNERS);
            let drawn = sample(light, true, [all, all, Fx::splat(u), all]);
            let finite = drawn.direction.is_finite() & drawn.radiance.is_finite();
            assert!((finite & drawn.valid).all(), "{extent}, {u}");
        }
    }
    // A light at the very point that it lights is no sample, not a NaN.
    let here = Punctual {
        value: [1.0; 3],
        edge: -3.0,
        slope: 1.0,
        selection: 1.0,
        density: 1.0,
        ..Punctual::default()
    };
    let anchor = Anchor {
        clearance: Fx::ZERO,
        ..anchor(true)
    };
    let lights = [here];
    let u = [Fx::splat(0.5); 4];
    let tables = tables(&lights, &[1.0], &[PUNCTUAL]);
    assert!(sample_light(&tables, &anchor, u).valid.none());
}
