//! Roulette: which scattered paths go on, and how far.
//!
//! In: scattered paths. Out: survivors, compacted in order to the front of the path queue, weighed
//! by the inverse of their chance; those at the maximum depth marked as on their last ray.

use super::queue::Queue;
use super::sampling::{AnySampler, with_sampler};
use huygens_kernels::bare::COMPLETE;
use huygens_kernels::compact::Kept;
use huygens_kernels::queues::PathsMut;
use huygens_kernels::roulette::{Rules, roulette};

/// Runs the stage; `signed` where throughput may be negative. `kept` is scratch space for one entry a vector.
pub(crate) fn run(
    signed: bool,
    rules: Rules,
    sampler: AnySampler,
    scattered: &mut Queue<PathsMut<'static>>,
    kept: &mut Vec<Kept>,
    paths: &mut Queue<PathsMut<'static>>,
    mut dropped: impl FnMut(u32),
) {
    kept.clear();
    let n = scattered.len();
    let mut all = scattered.view_mut();
    with_sampler!(sampler, s => match COMPLETE && signed {
        true => roulette::<_, true>(n, &mut all, rules, s, kept, &mut dropped),
        false => roulette::<_, false>(n, &mut all, rules, s, kept, &mut dropped),
    });
    paths.set_len(0);
    paths.append_kept(scattered, kept);
}
