//! What one core of this machine can do, by short loops: the roofs of a roofline.
//!
//! Each loop is run several times and the best is taken: whatever else the machine does can only
//! slow one down. The arithmetic is that of the kernels (their vectors, this build's instruction
//! set), so the peak is what this program could reach, not what the data sheet says.

use huygens_kernels::lanes::{Fx, LANES};
use serde::Serialize;
use std::hint::black_box;
use std::time::Instant;

/// Limits of one core.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Limits {
    /// 10^9 operations on `f32` a second: independent fused multiply-adds, two operations each.
    pub gigaoperations: f64,
    /// 10^9 bytes a second, read from a buffer that stays in the second-level cache.
    pub near: f64,
    /// 10^9 bytes a second, read from a buffer far larger than that.
    pub far: f64,
}

/// Bytes of the near buffer: with room in any second-level cache of today, beyond any first-level one.
const NEAR: usize = 192 << 10;
/// Bytes of the far buffer.
const FAR: usize = 192 << 20;
/// Times each loop is run.
const RUNS: usize = 7;

impl Limits {
    /// Measures the core that the calling thread runs on: about a quarter of a second.
    #[must_use]
    pub fn measure() -> Self {
        Self {
            gigaoperations: best(RUNS, operations) * 1e-9,
            near: {
                let buffer = vec![1.0f32; NEAR / 4];
                best(RUNS, || read(&buffer, 256)) * 1e-9
            },
            far: {
                let buffer = vec![1.0f32; FAR / 4];
                best(3, || read(&buffer, 1)) * 1e-9
            },
        }
    }

    /// The most operations (10^9 a second) that a kernel of so many operations a byte can do, out of
    /// the near buffer.
    #[must_use]
    pub fn roof(&self, intensity: f64) -> f64 {
        self.gigaoperations.min(self.near * intensity)
    }
}

/// The best rate of so many runs; `run` returns what it did.
fn best(runs: usize, mut run: impl FnMut() -> f64) -> f64 {
    let rate = |_| {
        let start = Instant::now();
        let done = run();
        done / start.elapsed().as_secs_f64()
    };
    (0..runs).map(rate).fold(0.0, f64::max)
}

/// Chains that hide each other's latency: two units of a latency of four or five, and some to spare,
/// within sixteen registers.
const CHAINS: usize = 12;

fn operations() -> f64 {
    let rounds = 400_000;
    let mut chains: [Fx; CHAINS] = std::array::from_fn(|i| Fx::splat(i as f32));
    let (a, b) = (black_box(Fx::splat(0.5)), black_box(Fx::splat(1.0)));
    for _ in 0..rounds {
        for chain in &mut chains {
            *chain = chain.mul_add(a, b);
        }
    }
    black_box(chains);
    (2 * rounds * CHAINS * LANES) as f64
}

fn read(buffer: &[f32], times: usize) -> f64 {
    for _ in 0..times {
        let mut sums = [Fx::ZERO; 8];
        for line in black_box(buffer).chunks_exact(8 * LANES) {
            for (sum, lanes) in sums.iter_mut().zip(line.chunks_exact(LANES)) {
                let lanes: [f32; LANES] = lanes.try_into().expect("chunks of one vector");
                *sum += Fx::new(lanes);
            }
        }
        black_box(sums);
    }
    (size_of_val(buffer) * times) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_roof_is_the_lower_of_both() {
        let limits = Limits {
            gigaoperations: 80.0,
            near: 40.0,
            far: 10.0,
        };
        assert_eq!(limits.roof(0.5), 20.0);
        assert_eq!(limits.roof(2.0), 80.0);
        assert_eq!(limits.roof(100.0), 80.0);
    }

    #[test]
    fn a_machine_has_limits() {
        let limits = Limits::measure();
        for limit in [limits.gigaoperations, limits.near, limits.far] {
            assert!(limit.is_finite() && limit > 0.0, "{limits:?}");
        }
    }
}
