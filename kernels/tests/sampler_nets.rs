//! What samplers promise of many points together: nets, strata, and scrambling as good as Owen's.

mod common;

use common::Source;
use huygens_kernels::lanes::{LANES, Ux, iota};
use huygens_kernels::sampler::{BlueNoise, Sampler, Sobol, Stratified, sobol};
use proptest::prelude::*;

/// The direction integers of Joe and Kuo's list (new-joe-kuo-6), dimensions 1 to 4: degree and inner
/// coefficients of the polynomial, first integers. Dimension 1 has none: all its integers are 1.
const JOE_KUO: [(u32, u32, &[u32]); 4] = [
    (0, 0, &[]),
    (1, 0, &[1]),
    (2, 1, &[1, 3]),
    (3, 1, &[1, 3, 1]),
];

/// Sobol's definition: the exclusive-or of a direction number for each bit of the index.
fn sobol_twin(index: u32, dimension: usize) -> u32 {
    let (degree, inner, first) = JOE_KUO[dimension];
    let mut m: Vec<u32> = first.to_vec();
    for k in m.len()..32 {
        m.push(if degree == 0 {
            1
        } else {
            let back = |j: u32| m[k - j as usize];
            (1..degree)
                .filter(|j| (inner >> (degree - 1 - j)) & 1 == 1)
                .fold(back(degree) ^ (back(degree) << degree), |sum, j| {
                    sum ^ (back(j) << j)
                })
        });
    }
    (0..32)
        .filter(|k| (index >> k) & 1 == 1)
        .fold(0, |sum, k| sum ^ (m[k] << (31 - k)))
}

proptest! {
    #[test]
    fn sobol_points_follow_their_recurrence(index: [u32; LANES], bits in 0..=32u32) {
        // Few bits too: the columns beyond the largest index are skipped.
        let index = index.map(|i| i.unbounded_shr(32 - bits));
        let points = sobol(Ux::new(index));
        for (dimension, bits) in points.into_iter().enumerate() {
            let expected = index.map(|i| sobol_twin(i, dimension));
            prop_assert_eq!(bits.to_array(), expected, "dimension {}", dimension);
        }
    }
}

#[test]
fn the_first_sobol_points_are_those_of_joe_and_kuo() {
    // In eighths, as their program prints them: in the order of the Gray code.
    let printed = [
        [0, 0, 0, 0],
        [4, 4, 4, 4],
        [6, 2, 2, 2],
        [2, 6, 6, 6],
        [3, 3, 5, 7],
        [7, 7, 1, 3],
        [5, 1, 7, 5],
        [1, 5, 3, 1],
    ];
    let points = sobol(iota(0) ^ (iota(0) >> 1)).map(|d| d.to_array());
    for (i, point) in printed.into_iter().enumerate() {
        assert_eq!(points.map(|d| d[i] >> 29), point, "point {i}");
    }
}

/// Asserts that in every dyadic rectangle of area `2^t / n` lie `2^t` of the `n` points, a power of
/// two: a (t, m, 2)-net.
fn assert_net(name: &str, points: &[[f32; 2]], t: u32) {
    let m = points.len().ilog2();
    assert_eq!(points.len(), 1 << m);
    for across in 0..=m.saturating_sub(t) {
        let down = m - t.min(m) - across;
        let mut cells = vec![0u32; 1 << (across + down)];
        for [x, y] in points {
            let column = (x * (1u32 << across) as f32) as usize;
            let row = (y * (1u32 << down) as f32) as usize;
            cells[(column << down) + row] += 1;
        }
        assert!(
            cells.iter().all(|&c| c == 1 << t.min(m)),
            "{name}: 2^{across} x 2^{down} cells hold {cells:?}"
        );
    }
}

/// What Sobol promises of each pair of dimensions; see the header of the kernel.
const QUALITY: [(usize, usize, u32); 6] = [
    (0, 1, 0),
    (0, 2, 1),
    (1, 2, 1),
    (0, 3, 2),
    (1, 3, 2),
    (2, 3, 3),
];

#[test]
fn aligned_runs_of_sobol_samples_are_nets() {
    let sampler = Sobol { seed: 3 };
    for (x, y, block) in [(0, 0, 0), (5, 9, 1), (65_535, 65_535, 40), (12, 800, 7)] {
        let pixel = sampler.pixel(Ux::splat(x), Ux::splat(y));
        for (m, run) in [
            (0, 0),
            (0, 7),
            (1, 3),
            (3, 0),
            (3, 99),
            (6, 0),
            (8, 1),
            (10, 0),
            (10, 12_345),
        ] {
            let first = run << m;
            let at = |i: u32| {
                sampler
                    .draw4(pixel, Ux::splat(i), Ux::splat(block))
                    .map(|d| d.to_array()[0])
            };
            let points: Vec<[f32; 4]> = (first..first + (1 << m)).map(at).collect();
            for (a, b, t) in QUALITY {
                let pair: Vec<_> = points.iter().map(|p| [p[a], p[b]]).collect();
                assert_net(
                    &format!("2^{m} from {first}, dimensions {a} and {b}"),
                    &pair,
                    t,
                );
            }
        }
    }
}

/// Each pixel's samples are a net, and so are those of every square of pixels that the curve fills.
#[test]
fn squares_of_blue_noise_pixels_are_nets() {
    for (spp, edge) in [(1, 16), (2, 8), (4, 8), (8, 4), (64, 2), (256, 1)] {
        let sampler = BlueNoise::new(11, spp);
        for (square, block) in [(0, 0), (3, 5)] {
            for step in [1, 2, 4, 8, 16].into_iter().filter(|&s| s <= edge) {
                let mut points: Vec<[f32; 4]> = Vec::new();
                for y in 0..step {
                    for x in 0..step {
                        let (x, y) = (edge * square + x, edge * (square + 1) + y);
                        let pixel = sampler.pixel(Ux::splat(x), Ux::splat(y));
                        for i in 0..spp {
                            let drawn = sampler.draw4(pixel, Ux::splat(i), Ux::splat(block));
                            points.push(drawn.map(|d| d.to_array()[0]));
                        }
                    }
                }
                for (a, b, t) in QUALITY {
                    let pair: Vec<_> = points.iter().map(|p| [p[a], p[b]]).collect();
                    assert_net(
                        &format!("{spp} samples, {step} pixels, {a} and {b}"),
                        &pair,
                        t,
                    );
                }
            }
        }
    }
}

/// The whole index: samples and Morton code fill 32 bits whatever the number of samples, and what
/// does not fit sets independent squares apart.
#[test]
fn blue_noise_squares_are_as_large_as_the_index_allows() {
    for (spp, bits) in [
        (1, 0),
        (2, 1),
        (3, 2),
        (64, 6),
        (100, 7),
        (65_536, 16),
        (1 << 30, 30),
        (1 << 31, 31),
    ] {
        let sampler = BlueNoise::new(0, spp);
        assert_eq!(sampler.period(), 1 << bits, "{spp}");
        // Neighbours across a square's border share no scrambling: with equal indices otherwise,
        // their points would be equal where sets repeat, and differ by a net's stratum within one.
        let edge = 1u32 << ((32 - bits) / 2);
        let at = |x: u32| {
            let pixel = sampler.pixel(Ux::splat(x), Ux::splat(0));
            sampler
                .draw4(pixel, Ux::splat(0), Ux::splat(0))
                .map(|d| d.to_array()[0])
        };
        let (near, far) = (at(0), at(edge & 0xffff));
        assert_eq!(near == far, edge > 0xffff, "{spp}: {near:?}, {far:?}");
    }
}

#[test]
fn every_stratum_holds_one_sample() {
    for spp in [1u32, 2, 3, 4, 7, 12, 13, 16, 100, 128, 1000, 1023] {
        let sampler = Stratified::new(5, spp);
        let (across, down) = sampler.grid();
        assert!(across * down >= spp && across * (down - 1) < spp, "{spp}");
        let full = across * down == spp;
        for (x, block) in [(0, 0), (300, 9)] {
            let pixel = sampler.pixel(Ux::splat(x), Ux::splat(1));
            let at = |i: u32| {
                sampler
                    .draw4(pixel, Ux::splat(i), Ux::splat(block))
                    .map(|d| d.to_array()[0])
            };
            let points: Vec<[f32; 4]> = (0..spp).map(at).collect();
            for pair in [0, 2] {
                let count = |cells: u32, cell: &dyn Fn(&[f32; 4]) -> u32| {
                    let mut counts = vec![0; cells as usize];
                    points.iter().for_each(|p| counts[cell(p) as usize] += 1);
                    counts
                };
                // A jitter just below 1 may round up into the next stratum: of 24 bits, at these
                // sizes, that is rarer than one in ten thousand; the seeds here meet none.
                let slice = |v: f32, n: u32| (v * n as f32) as u32;
                let lying = count(spp, &|p| slice(p[pair + 1], spp));
                assert!(lying.iter().all(|&c| c == 1), "{spp}: {lying:?}");
                let upright = count(across * down, &|p| slice(p[pair], across * down));
                assert!(upright.iter().all(|&c| c <= 1), "{spp}: {upright:?}");
                if full {
                    let cells = count(spp, &|p| {
                        slice(p[pair], across) * down + slice(p[pair + 1], down)
                    });
                    assert!(cells.iter().all(|&c| c == 1), "{spp}: {cells:?}");
                }
            }
        }
    }
}

/// Owen's scrambling as he defines it: a fair coin at every node of the binary tree.
struct Coins<'a> {
    source: &'a mut Source,
    flips: Vec<Option<bool>>,
    bits: u32,
}

impl<'a> Coins<'a> {
    fn new(source: &'a mut Source, bits: u32) -> Self {
        Self {
            source,
            flips: vec![None; 1 << bits],
            bits,
        }
    }

    fn flip(&mut self, x: u32) -> u32 {
        let (mut node, mut out) = (1usize, 0);
        for bit in (0..self.bits).rev() {
            let set = (x >> bit) & 1;
            let coin = *self.flips[node].get_or_insert_with(|| self.source.bits() >> 63 == 1);
            out = 2 * out + (set ^ u32::from(coin));
            node = 2 * node + set as usize;
        }
        out
    }
}

/// Mean and its variance.
fn estimate(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let squares: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
    (mean, squares / (n * (n - 1.0)))
}

/// The hash scrambles as coins would: over many pixels, the mean square error of means of products,
/// of two dimensions in one block (scrambling) and in two blocks (shuffling), is that of points made
/// with coins. A hash whose coins follow each other would pair the points of two blocks otherwise.
#[test]
fn scrambling_and_shuffling_are_as_good_as_coins() {
    const BITS: u32 = 6;
    const PIXELS: u32 = 3000;
    let n = 1u32 << BITS;
    let mean_product = |a: &[f64], b: &[f64]| {
        let products = a.iter().zip(b).map(|(x, y)| (x - 0.5) * (y - 0.5));
        products.sum::<f64>() / f64::from(n)
    };
    let mut source = Source(7);
    // Dimensions 0 and 1 of a block, shuffled and scrambled by coins.
    let mut by_coins = || -> [Vec<f64>; 2] {
        let mut coins = Coins::new(&mut source, BITS);
        let order: Vec<u32> = (0..n).map(|i| coins.flip(i)).collect();
        [0, 1].map(|dimension| {
            let mut coins = Coins::new(&mut source, BITS);
            let stratum = |&i: &u32| coins.flip(sobol_twin(i, dimension) >> (32 - BITS));
            let strata: Vec<u32> = order.iter().map(stratum).collect();
            let point = |s| (f64::from(s) + f64::from(source.unit())) / f64::from(n);
            strata.into_iter().map(point).collect()
        })
    };
    let sampler = Sobol { seed: 1 };
    let hashed = |p: u32, block: u32| -> [Vec<f64>; 2] {
        let pixel = sampler.pixel(Ux::splat(p % 60), Ux::splat(p / 60));
        let mut block_points = [Vec::new(), Vec::new()];
        for i in (0..n).step_by(LANES) {
            let drawn = sampler.draw4(pixel, iota(i), Ux::splat(block));
            for (points, drawn) in block_points.iter_mut().zip(drawn) {
                points.extend(drawn.to_array().map(f64::from));
            }
        }
        block_points
    };
    let mut squares: [[Vec<f64>; 2]; 2] = Default::default();
    for p in 0..PIXELS {
        for (k, [[a, b], [c, _]]) in [[by_coins(), by_coins()], [hashed(p, 1), hashed(p, 2)]]
            .into_iter()
            .enumerate()
        {
            squares[k][0].push(mean_product(&a, &b).powi(2));
            squares[k][1].push(mean_product(&a, &c).powi(2));
        }
    }
    for (what, coins, hash) in [
        ("one block", &squares[0][0], &squares[1][0]),
        ("two blocks", &squares[0][1], &squares[1][1]),
    ] {
        let [(a, va), (b, vb)] = [coins, hash].map(|s| estimate(s));
        // Two comparisons share common::SIGNIFICANCE: 4.06 standard errors each.
        let z = (a - b) / (va + vb).sqrt();
        assert!(
            z.abs() < 4.06,
            "{what}: {a:e} by coins, {b:e} hashed, z = {z}"
        );
    }
}
