//! Samplers, one point at a time: what their definitions say, uniform, and in range whatever goes in.

mod common;

use common::{Suite, pcg4d_twin};
use huygens_kernels::lanes::{LANES, Ux, iota};
use huygens_kernels::sampler::{
    Apart, Block, BlueNoise, Independent, Sampler, Sobol, Stratified, apart, block, sobol,
};
use proptest::prelude::*;

/// MurmurHash3's finalizer, as published.
fn finalizer(h: u32) -> u32 {
    let h = (h ^ (h >> 16)).wrapping_mul(0x85eb_ca6b);
    let h = (h ^ (h >> 13)).wrapping_mul(0xc2b2_ae35);
    h ^ (h >> 16)
}

/// Vegdahl's hash with a factor of its own, on a number whose most significant bits choose the coins
/// of those below.
fn scrambled(x: u32, seed: u32, factor: u32) -> u32 {
    let mut x = x.reverse_bits();
    x ^= x.wrapping_mul(0x3d20_adea);
    x = x.wrapping_add(seed);
    x = x.wrapping_mul(factor | 1);
    x ^= x.wrapping_mul(0x0552_6c56);
    x ^= x.wrapping_mul(0x53a2_2864);
    x.reverse_bits()
}

/// Words of which all bits count.
fn seeds(counter: [u32; 4]) -> [u32; 4] {
    pcg4d_twin(counter).map(|w| w ^ (w >> 16))
}

/// Point `index` of the shuffled and scrambled sequence that four words choose.
fn owen_sobol(words: [u32; 4], index: u32) -> [u32; 4] {
    let [p, q, r, s] = words;
    let order = finalizer((p ^ (r >> 3)).wrapping_add(q ^ (s << 5)));
    let index = scrambled(index, order, p) ^ scrambled(0, order, p);
    let point = sobol(Ux::splat(index)).map(|d| d.to_array()[0]);
    let seeds = [p, q, r, s, order];
    std::array::from_fn(|d| scrambled(point[d], seeds[d], seeds[d + 1]) >> 8)
}

fn sobol_sampler_twin(seed: u32, [x, y, sample, block]: [u32; 4]) -> [u32; 4] {
    let pixel = finalizer((y << 16) | x);
    owen_sobol(seeds([pixel, 0, block, finalizer(seed)]), sample)
}

fn blue_noise_twin(seed: u32, spp: u32, [x, y, sample, block]: [u32; 4]) -> [u32; 4] {
    let bits = (0..31).find(|&b| 1u64 << b >= u64::from(spp)).unwrap_or(31);
    let levels = (32 - bits) / 2;
    // What is not part of the index: coordinates in squares of 2^levels pixels, in Morton order and
    // in the places of the reversed code; further ranges of samples.
    let code = |x: u32, y: u32, from: u32, to: u32| -> u32 {
        (from..to).fold(0, |sum, k| {
            sum | (((x >> k) & 1) << (31 - 2 * k)) | (((y >> k) & 1) << (30 - 2 * k))
        })
    };
    let words = seeds([
        code(x, y, levels, 16),
        sample >> bits,
        block,
        finalizer(seed),
    ]);
    let [p, q, r, s] = words;
    let order = finalizer((p ^ (r >> 3)).wrapping_add(q ^ (s << 5)));
    // From the largest quarters to the smallest, a coin that the ones above choose swaps the axes.
    let place = code(x, y, 0, levels).reverse_bits();
    let coins = place ^ scrambled(place, !order, order >> 7);
    let mut index = 0;
    for level in (0..levels).rev() {
        let (mut low, mut high) = ((place >> (2 * level)) & 1, (place >> (2 * level + 1)) & 1);
        if (coins >> (2 * level + 1)) & 1 == 1 {
            std::mem::swap(&mut low, &mut high);
        }
        index = 4 * index + 2 * high + low;
    }
    let within = u64::from(sample) % (1 << bits);
    owen_sobol(words, ((u64::from(index) << bits) | within) as u32)
}

/// Kensler's permutation (2013, listing 1) with the offset scaled instead of reduced.
fn permute_twin(i: u32, count: u32, seed: u32) -> u32 {
    let mut w = count - 1;
    for shift in [1, 2, 4, 8, 16] {
        w |= w >> shift;
    }
    let mut i = i;
    loop {
        i ^= seed;
        i = i.wrapping_mul(0xe170_893d);
        i ^= seed >> 16;
        i ^= (i & w) >> 4;
        i ^= seed >> 8;
        i = i.wrapping_mul(0x0929_eb3f);
        i ^= seed >> 23;
        i ^= (i & w) >> 1;
        i = i.wrapping_mul(1 | (seed >> 27));
        i = i.wrapping_mul(0x6935_fa69);
        i ^= (i & w) >> 11;
        i = i.wrapping_mul(0x74dc_b303);
        i ^= (i & w) >> 2;
        i = i.wrapping_mul(0x9e50_1cc3);
        i ^= (i & w) >> 2;
        i = i.wrapping_mul(0xc860_a3df);
        i &= w;
        i ^= i >> 5;
        if i < count {
            break;
        }
    }
    let offset = (u64::from(seed) * u64::from(count)) >> 32;
    ((u64::from(i) + offset) % u64::from(count)) as u32
}

fn stratified_twin(seed: u32, spp: u32, [x, y, sample, block]: [u32; 4]) -> [f64; 4] {
    let across = f64::from(spp).sqrt().floor() as u32;
    let down = spp.div_ceil(across);
    let pixel = finalizer((y << 16) | x);
    let jitter = pcg4d_twin([pixel, sample, block, finalizer(seed)])
        .map(|w| f64::from(w >> 8) / 16_777_216.0);
    let pair = |word: u32, jitter: [f64; 2]| {
        let s = permute_twin(sample, spp, word.wrapping_mul(0x5163_3e2d));
        let column = permute_twin(s % across, across, word.wrapping_mul(0x68bc_21eb));
        let row = permute_twin(s / across, down, word.wrapping_mul(0x02e5_be93));
        let [column, row, s, n] = [column, row, s, spp].map(f64::from);
        let (across, down) = (f64::from(across), f64::from(down));
        [
            (column + (row + jitter[0]) / down) / across,
            (s + jitter[1]) / n,
        ]
    };
    let [p, q, ..] = seeds([pixel, u32::MAX, block, finalizer(seed)]);
    let [u, v] = pair(p, [jitter[0], jitter[1]]);
    let [s, t] = pair(q, [jitter[2], jitter[3]]);
    [u, v, s, t]
}

proptest! {
    #[test]
    fn every_lane_is_the_scalar_sampler(
        x: [u16; LANES], y: [u16; LANES], sample: [u32; LANES], block: [u32; LANES], seed: u32,
        large in 1..=1u32 << 31, small in 1..=300u32
    ) {
        let [x, y] = [x, y].map(|c| c.map(u32::from));
        for spp in [small, large] {
            let sample = sample.map(|s| s % spp);
            let counters: Vec<[u32; 4]> = (0..LANES).map(|l| [x[l], y[l], sample[l], block[l]]).collect();
            fn draw<S: Sampler>(s: S, [x, y, sample, block]: [[u32; LANES]; 4]) -> [[f32; LANES]; 4] {
                s.draw4(s.pixel(Ux::new(x), Ux::new(y)), Ux::new(sample), Ux::new(block)).map(|d| d.to_array())
            }
            let words = [x, y, sample, block];
            let on_grid = [
                (draw(Sobol { seed }, words), counters.iter().map(|&c| sobol_sampler_twin(seed, c)).collect::<Vec<_>>()),
                (draw(BlueNoise::new(seed, spp), words), counters.iter().map(|&c| blue_noise_twin(seed, spp, c)).collect()),
            ];
            for (drawn, twin) in on_grid {
                for l in 0..LANES {
                    prop_assert_eq!(drawn.map(|d| (d[l] * 16_777_216.0) as u32), twin[l]);
                }
            }
            let drawn = draw(Stratified::new(seed, spp), words);
            for l in 0..LANES {
                for (d, twin) in stratified_twin(seed, spp, counters[l]).into_iter().enumerate() {
                    // A sum, a reciprocal and a product round by 2^-24 of numbers below 1 each, and
                    // the largest number is cut by as much.
                    prop_assert!((f64::from(drawn[d][l]) - twin).abs() <= 4.0 / 16_777_216.0,
                        "dimension {}: {}, {}", d, drawn[d][l], twin);
                }
            }
        }
    }
}

/// All four samplers, for `spp` samples a pixel.
fn each(
    spp: u32,
    seed: u32,
    mut with: impl FnMut(&str, &dyn Fn(Ux, Ux, Ux, Ux) -> [[f32; LANES]; 4]),
) {
    fn draw<S: Sampler>(s: S) -> impl Fn(Ux, Ux, Ux, Ux) -> [[f32; LANES]; 4] {
        move |x, y, sample, block| s.draw4(s.pixel(x, y), sample, block).map(|d| d.to_array())
    }
    with("independent", &draw(Independent { seed }));
    with("stratified", &draw(Stratified::new(seed, spp)));
    with("sobol", &draw(Sobol { seed }));
    with("blue noise", &draw(BlueNoise::new(seed, spp)));
}

#[test]
fn every_dimension_and_pair_is_uniform_over_seeds_and_blocks() {
    let mut suite = Suite::default();
    for (spp, sample) in [(1, 0), (16, 0), (16, 11), (11, 10), (4096, 4095)] {
        let mut coarse = vec![[[0u64; 64]; 4]; 4];
        let mut fine = vec![[[0u64; 64]; 4]; 4];
        let mut pairs = vec![[[0u64; 64]; 6]; 4];
        // Eight blocks a seed: no two of these points share a scrambling.
        for seed in 0..4096 {
            let mut k = 0;
            each(spp, seed, |_, draw| {
                let drawn = draw(Ux::splat(200), Ux::splat(77), Ux::splat(sample), iota(3));
                for l in 0..LANES {
                    let point = drawn.map(|d| d[l]);
                    for (d, value) in point.into_iter().enumerate() {
                        coarse[k][d][(value * 64.0) as usize] += 1;
                        // 18 bits in: far below the strata of any number of samples here.
                        fine[k][d][((value * 16_777_216.0) as usize) & 63] += 1;
                    }
                    let mut pair = 0;
                    for a in 0..4 {
                        for b in a + 1..4 {
                            let cell = (point[a] * 8.0) as usize * 8 + (point[b] * 8.0) as usize;
                            pairs[k][pair][cell] += 1;
                            pair += 1;
                        }
                    }
                }
                k += 1;
            });
        }
        for k in 0..4 {
            let name = ["independent", "stratified", "sobol", "blue noise"][k];
            for d in 0..4 {
                suite.test_uniform(
                    &format!("{name}, {sample} of {spp}, dimension {d}"),
                    &coarse[k][d],
                );
                // Stratified numbers are sums and quotients in f32, on no grid of 2^-24.
                if k != 1 {
                    suite.test_uniform(
                        &format!("{name}, {sample} of {spp}, low bits of {d}"),
                        &fine[k][d],
                    );
                }
            }
            for (pair, cells) in pairs[k].iter().enumerate() {
                suite.test_uniform(&format!("{name}, {sample} of {spp}, pair {pair}"), cells);
            }
        }
    }
    suite.finish();
}

/// A point of one block against the same path's point of the next.
#[test]
fn blocks_are_independent() {
    let mut suite = Suite::default();
    let mut cells = vec![[[0u64; 64]; 16]; 4];
    for seed in 0..2048 {
        let mut k = 0;
        each(16, seed, |_, draw| {
            let drawn = draw(Ux::splat(seed), Ux::splat(1), Ux::splat(5), iota(0));
            // Even blocks and the odd ones behind them: disjoint, so the pairs are independent.
            for l in (0..LANES).step_by(2) {
                for a in 0..4 {
                    for b in 0..4 {
                        let [x, y] = [drawn[a][l], drawn[b][l + 1]].map(|v| (v * 8.0) as usize);
                        cells[k][4 * a + b][8 * x + y] += 1;
                    }
                }
            }
            k += 1;
        });
    }
    for (k, cells) in cells.iter().enumerate() {
        for (pair, cells) in cells.iter().enumerate() {
            suite.test_uniform(&format!("sampler {k}, pair {pair}"), cells);
        }
    }
    suite.finish();
}

/// What a path draws apart, against what it draws for its direction.
#[test]
fn numbers_drawn_apart_are_independent_of_the_others() {
    let mut suite = Suite::default();
    for what in [Apart::Wavelength, Apart::Medium, Apart::Time] {
        let mut cells = vec![[[0u64; 64]; 16]; 4];
        for seed in 0..4096 {
            let mut k = 0;
            each(16, seed, |_, draw| {
                let at = |block| draw(Ux::splat(seed), Ux::splat(1), Ux::splat(5), block);
                let own = at(block(iota(0), Block::Direction));
                let other = at(apart(iota(0), what));
                for l in 0..LANES {
                    for a in 0..4 {
                        for b in 0..4 {
                            let [x, y] = [own[a][l], other[b][l]].map(|v| (v * 8.0) as usize);
                            cells[k][4 * a + b][8 * x + y] += 1;
                        }
                    }
                }
                k += 1;
            });
        }
        for (k, cells) in cells.iter().enumerate() {
            for (pair, cells) in cells.iter().enumerate() {
                suite.test_uniform(&format!("{what:?}, sampler {k}, pair {pair}"), cells);
            }
        }
    }
    suite.finish();
}

proptest! {
    /// Lanes without a path hold anything, and must neither hang nor leave the range.
    #[test]
    fn anything_goes_in_and_numbers_below_one_come_out(
        pixel: [u32; LANES], sample: [u32; LANES], block: [u32; LANES], seed: u32, spp in 1..=1u32 << 31
    ) {
        fn check<S: Sampler>(s: S, words: [[u32; LANES]; 3]) -> Result<(), TestCaseError> {
            let [pixel, sample, block] = words.map(Ux::new);
            for value in s.draw4(pixel, sample, block).map(|d| d.to_array()).as_flattened() {
                prop_assert!((0.0..=1.0 - 1.0 / 16_777_216.0).contains(value), "{}", value);
            }
            Ok(())
        }
        for spp in [spp, spp % 64 + 1, 1 << 31] {
            let words = [pixel, sample, block];
            check(Independent { seed }, words)?;
            check(Stratified::new(seed, spp), words)?;
            check(Sobol { seed }, words)?;
            check(BlueNoise::new(seed, spp), words)?;
        }
    }
}
