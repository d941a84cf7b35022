//! Next-event estimation: are lights and points drawn as their pdf says, and is that pdf the one of
//! the direction?

mod common;

use common::{CORNERS, Source, Suite};
use huygens_kernels::lanes::{Fx, LANES};
use huygens_kernels::light::{LightSample, SKY, sample_light, select_light};
use huygens_kernels::mis::power_heuristic;
use huygens_kernels::rays::NO_PRIMITIVE;
use huygens_kernels::surface::Anchor;
use huygens_kernels::tables::{Lights, Materials, Tables, Triangles};
use huygens_kernels::vec3::Vec3x;
use proptest::prelude::*;

/// Half a unit in the last place of 1: one rounding.
const ROUNDING: f64 = 1.0 / 16_777_216.0;

/// Three lights of two materials around the origin, and the sky; no two of one size.
const VERTICES: [[f32; 3]; 9] = [
    [-1.0, 2.0, -1.0],
    [1.0, 2.0, -0.5],
    [0.5, 2.5, 1.5],
    [2.0, 0.5, 0.0],
    [2.0, 1.5, 0.5],
    [2.5, 1.0, 1.5],
    [-3.0, 0.5, 1.0],
    [-3.0, 3.0, 2.0],
    [-2.0, 1.0, 4.0],
];
/// Fronts towards the origin for the first two, away for the third, which is two-sided.
const INDICES: [[u32; 3]; 3] = [[0, 1, 2], [3, 5, 4], [6, 8, 7]];
const MATERIAL: [u32; 3] = [0, 0, 1];
const EXITANCE: [f64; 2] = [4.0, 1.5];
const SKY_POWER: f64 = 8.0;

fn corners(triangle: usize) -> [[f64; 3]; 3] {
    INDICES[triangle].map(|v| VERTICES[v as usize].map(f64::from))
}

/// A surface at `point` that faces up and lets nothing through.
fn anchor(point: [f32; 3]) -> Anchor {
    Anchor {
        point: Vec3x::splat(point),
        normal: Vec3x::splat([0.0, 1.0, 0.0]),
        clearance: Fx::ZERO,
        both_sides: Fx::ZERO,
    }
}

fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|c| a[c] - b[c])
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|c| a[(c + 1) % 3] * b[(c + 2) % 3] - a[(c + 2) % 3] * b[(c + 1) % 3])
}

fn length(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}

/// Twice the triangle's area along its front's normal.
fn normal(triangle: usize) -> [f64; 3] {
    let [a, b, c] = corners(triangle);
    cross(sub(b, a), sub(c, a))
}

/// The sky from straight above and below.
const ZENITH: [f64; 3] = [7.0, 8.0, 9.0];
const NADIR: [f64; 3] = [1.0, 0.0, 9.0];

/// Power of each light, the sky last.
fn powers() -> [f64; 4] {
    let power = |t: usize| EXITANCE[MATERIAL[t] as usize] * 0.5 * length(normal(t));
    [power(0), power(1), power(2), SKY_POWER]
}

/// Owned tables; the alias table is any that gives each light its power (here by robbing the rich).
struct Scene {
    keep: Vec<f32>,
    alias: Vec<u32>,
    area_pdf: [f32; 2],
    sky_selection: f32,
}

impl Scene {
    fn new() -> Self {
        let powers = powers();
        let total: f64 = powers.iter().sum();
        let (keep, alias) = alias_table(&powers);
        Self {
            keep,
            alias,
            area_pdf: EXITANCE.map(|e| (e / total) as f32),
            sky_selection: (SKY_POWER / total) as f32,
        }
    }

    fn sample(&self, source: &mut Source) -> LightSample {
        let albedo = [&[0.5f32; 2][..]; 3];
        let tables = Tables {
            triangles: Triangles {
                vertices: &VERTICES,
                indices: &INDICES,
                material: &MATERIAL,
                ..Triangles::default()
            },
            materials: Materials {
                albedo,
                emission: [&[1.0, 2.0], &[3.0, 4.0], &[5.0, 6.0]],
                two_sided: &[0, u32::MAX],
                area_pdf: &self.area_pdf,
                ..Materials::default()
            },
            lights: Lights {
                keep: &self.keep,
                alias: &self.alias,
                source: &[0, 1, 2, SKY],
                zenith: ZENITH.map(|c| c as f32),
                nadir: NADIR.map(|c| c as f32),
                sky_selection: self.sky_selection,
                ..Lights::default()
            },
            ..Tables::default()
        };
        let u = std::array::from_fn(|_| source.unit_lanes());
        sample_light(&tables, &anchor([0.0; 3]), u)
    }
}

/// Walker's table, the slow and obvious way: the largest tops up the smallest until all are even.
fn alias_table(weights: &[f64]) -> (Vec<f32>, Vec<u32>) {
    let n = weights.len();
    let mean = weights.iter().sum::<f64>() / n as f64;
    let mut rest: Vec<f64> = weights.iter().map(|w| w / mean).collect();
    let mut open: Vec<usize> = (0..n).collect();
    let (mut keep, mut alias) = (vec![1.0f32; n], (0..n as u32).collect::<Vec<_>>());
    while open.len() > 1 {
        open.sort_by(|&a, &b| rest[b].total_cmp(&rest[a]));
        let (poor, rich) = (open.pop().expect("two at least"), open[0]);
        (keep[poor], alias[poor]) = (rest[poor] as f32, rich as u32);
        rest[rich] -= 1.0 - rest[poor];
    }
    (keep, alias)
}

#[test]
fn lights_are_selected_by_their_weight() {
    const DRAWS: usize = 1 << 19;
    let mut suite = Suite::default();
    for (name, weights) in [
        ("one", vec![3.0]),
        ("even", vec![1.0; 7]),
        ("steep", (0..40).map(|k| 1.3f64.powi(k)).collect()),
        ("one with none", vec![2.0, 0.0, 1.0]),
    ] {
        let (keep, alias) = alias_table(&weights);
        let mut source = Source(3);
        let mut observed = vec![0u64; weights.len()];
        for _ in 0..DRAWS / LANES {
            let light = select_light(&keep, &alias, source.unit_lanes(), source.unit_lanes()).0;
            light
                .to_array()
                .into_iter()
                .for_each(|l| observed[l as usize] += 1);
        }
        if weights.len() == 1 {
            assert_eq!(observed, [DRAWS as u64]);
            continue;
        }
        if let Some(none) = weights.iter().position(|&w| w == 0.0) {
            assert_eq!(observed.remove(none), 0, "{name}");
        }
        let each = DRAWS as f64 / weights.iter().sum::<f64>();
        let expected = weights.iter().filter(|&&w| w > 0.0).map(|w| w * each);
        suite.test(name, &observed, &expected.collect::<Vec<_>>());
    }
    suite.finish();
}

#[test]
fn the_ends_of_the_unit_interval_select_lights_that_exist() {
    // u0 n rounds up to n for many n: 1 - 2^-24 times an odd number above 2^23, for one.
    for n in [1usize, 3, 1000, 65_537, (1 << 20) + 1] {
        let (keep, alias) = (vec![0.5f32; n], vec![0u32; n]);
        for u0 in CORNERS {
            let (light, rest) = select_light(&keep, &alias, Fx::splat(u0), Fx::new(CORNERS));
            assert!(
                rest.iter()
                    .flat_map(|r| r.to_array())
                    .all(|r| (0.0..1.0).contains(&r)),
                "{rest:?}"
            );
            for (light, u1) in light.to_array().into_iter().zip(CORNERS) {
                let entry = ((f64::from(u0) * n as f64) as u32).min(n as u32 - 1);
                let expected = if u1 < 0.5 { entry } else { 0 };
                // The product may round to the next entry.
                assert!(
                    light.abs_diff(expected) <= 1 && (light as usize) < n,
                    "{u0}, {u1}, {n}"
                );
            }
        }
    }
}

/// Barycentric weights of the second and third corner, of the point where the segment ends.
fn barycentric(triangle: usize, p: [f64; 3]) -> [f64; 2] {
    let [a, b, c] = corners(triangle);
    let n = normal(triangle);
    let part = |from: [f64; 3], to: [f64; 3]| dot(cross(sub(from, p), sub(to, p)), n) / dot(n, n);
    [part(c, a), part(a, b)]
}

#[test]
fn points_are_uniform_over_each_light_and_lights_are_drawn_by_power() {
    const DRAWS: usize = 1 << 20;
    const STRIPS: usize = 12;
    let scene = Scene::new();
    let mut source = Source(5);
    let mut selected = [0u64; 4];
    // Cells of equal area: strips of the parallelogram (u, v), folded into the triangle.
    let mut cells = [[0u64; STRIPS * STRIPS]; 3];
    for _ in 0..DRAWS / LANES {
        let drawn = scene.sample(&mut source);
        for lane in 0..LANES {
            let primitive = drawn.primitive.to_array()[lane];
            if primitive == NO_PRIMITIVE {
                selected[3] += 1;
                continue;
            }
            let light = primitive as usize;
            selected[light] += 1;
            let [u, v] = barycentric(light, drawn.segment.lane(lane).map(f64::from));
            // (1 - u)^2 and v / (1 - u) are uniform and independent on a triangle.
            let (x, y) = ((1.0 - u).powi(2), v / (1.0 - u));
            let cell = |x: f64| ((x * STRIPS as f64) as usize).min(STRIPS - 1);
            cells[light][cell(x) * STRIPS + cell(y)] += 1;
        }
    }
    let mut suite = Suite::default();
    let each = DRAWS as f64 / powers().iter().sum::<f64>();
    suite.test("selection", &selected, &powers().map(|p| p * each));
    for (light, cells) in cells.iter().enumerate() {
        suite.test_uniform(&format!("points of light {light}"), cells);
    }
    suite.finish();
}

/// Solid angle of a triangle from the origin: A. Van Oosterom, J. Strackee, "The Solid Angle of a
/// Plane Triangle", IEEE Trans. Biomed. Eng. 30(2), 1983.
fn solid_angle(triangle: usize) -> f64 {
    let [a, b, c] = corners(triangle);
    let [la, lb, lc] = [a, b, c].map(length);
    let below = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
    2.0 * dot(a, cross(b, c)).abs().atan2(below)
}

#[test]
fn pdfs_are_those_of_the_direction_in_solid_angle() {
    const DRAWS: usize = 1 << 18;
    let scene = Scene::new();
    let total: f64 = powers().iter().sum();
    let mut source = Source(7);
    // Sum and sum of squares of 1 / pdf by light: its mean is the solid angle of what the light
    // covers, whatever the pdf, if the pdf is the right one.
    let mut inverse = [[0.0f64; 2]; 4];
    for _ in 0..DRAWS / LANES {
        let drawn = scene.sample(&mut source);
        assert!(drawn.valid.all(), "every light here faces the origin");
        for lane in 0..LANES {
            let primitive = drawn.primitive.to_array()[lane];
            let pdf = f64::from(drawn.pdf.as_array()[lane]);
            let segment = drawn.segment.lane(lane).map(f64::from);
            let direction = drawn.direction.lane(lane).map(f64::from);
            let twin = if primitive == NO_PRIMITIVE {
                assert!(direction[1] > 0.0, "above the surface");
                SKY_POWER / total / std::f64::consts::TAU
            } else {
                let n = normal(primitive as usize);
                let cos = dot(n, segment).abs() / length(n) / length(segment);
                // Dozens of roundings over the smallest cosine here.
                assert!(cos > 0.2);
                let exitance = EXITANCE[MATERIAL[primitive as usize] as usize];
                exitance / total * dot(segment, segment) / cos
            };
            assert!(
                (pdf / twin - 1.0).abs() < 32.0 / 0.2 * ROUNDING,
                "{pdf} for {twin}"
            );
            let material = usize::from(primitive == 2);
            let radiance = match primitive {
                NO_PRIMITIVE => {
                    let height = 0.5 + 0.5 * direction[1];
                    [0, 1, 2].map(|c| NADIR[c] + (ZENITH[c] - NADIR[c]) * height)
                }
                _ => [[1.0, 3.0, 5.0], [2.0, 4.0, 6.0]][material],
            };
            for (drawn, expected) in drawn.radiance.lane(lane).into_iter().zip(radiance) {
                // The height and the sum are rounded once each; emission is a number of the table.
                assert!((f64::from(drawn) - expected).abs() <= 3.0 * ROUNDING * 9.0);
            }
            let light = (primitive as usize).min(3);
            inverse[light][0] += 1.0 / pdf;
            inverse[light][1] += 1.0 / (pdf * pdf);
        }
    }
    for (light, [sum, squares]) in inverse.into_iter().enumerate() {
        let n = DRAWS as f64;
        let expected = if light == 3 {
            std::f64::consts::TAU
        } else {
            solid_angle(light)
        };
        let mean = sum / n;
        let error = ((squares / n - mean * mean) / n).sqrt();
        // Four tests at 1e-4 together: 4.2 standard errors each.
        assert!(
            (mean - expected).abs() < 4.2 * error,
            "{light}: {mean} +- {error}, {expected}"
        );
    }
}

#[test]
fn a_back_that_does_not_emit_is_no_valid_sample() {
    let scene = Scene::new();
    let mut source = Source(9);
    let materials = Materials {
        albedo: [&[0.5; 2]; 3],
        emission: [&[1.0; 2]; 3],
        two_sided: &[0, 0],
        area_pdf: &scene.area_pdf,
        ..Materials::default()
    };
    let tables = Tables {
        triangles: Triangles {
            vertices: &VERTICES,
            indices: &INDICES,
            material: &MATERIAL,
            ..Triangles::default()
        },
        materials,
        lights: Lights {
            keep: &[1.0],
            alias: &[0],
            source: &[2],
            ..Lights::default()
        },
        ..Tables::default()
    };
    let u = std::array::from_fn(|_| source.unit_lanes());
    assert!(sample_light(&tables, &anchor([0.0; 3]), u).valid.none());
    let behind = anchor([-9.0, 2.0, 2.0]);
    assert!(sample_light(&tables, &behind, u).valid.all());
}

#[test]
fn where_light_passes_through_the_sky_is_sampled_all_around_and_rays_start_on_its_side() {
    const DRAWS: usize = 1 << 18;
    const BANDS: usize = 64;
    let tables = Tables {
        triangles: Triangles {
            vertices: &VERTICES,
            indices: &INDICES,
            material: &MATERIAL,
            ..Triangles::default()
        },
        materials: Materials {
            albedo: [&[0.5; 2]; 3],
            emission: [&[1.0; 2]; 3],
            two_sided: &[u32::MAX; 2],
            area_pdf: &[0.0; 2],
            ..Materials::default()
        },
        lights: Lights {
            keep: &[1.0],
            alias: &[0],
            source: &[SKY],
            zenith: [1.0; 3],
            nadir: [1.0; 3],
            sky_selection: 0.5,
            ..Lights::default()
        },
        ..Tables::default()
    };
    let anchor = Anchor {
        clearance: Fx::splat(0.25),
        both_sides: Fx::ZERO.simd_eq(Fx::ZERO),
        ..anchor([0.0; 3])
    };
    let mut source = Source(11);
    let mut bands = [0u64; BANDS];
    for _ in 0..DRAWS / LANES {
        let u = std::array::from_fn(|_| source.unit_lanes());
        let drawn = sample_light(&tables, &anchor, u);
        assert!(drawn.valid.all());
        for lane in 0..LANES {
            let y = drawn.direction.lane(lane)[1];
            // The height of a uniform direction is uniform (Archimedes).
            let band = ((f64::from(y) + 1.0) * 0.5 * BANDS as f64) as usize;
            bands[band.min(BANDS - 1)] += 1;
            let start = if y < 0.0 { -0.25 } else { 0.25 };
            assert_eq!(drawn.origin.lane(lane), [0.0, start, 0.0]);
            let pdf = f64::from(drawn.pdf.as_array()[lane]);
            let twin = 0.5 / (4.0 * std::f64::consts::PI);
            assert!((pdf / twin - 1.0).abs() < 4.0 * ROUNDING);
        }
    }
    let mut suite = Suite::default();
    suite.test_uniform("heights", &bands);
    suite.finish();
}

proptest! {
    #[test]
    fn the_weights_of_two_techniques_sum_to_one(a in prop::num::f32::POSITIVE, b in prop::num::f32::POSITIVE) {
        prop_assume!(a > 0.0 && b > 0.0 && a.is_finite() && b.is_finite());
        let weight = |a, b| power_heuristic(Fx::splat(a), Fx::splat(b)).as_array()[0];
        let (w, v) = (weight(a, b), weight(b, a));
        prop_assert!((0.0..=1.0).contains(&w) && (0.0..=1.0).contains(&v), "{w}, {v}");
        let ratio = f64::from(b) / f64::from(a);
        // Ratio, its square, sum and quotient.
        prop_assert!((f64::from(w) - 1.0 / (1.0 + ratio * ratio)).abs() <= 4.0 * ROUNDING);
        prop_assert!((f64::from(w) + f64::from(v) - 1.0).abs() <= 8.0 * ROUNDING);
    }
}

#[test]
fn a_technique_that_cannot_find_the_sample_takes_no_weight() {
    let w = power_heuristic(Fx::new(CORNERS) + Fx::splat(1e-30), Fx::ZERO);
    assert_eq!(w.to_array(), [1.0; LANES]);
}
