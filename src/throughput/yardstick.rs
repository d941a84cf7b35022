//! The yardstick: a fixed piece of work.

use crate::processor::thread_cpu_seconds;
use huygens_kernels::lanes::{Fx, LANES, Ux, gather};
use std::hint::black_box;
use std::time::Instant;

/// Words of the table that is looked up: 256 KiB, which live in a second-level cache as queues do.
const TABLE: usize = 1 << 16;
/// Rounds: some ten milliseconds.
const ROUNDS: u32 = 400_000;

/// Does the work once and returns its processor seconds (wall-clock seconds where the system tells no
/// others).
#[must_use]
pub fn yardstick() -> f64 {
    let table: Vec<f32> = (0..TABLE).map(|i| (i % 17) as f32 * 0.125 - 1.0).collect();
    let table = black_box(table);
    let (wall, cpu) = (Instant::now(), thread_cpu_seconds());
    let mut state = Ux::new(std::array::from_fn(|lane| 0x9e37_79b9 ^ lane as u32));
    let mut sum = [Fx::ZERO; 4];
    let mut turns = 0u32;
    for _ in 0..ROUNDS {
        // Numerical Recipes' linear congruential generator; its upper bits choose the places.
        state = state * Ux::splat(1_664_525) + Ux::splat(1_013_904_223);
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
    black_box((sum, turns));
    match cpu.zip(thread_cpu_seconds()) {
        Some((from, to)) => to - from,
        None => wall.elapsed().as_secs_f64(),
    }
}
