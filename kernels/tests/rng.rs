//! Counter-based random numbers: is the hash the published one, and do its numbers look random
//! where a renderer looks: across pixels, samples, blocks, dimensions and seeds?

mod common;

use common::{Source, Suite, pcg4d_twin as twin};
use huygens_kernels::lanes::{LANES, Ux, iota};
use huygens_kernels::rng::{pcg4d, seeds, unit};
use huygens_kernels::sampler::{Independent, Sampler};
use proptest::prelude::*;

/// The twin backwards, step by step.
fn inverse(mut v: [u32; 4]) -> [u32; 4] {
    let divide = |v: &mut [u32; 4]| {
        v[3] = v[3].wrapping_sub(v[1].wrapping_mul(v[2]));
        v[2] = v[2].wrapping_sub(v[0].wrapping_mul(v[1]));
        v[1] = v[1].wrapping_sub(v[2].wrapping_mul(v[0]));
        v[0] = v[0].wrapping_sub(v[1].wrapping_mul(v[3]));
    };
    divide(&mut v);
    v = v.map(|e| e ^ (e >> 16));
    divide(&mut v);
    // The inverse of an odd number modulo 2^32, by Newton's iteration.
    let a = 1_664_525u32;
    let one_over_a = (0..5).fold(a, |r, _| {
        r.wrapping_mul(2u32.wrapping_sub(a.wrapping_mul(r)))
    });
    v.map(|e| e.wrapping_sub(1_013_904_223).wrapping_mul(one_over_a))
}

fn lane(v: [Ux; 4], lane: usize) -> [u32; 4] {
    v.map(|e| e.to_array()[lane])
}

#[test]
fn known_answers() {
    // The published formula, evaluated elsewhere in integers of unlimited size, modulo 2^32.
    for (input, output) in KNOWN {
        assert_eq!(twin(input), output);
        assert_eq!(lane(pcg4d(input.map(Ux::splat)), 5), output);
    }
}

const KNOWN: [([u32; 4], [u32; 4]); 4] = [
    ([0; 4], [0x0f02_f829, 0x2d56_8769, 0x32b0_c43b, 0xd325_48ea]),
    (
        [1, 2, 3, 4],
        [0x3622_cd16, 0xf114_71d8, 0xe110_9b3f, 0x02b9_4c2f],
    ),
    (
        [u32::MAX; 4],
        [0x974e_d892, 0xc015_dc67, 0x9f95_5760, 0xa1bb_a208],
    ),
    (
        [123_456, 789, 5, 42],
        [0xc657_f935, 0xaac7_1a2f, 0x4158_543a, 0x118e_50d9],
    ),
];

proptest! {
    #[test]
    fn every_lane_is_the_scalar_hash_of_its_own_counter(words: [[u32; LANES]; 4]) {
        let hashed = pcg4d(words.map(Ux::new));
        for l in 0..LANES {
            prop_assert_eq!(lane(hashed, l), twin(words.map(|w| w[l])));
        }
    }

    #[test]
    fn the_hash_is_a_bijection(words: [u32; 4]) {
        prop_assert_eq!(inverse(twin(words)), words);
        prop_assert_eq!(twin(inverse(words)), words);
    }

    #[test]
    fn numbers_are_multiples_of_their_grid_below_one(words: [u32; LANES]) {
        for (value, bits) in unit(Ux::new(words)).to_array().into_iter().zip(words) {
            prop_assert!((0.0..1.0).contains(&value));
            prop_assert_eq!(value * 16_777_216.0, (bits >> 8) as f32);
        }
    }
}

#[test]
fn the_ends_of_the_numbers_are_zero_and_just_below_one() {
    assert_eq!(unit(Ux::splat(0)).to_array()[0], 0.0);
    assert_eq!(unit(Ux::splat(255)).to_array()[0], 0.0);
    assert_eq!(
        unit(Ux::splat(u32::MAX)).to_array()[0],
        1.0 - 1.0 / 16_777_216.0
    );
}

/// Counters of (pixel, sample, block, seed) along one axis, the others fixed at small numbers: the
/// sequences that a render really draws.
const WALKS: [(&str, [u32; 4], usize); 4] = [
    ("pixels", [0, 3, 1, 0], 0),
    ("samples", [1234, 0, 1, 0], 1),
    ("blocks", [1234, 3, 0, 0], 2),
    ("seeds", [1234, 3, 1, 0], 3),
];

const DRAWS: u32 = 1 << 18;

/// The four dimensions at `counter`, all but the last word as vectors.
fn draw(pixel: Ux, sample: Ux, block: Ux, seed: Ux) -> [[f32; LANES]; 4] {
    pcg4d([pixel, sample, block, seed]).map(|bits| unit(bits).to_array())
}

fn walk(start: [u32; 4], axis: usize, step: u32) -> [[f32; LANES]; 4] {
    let mut counter = start.map(Ux::splat);
    counter[axis] += iota(step);
    let [pixel, sample, block, seed] = counter;
    draw(pixel, sample, block, seed)
}

#[test]
fn the_sampler_draws_what_the_hash_gives_for_its_seed() {
    let (pixel, sample, block) = (iota(77), Ux::splat(5), Ux::splat(2));
    let drawn = Independent { seed: 9 }.draw4(pixel, sample, block);
    // MurmurHash3's finalizer of 9, from its published form.
    let seed = Ux::splat(0xc27c_2913);
    let expected = draw(pixel, sample, block, seed);
    assert_eq!(drawn.map(|d| d.to_array()), expected);
}

#[test]
fn every_dimension_is_uniform_along_every_axis() {
    let mut suite = Suite::default();
    for (name, start, axis) in WALKS {
        for dimension in 0..4 {
            let (mut coarse, mut fine) = ([0u64; 256], [0u64; 256]);
            for step in (0..DRAWS).step_by(LANES) {
                for value in walk(start, axis, step)[dimension] {
                    let bits = (value * 16_777_216.0) as usize;
                    coarse[bits >> 16] += 1;
                    fine[bits & 255] += 1;
                }
            }
            suite.test_uniform(
                &format!("{name}, dimension {dimension}, high bits"),
                &coarse,
            );
            suite.test_uniform(&format!("{name}, dimension {dimension}, low bits"), &fine);
        }
    }
    suite.finish();
}

#[test]
fn pairs_of_dimensions_are_independent() {
    let mut suite = Suite::default();
    for (name, start, axis) in WALKS {
        for a in 0..4 {
            for b in a + 1..4 {
                let mut cells = [0u64; 256];
                for step in (0..DRAWS).step_by(LANES) {
                    let drawn = walk(start, axis, step);
                    for l in 0..LANES {
                        cells[cell(drawn[a][l], drawn[b][l])] += 1;
                    }
                }
                suite.test_uniform(&format!("{name}, dimensions {a} and {b}"), &cells);
            }
        }
    }
    suite.finish();
}

#[test]
fn neighbours_are_independent() {
    let mut suite = Suite::default();
    for (name, start, axis) in WALKS {
        // A walk beside this one: one step along each other axis, and an image row further on.
        for (beside, apart) in [(0, 1), (0, 512), (1, 1), (2, 1), (3, 1)] {
            if beside == axis {
                continue;
            }
            let mut other = start;
            other[beside] += apart;
            for dimension in 0..4 {
                let mut cells = [0u64; 256];
                for step in (0..DRAWS).step_by(LANES) {
                    let here = walk(start, axis, step)[dimension];
                    let there = walk(other, axis, step)[dimension];
                    for l in 0..LANES {
                        cells[cell(here[l], there[l])] += 1;
                    }
                }
                let name = format!("{name}, dimension {dimension}, +{apart} on axis {beside}");
                suite.test_uniform(&name, &cells);
            }
        }
        // Successors on the walk itself, in disjoint pairs, so that the pairs are independent.
        for dimension in 0..4 {
            let mut cells = [0u64; 256];
            for step in (0..2 * DRAWS).step_by(LANES) {
                for pair in walk(start, axis, step)[dimension].chunks_exact(2) {
                    cells[cell(pair[0], pair[1])] += 1;
                }
            }
            suite.test_uniform(
                &format!("{name}, dimension {dimension}, successors"),
                &cells,
            );
        }
    }
    suite.finish();
}

/// Two renders whose seeds differ in one bit, any of the 32, pixel by pixel.
#[test]
fn renders_with_different_seeds_are_independent() {
    let mut suite = Suite::default();
    for bit in 0..32 {
        let samplers = [0, 1 << bit].map(|seed| Independent { seed });
        let mut cells = [[0u64; 256]; 4];
        for pixel in (0..DRAWS / 4).step_by(LANES) {
            let [here, there] = samplers.map(|s| s.draw4(iota(pixel), Ux::splat(0), Ux::splat(1)));
            for (dimension, cells) in cells.iter_mut().enumerate() {
                let pairs = here[dimension]
                    .to_array()
                    .into_iter()
                    .zip(there[dimension].to_array());
                pairs.for_each(|(x, y)| cells[cell(x, y)] += 1);
            }
        }
        for (dimension, cells) in cells.iter().enumerate() {
            suite.test_uniform(&format!("seed bit {bit}, dimension {dimension}"), cells);
        }
    }
    suite.finish();
}

/// Flipping any one bit of the lower half of a counter word, where pixels, samples and blocks
/// differ, flips each bit that becomes a number with probability 1/2.
///
/// The hash does not promise this of the highest bits: a flip of bit 31 reaches too few others.
#[test]
fn the_lower_half_of_each_word_avalanches() {
    const TRIES: usize = 4096;
    // Šidák's share of SIGNIFICANCE for 4 * 16 * 96 two-sided tests is 1.6e-8, 5.65 standard
    // deviations of a count, each sqrt(TRIES) / 2.
    let most = 5.65 * (TRIES as f64).sqrt() / 2.0;
    for word in 0..4 {
        for bit in 0..16 {
            let mut source = Source(u64::from(word as u32 * 32 + bit));
            let mut flips = [[0i32; 24]; 4];
            for _ in 0..TRIES / LANES {
                let mut random = || Ux::new(std::array::from_fn(|_| source.bits() as u32));
                let counter: [Ux; 4] = std::array::from_fn(|_| random());
                let mut flipped = counter;
                flipped[word] ^= Ux::splat(1 << bit);
                let (a, b) = (pcg4d(counter), pcg4d(flipped));
                for (k, flips) in flips.iter_mut().enumerate() {
                    for difference in (a[k] ^ b[k]).to_array() {
                        for (j, count) in flips.iter_mut().enumerate() {
                            *count += ((difference >> (8 + j)) & 1) as i32;
                        }
                    }
                }
            }
            for (k, flips) in flips.iter().enumerate() {
                for (j, &count) in flips.iter().enumerate() {
                    assert!(
                        f64::from(count - TRIES as i32 / 2).abs() < most,
                        "bit {bit} of word {word} flips bit {} of word {k} {count} times of {TRIES}",
                        8 + j
                    );
                }
            }
        }
    }
}

/// Bits of the seeds of three successive vertices of a path, over many paths: all combinations alike.
#[test]
fn every_bit_of_a_seed_is_independent_over_the_vertices_of_a_path() {
    let mut suite = Suite::default();
    let mut cells = [[[0u64; 8]; 32]; 4];
    for pixel in (0..1 << 16).step_by(LANES) {
        let at = |block| seeds([iota(pixel), Ux::splat(0), Ux::splat(block), Ux::splat(0)]);
        let vertices = [1, 3, 5].map(|block| at(block).map(|word| word.to_array()));
        for (word, cells) in cells.iter_mut().enumerate() {
            for (bit, cells) in cells.iter_mut().enumerate() {
                for l in 0..LANES {
                    let cell = vertices
                        .iter()
                        .fold(0, |cell, v| 2 * cell + ((v[word][l] >> bit) & 1));
                    cells[cell as usize] += 1;
                }
            }
        }
    }
    for (word, cells) in cells.iter().enumerate() {
        for (bit, cells) in cells.iter().enumerate() {
            suite.test_uniform(&format!("bit {bit} of word {word}"), cells);
        }
    }
    suite.finish();
}

/// A 16 by 16 cell of the unit square.
fn cell(x: f32, y: f32) -> usize {
    (x * 16.0) as usize * 16 + (y * 16.0) as usize
}
