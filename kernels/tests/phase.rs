//! The phase function of Henyey and Greenstein: is it drawn as it says, is it exact at its peaks?

mod common;

use common::{CORNERS, Source, Suite};
use huygens_kernels::lanes::{Fx, LANES};
use huygens_kernels::phase::{G_LIMIT, HenyeyGreenstein};
use huygens_kernels::vec3::Vec3x;
use std::f64::consts::{PI, TAU};

/// Half a unit in the last place of 1: one rounding.
const ROUNDING: f64 = 1.0 / 16_777_216.0;
const ASYMMETRIES: [f32; 9] = [-G_LIMIT, -0.9, -0.3, -1e-6, 0.0, 1e-6, 0.4, 0.9, G_LIMIT];

fn phase(g: f32) -> HenyeyGreenstein {
    HenyeyGreenstein { g: Fx::splat(g) }
}

/// As its authors write it, but from `away`: `1 - c`, or `1 + c` for `g < 0`, of the two vectors, which
/// a narrow peak needs of vectors that are not quite unit.
fn twin(g: f64, away: f64) -> f64 {
    let square = (1.0 - g.abs()).powi(2) + 2.0 * g.abs() * away;
    (1.0 - g * g) / (4.0 * PI * square.powf(1.5))
}

/// Probability of a cosine above `1 - below`.
fn within(g: f64, below: f64) -> f64 {
    if g == 0.0 {
        return 0.5 * below;
    }
    let square = (1.0 - g) * (1.0 - g) + 2.0 * g * below;
    (1.0 - g * g) / (2.0 * g) * (1.0 / (1.0 - g) - 1.0 / square.sqrt())
}

/// `1 - c` from the vectors, or `1 + c`.
fn away(o: [f64; 3], i: [f64; 3], backwards: bool) -> f64 {
    let sign = if backwards { -1.0 } else { 1.0 };
    0.5 * (0..3).map(|c| (o[c] + sign * i[c]).powi(2)).sum::<f64>()
}

#[test]
fn samples_follow_their_pdf_all_around() {
    const RINGS: usize = 24;
    const SECTORS: usize = 8;
    const DRAWS: usize = 1 << 18;
    let mut suite = Suite::default();
    for g in ASYMMETRIES {
        // Along z, so that the azimuth about the path is that of x and y.
        let o = Vec3x::splat([0.0, 0.0, -1.0]);
        let n = f64::from(g);
        // Rings of equal probability, by the distribution function in 1 - c, inverted by bisection.
        let edges: Vec<f64> = (0..=RINGS)
            .map(|ring| {
                let (mut low, mut high) = (0.0f64, 2.0f64);
                for _ in 0..200 {
                    let at = 0.5 * (low + high);
                    if within(n, at) < ring as f64 / RINGS as f64 {
                        low = at;
                    } else {
                        high = at;
                    }
                }
                high
            })
            .collect();
        let mut source = Source(5);
        let mut observed = [0u64; RINGS * SECTORS];
        for _ in 0..DRAWS / LANES {
            let u = [source.unit_lanes(), source.unit_lanes()];
            let (i, _) = phase(g).sample(o, u);
            for lane in 0..LANES {
                let w = i.lane(lane).map(f64::from);
                let ring = edges.partition_point(|&e| e <= away([0.0, 0.0, -1.0], w, false));
                let ring = ring.clamp(1, RINGS) - 1;
                let turn = (w[1].atan2(w[0]) / TAU).rem_euclid(1.0);
                let sector = ((turn * SECTORS as f64) as usize).min(SECTORS - 1);
                observed[ring * SECTORS + sector] += 1;
            }
        }
        suite.test_uniform(&format!("g = {g}"), &observed);
    }
    suite.finish();
}

#[test]
fn values_agree_with_the_formula_and_with_samples() {
    let mut source = Source(6);
    for g in ASYMMETRIES {
        let n = f64::from(g);
        for _ in 0..500 {
            let o = source.direction();
            let (i, pdf) =
                phase(g).sample(Vec3x::splat(o), [source.unit_lanes(), source.unit_lanes()]);
            let again = phase(g).pdf(Vec3x::splat(o), i);
            let other = source.direction();
            let value = phase(g)
                .pdf(Vec3x::splat(o), Vec3x::splat(other))
                .as_array()[0];
            let o = o.map(f64::from);
            // Half a rounding in each component of a direction moves 1 - c by two roundings times its
            // root and more; the value's logarithm changes with it by at most 3 g / (1 - g)^2, and by
            // at most 3 / 2 relative to 1 - c itself.
            let bound = |away: f64| {
                let square = (1.0 - n.abs()).powi(2) + 2.0 * n.abs() * away;
                let moved = 4.0 * ROUNDING * (away.sqrt() + ROUNDING);
                16.0 * ROUNDING + 3.0 * n.abs() * moved / square
            };
            let b = away(o, other.map(f64::from), n < 0.0);
            let off = (f64::from(value) / twin(n, b) - 1.0).abs();
            assert!(
                off <= bound(b),
                "{g} {o:?} {other:?}: {off:e} of {:e}",
                bound(b)
            );
            for lane in 0..LANES {
                let b = away(o, i.lane(lane).map(f64::from), n < 0.0);
                let (drawn, said) = (pdf.as_array()[lane], again.as_array()[lane]);
                let off = f64::from((drawn - said).abs() / said);
                // The drawn direction went through a frame: six roundings a component.
                assert!(off <= 8.0 * bound(b), "{g}: {off:e} of {:e}", bound(b));
            }
        }
    }
}

#[test]
fn the_ends_of_the_unit_square_give_sound_directions() {
    for g in ASYMMETRIES {
        for o in [
            [0.0, 0.0, 1.0],
            [0.0, 0.0, -1.0],
            [0.6, 0.0, -0.8],
            [-0.0, 1.0, 0.0],
        ] {
            for v in CORNERS {
                let (i, pdf) = phase(g).sample(Vec3x::splat(o), [Fx::new(CORNERS), Fx::splat(v)]);
                for lane in 0..LANES {
                    let w = i.lane(lane).map(f64::from);
                    let length = w.iter().map(|c| c * c).sum::<f64>().sqrt();
                    // Sine and cosine (1.2e-7), their root, and a frame.
                    assert!(
                        (length - 1.0).abs() < 1.2e-7 * 2.0 + 16.0 * ROUNDING,
                        "{g}: {w:?}"
                    );
                    let pdf = pdf.as_array()[lane];
                    assert!(pdf.is_finite() && pdf > 0.0, "{g}: {pdf}");
                }
            }
        }
    }
}

#[test]
fn the_mean_cosine_is_g() {
    for g in ASYMMETRIES {
        let o = Vec3x::splat([0.0, 0.0, -1.0]);
        const DRAWS: usize = 1 << 16;
        let mut sums = [0.0; 2];
        for first in (0..DRAWS).step_by(LANES) {
            let u = std::array::from_fn(|l| ((first + l) as f32 + 0.5) / DRAWS as f32);
            let (i, _) = phase(g).sample(o, [Fx::new(u), Fx::ZERO]);
            for lane in 0..LANES {
                sums[0] += 1.0;
                sums[1] += f64::from(i.lane(lane)[2]);
            }
        }
        // The midpoint rule of a monotone function: within its range over the number of points.
        let off = (sums[1] / sums[0] - f64::from(g)).abs();
        assert!(off <= 2.0 / DRAWS as f64, "{g}: off by {off:e}");
    }
}
