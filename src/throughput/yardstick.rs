//! Yardsticks: fixed pieces of work.

use crate::pages::Table;
use crate::processor::thread_cpu_seconds;
use huygens_kernels::lanes::{Fx, LANES, Ux, gather};
use std::hint::black_box;
use std::sync::OnceLock;
use std::time::Instant;

/// Words of the table that is looked up: 256 KiB, which live in a second-level cache as queues do.
const TABLE: usize = 1 << 16;
/// Rounds: some ten milliseconds.
const ROUNDS: u32 = 1_000_000;

/// Words of the table in memory, as a power of two: 32 MiB, far beyond second-level caches.
const FAR_BITS: u32 = 23;
/// Rounds over it: some ten milliseconds.
const FAR_ROUNDS: u32 = 200_000;

/// Processor seconds of the work (wall-clock seconds where the system tells no others).
fn timed<T>(work: impl FnOnce() -> T) -> f64 {
    let (wall, cpu) = (Instant::now(), thread_cpu_seconds());
    black_box(work());
    match cpu.zip(thread_cpu_seconds()) {
        Some((from, to)) => to - from,
        None => wall.elapsed().as_secs_f64(),
    }
}

/// The next random words: Numerical Recipes' linear congruential generator, whose upper bits are good.
fn next(state: Ux) -> Ux {
    state * Ux::splat(1_664_525) + Ux::splat(1_013_904_223)
}

/// Where it starts.
fn first() -> Ux {
    Ux::new(std::array::from_fn(|lane| 0x9e37_79b9 ^ lane as u32))
}

/// Looks words of a large table up, at random, and returns the processor seconds: what waits for memory
/// takes as many times longer as this does, at most.
#[must_use]
pub fn memory_yardstick() -> f64 {
    static TABLE: OnceLock<Table<f32>> = OnceLock::new();
    // Written, or all of its pages were one; and on large ones, or where the system put the small ones would be
    // measured, which differs by a quarter from one start to the next.
    let table = TABLE.get_or_init(|| {
        let mut table = Table::zeroed(1 << FAR_BITS);
        for (i, word) in table.iter_mut().enumerate() {
            *word = (i % 17) as f32;
        }
        table
    });
    timed(|| {
        let (mut state, mut sum) = (first(), Fx::ZERO);
        for _ in 0..FAR_ROUNDS {
            state = next(state);
            let place: Ux = state >> (32 - FAR_BITS);
            sum += gather(table, place);
        }
        sum
    })
}

/// Does the work once and returns its processor seconds.
#[must_use]
pub fn yardstick() -> f64 {
    let table: Vec<f32> = (0..TABLE).map(|i| (i % 17) as f32 * 0.125 - 1.0).collect();
    let table = black_box(table);
    timed(|| {
        let mut state = first();
        let mut sum = [Fx::ZERO; 4];
        let mut turns = 0u32;
        for _ in 0..ROUNDS {
            state = next(state);
            let place: Ux = state >> 16_u32;
            let value = gather(&table, place);
            for (i, s) in sum.iter_mut().enumerate() {
                *s = s.mul_add(Fx::splat(0.5), value * Fx::splat(i as f32));
            }
            // A branch that goes either way.
            if value.simd_lt(Fx::ZERO).to_bitmask().count_ones() > LANES as u32 / 2 {
                turns += 1;
                sum[0] = (sum[1].abs() + Fx::ONE).sqrt();
            }
        }
        (sum, turns)
    })
}
