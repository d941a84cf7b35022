//! Media against their formulas in f64.

mod common;

use huygens_kernels::lanes::LANES;
use huygens_kernels::medium::{IN_MEDIUM, Media, OUTSIDE, travel};
use huygens_kernels::queues::{PathHitsMut, PathsMut};
use huygens_kernels::rays::NO_PRIMITIVE;
use huygens_kernels::sampler::{Apart, Independent, Sampler, apart};
use proptest::prelude::*;

/// A path of one ray: what `travel` is given.
#[derive(Clone, Copy, Debug)]
struct Case {
    origin: [f32; 3],
    direction: [f32; 3],
    throughput: [f32; 3],
    /// None: it leaves the scene.
    hit: Option<f32>,
    pixel: u32,
}

/// Media of one row, in a box.
#[derive(Clone, Copy, Debug)]
struct Fog {
    absorption: [f32; 3],
    scattering: [f32; 3],
    bounds: [[f32; 3]; 2],
}

/// New throughput, and where the path was scattered if it was.
type Outcome = ([f64; 3], Option<f64>);

const SAMPLER: Independent = Independent { seed: 3 };

fn by_kernel(fog: &Fog, case: &Case) -> ([f32; 3], Option<f32>) {
    let extinction: [[f32; 1]; 3] =
        std::array::from_fn(|c| [fog.absorption[c] + fog.scattering[c]]);
    let scattering = fog.scattering.map(|s| [s]);
    let scatters = fog.scattering.iter().any(|s| *s > 0.0);
    let rate = extinction.map(|e| if scatters { e } else { [0.0] });
    let media = Media {
        extinction: extinction.each_ref().map(|c| &c[..]),
        scattering: scattering.each_ref().map(|c| &c[..]),
        rate: rate.each_ref().map(|c| &c[..]),
        g: &[0.0],
        bounds: fog.bounds,
        interior: &[],
        exterior: &[],
    };
    let vec3 = |v: [f32; 3]| v.map(|x| vec![x; LANES]);
    let (mut origin, mut direction) = (vec3(case.origin), vec3(case.direction));
    let mut throughput = vec3(case.throughput);
    let (mut pdf, mut leaves) = (vec![1.0; LANES], vec![NO_PRIMITIVE; LANES]);
    let mut words = [0, case.pixel, 5, 1].map(|w| vec![w; LANES]);
    let [slot, pixel, sample, bounces] = &mut words;
    let mut paths = PathsMut {
        origin: origin.each_mut().map(Vec::as_mut_slice),
        direction: direction.each_mut().map(Vec::as_mut_slice),
        throughput: throughput.each_mut().map(Vec::as_mut_slice),
        pdf: &mut pdf,
        leaves: &mut leaves,
        slot,
        pixel,
        sample,
        bounces,
    };
    let mut primitive = vec![if case.hit.is_some() { 7 } else { NO_PRIMITIVE }; LANES];
    let mut t = vec![case.hit.unwrap_or(f32::NAN); LANES];
    let (mut u, mut v) = (vec![0.0; LANES], vec![0.0; LANES]);
    let mut hits = PathHitsMut {
        primitive: &mut primitive,
        t: &mut t,
        u: &mut u,
        v: &mut v,
    };
    let medium = [OUTSIDE; LANES];
    travel(LANES, &medium, &media, SAMPLER, &mut paths, &mut hits);
    let scattered = (primitive[0] == IN_MEDIUM).then_some(t[0]);
    (throughput.each_ref().map(|c| c[0]), scattered)
}

/// The two numbers that the path draws.
fn numbers(case: &Case) -> [f64; 2] {
    let splat = huygens_kernels::lanes::Ux::splat;
    let block = apart(splat(1), Apart::Medium);
    let [u, choice, ..] = SAMPLER.draw4(splat(case.pixel), splat(5), block);
    [u, choice].map(|x| f64::from(x.as_array()[0]))
}

fn by_formula(fog: &Fog, case: &Case) -> Outcome {
    let wide = |v: [f32; 3]| v.map(f64::from);
    let (o, d) = (wide(case.origin), wide(case.direction));
    let (mut enter, mut leave) = (0.0, case.hit.map_or(f64::INFINITY, f64::from));
    for k in 0..3 {
        let [low, high] = [fog.bounds[0][k], fog.bounds[1][k]].map(f64::from);
        if d[k] == 0.0 {
            if o[k] < low || o[k] > high {
                leave = f64::NEG_INFINITY;
            }
        } else {
            let (a, b) = ((low - o[k]) / d[k], (high - o[k]) / d[k]);
            enter = f64::max(enter, a.min(b));
            leave = f64::min(leave, a.max(b));
        }
    }
    let length = f64::max(leave - enter, 0.0);
    let scattering = wide(fog.scattering);
    let extinction: [f64; 3] = std::array::from_fn(|c| scattering[c] + wide(fog.absorption)[c]);
    let scatters = scattering.iter().any(|s| *s > 0.0);
    let beta = wide(case.throughput);
    let total: f64 = beta.iter().map(|b| b.abs()).sum();
    let share = beta.map(|b| b.abs() / total);
    let [u, choice] = numbers(case);
    let channel = match choice {
        x if x < share[0] => 0,
        x if x < share[0] + share[1] => 1,
        _ => 2,
    };
    let left = |sigma: f64, s: f64| {
        if sigma == 0.0 {
            1.0
        } else {
            (-sigma * s).exp()
        }
    };
    let s = if scatters && extinction[channel] > 0.0 {
        -(1.0 - u).ln() / extinction[channel]
    } else {
        f64::INFINITY
    };
    if s < length {
        let density: f64 = (0..3)
            .map(|c| share[c] * extinction[c] * left(extinction[c], s))
            .sum();
        let weight = |c: usize| scattering[c] * left(extinction[c], s) / density;
        (
            std::array::from_fn(|c| beta[c] * weight(c)),
            Some(enter + s),
        )
    } else {
        let passed: f64 = match scatters {
            true => (0..3).map(|c| share[c] * left(extinction[c], length)).sum(),
            false => 1.0,
        };
        let weight = |c: usize| left(extinction[c], length) / passed;
        (std::array::from_fn(|c| beta[c] * weight(c)), None)
    }
}

/// A coefficient, now and then none.
fn sigma() -> impl Strategy<Value = f32> + Clone {
    prop_oneof![1 => Just(0.0f32), 3 => 0.001f32..8.0]
}

fn triple(each: impl Strategy<Value = f32> + Clone) -> impl Strategy<Value = [f32; 3]> {
    [each.clone(), each.clone(), each]
}

proptest! {
    #[test]
    fn rays_travel_as_the_formula_says(
        absorption in triple(sigma()),
        scattering in triple(sigma()),
        origin in triple(-2f32..2.0),
        towards in triple(prop_oneof![1 => Just(0.0f32), 1 => Just(-0.0f32), 6 => -1f32..1.0]),
        throughput in triple(prop_oneof![1 => Just(0.0f32), 5 => 0.01f32..2.0, 1 => -1f32..-0.01]),
        hit in prop_oneof![1 => Just(None), 3 => (0.01f32..5.0).prop_map(Some)],
        boxed: bool,
        pixel: u32,
    ) {
        let length = towards.iter().map(|x| x * x).sum::<f32>().sqrt();
        prop_assume!(length > 0.1 && throughput.iter().any(|t| *t != 0.0));
        let bounds = match boxed {
            true => [[-1.0, -0.5, -1.5], [1.25, 1.0, 0.5]],
            false => [[f32::NEG_INFINITY; 3], [f32::INFINITY; 3]],
        };
        let fog = Fog { absorption, scattering, bounds };
        let direction = towards.map(|x| x / length);
        let case = Case { origin, direction, throughput, hit, pixel };
        let (found, at) = by_kernel(&fog, &case);
        prop_assert!(found.iter().all(|x| x.is_finite()), "{:?}", found);
        let (expected, there) = by_formula(&fog, &case);
        // Numbers on the edge of a decision are decided by their rounding.
        let [_, choice] = numbers(&case);
        let total: f32 = throughput.iter().map(|t| t.abs()).sum();
        let share = throughput.map(|t| f64::from(t.abs() / total));
        let edges = [share[0], share[0] + share[1]];
        prop_assume!(edges.iter().all(|e| (choice - e).abs() > 1e-6));
        if at.is_some() != there.is_some() {
            // As close to the end of the medium as the roundings of either distance.
            let reached = at.map(f64::from).or(there).expect("one of them");
            let nearly = Case { hit: Some((reached * (1.0 - 1e-4)) as f32), ..case };
            prop_assert!(by_formula(&fog, &nearly).1.is_none());
            return Ok(());
        }
        // A distance s is off by some roundings of itself and of the way to the box, 2^-20 of a few
        // units; the logarithm of a weight by sigma times that, and by what ln loses near 0.
        let sigma = (0..3).map(|c| absorption[c] + scattering[c]).fold(0.0, f32::max);
        let reach = at.map_or(0.0, f64::from).max(hit.map_or(4.0, f64::from)) + 4.0;
        let slack = (1.0 + f64::from(sigma) * reach) * (-20f64).exp2();
        if let (Some(at), Some(there)) = (at, there) {
            prop_assert!((f64::from(at) - there).abs() <= reach * (-20f64).exp2() * 8.0 , "{} {}", at, there);
        }
        for c in 0..3 {
            let (a, b) = (f64::from(found[c]), expected[c]);
            // What underflows is 0, at e^-104.
            let tiny = (-87f64).exp();
            prop_assert!((a - b).abs() <= slack * b.abs() + tiny, "{:?} {:?} {:?}", found, expected, at);
        }
    }
}
