//! What must hold of the splits of a few references, and of a grid's.

use super::bounds::Bounds;
use super::cells;
use super::plan::Plan;
use super::reference::Reference;
use super::{centres, sweep};
use huygens_kernels::bvh::BLOCK;

/// `n` boxes in and about the unit cube, a quarter of them in one corner of it, some of them large.
fn boxes(n: usize) -> Vec<Reference> {
    let mut state = 9u64;
    let mut unit = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f32 / 16_777_216.0
    };
    let mut one = |i: usize| {
        let at = [(); 3].map(|()| unit() * if i.is_multiple_of(4) { 0.01 } else { 1.0 });
        let size = 0.2 * unit().powi(8);
        let end = [0, 1, 2].map(|a| at[a] + size * unit());
        Reference::new(Bounds::point(at).union(Bounds::point(end)), i as u32)
    };
    (0..n).map(&mut one).collect()
}

fn around(references: &[Reference]) -> Bounds {
    let boxes = references.iter().map(|r| r.bounds());
    boxes.fold(Bounds::EMPTY, Bounds::union)
}

fn cost_of(half: &[Reference]) -> f32 {
    around(half).half_area() * half.len().div_ceil(BLOCK) as f32
}

/// The least cost of every way to part `references` in the order of their centres along an axis.
fn least_in_order(references: &[Reference]) -> f32 {
    let along = |axis: usize| {
        let centre = |r: &Reference| r.bounds().twice_centre().max().to_array()[axis];
        let mut sorted = references.to_vec();
        sorted.sort_by(|a, b| centre(a).total_cmp(&centre(b)));
        let costs = (1..sorted.len()).map(|k| cost_of(&sorted[..k]) + cost_of(&sorted[k..]));
        costs.fold(f32::INFINITY, f32::min)
    };
    along(0).min(along(1)).min(along(2))
}

/// The least cost of every way to part `references` in two.
fn least(references: &[Reference]) -> f32 {
    let ways = 1..(1u32 << references.len()) - 1;
    let costs = ways.map(|way| {
        let half = |lower: bool| -> Vec<Reference> {
            let taken = |i: &usize| (way >> i & 1 == 0) == lower;
            let members = (0..references.len()).filter(taken);
            members.map(|i| references[i]).collect()
        };
        cost_of(&half(true)) + cost_of(&half(false))
    });
    costs.fold(f32::INFINITY, f32::min)
}

#[test]
fn sweeps_find_the_least_cost_and_say_how() {
    for n in 2..=sweep::FEW {
        for references in boxes(n * 200).chunks_exact(n) {
            let found = sweep::sweep(references);
            // Maxima, and sums of two: the same bits whatever the order.
            let expected = if n <= BLOCK {
                least(references)
            } else {
                least_in_order(references)
            };
            assert_eq!(found.cost, expected, "{n} references");
            let order: Vec<Reference> = found.order[..n]
                .iter()
                .map(|&i| references[usize::from(i)])
                .collect();
            let (lower, upper) = order.split_at(found.lower);
            assert_eq!(cost_of(lower) + cost_of(upper), found.cost);
            let mut places = found.order[..n].to_vec();
            places.sort_unstable();
            assert!(
                places
                    .iter()
                    .enumerate()
                    .all(|(i, &at)| i == usize::from(at))
            );
        }
    }
}

#[test]
fn equal_references_are_parted_all_the_same() {
    for n in 2..=sweep::FEW {
        let same = vec![Reference::new(Bounds::point([1.0, 2.0, 3.0]), 7); n];
        let found = sweep::sweep(&same);
        assert!((1..n).contains(&found.lower), "{n}: {}", found.lower);
    }
}

/// Checks that a plan's halves hold its references, in their old order within a bucket, and counts
/// the buckets.
fn check(plan: &Plan, references: &[Reference]) -> usize {
    assert_eq!(plan.count, references.len());
    assert_eq!(
        plan.bounds.to_aabb(),
        around(references).to_aabb(),
        "boxes are tight"
    );
    match &plan.halves {
        Some(halves) => {
            let (low, high) = references.split_at(halves[0].count);
            assert!(!low.is_empty() && !high.is_empty());
            check(&halves[0], low) + check(&halves[1], high)
        }
        None => {
            let in_order = |pair: &[Reference]| pair[0].triangle() < pair[1].triangle();
            assert!(references.windows(2).all(in_order));
            1
        }
    }
}

#[test]
fn grids_part_all_references_and_alike_for_any_number_of_threads() {
    // Enough for three tasks.
    let from = boxes(60_000);
    let part = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let mut to = vec![Reference::new(Bounds::EMPTY, 0); from.len()];
        let plan = pool
            .build()
            .unwrap()
            .install(|| cells::part(&from, &mut to, centres(&from)));
        let buckets = check(&plan.expect("far from one bucket"), &to);
        assert!(buckets > 20, "{buckets} buckets");
        to.iter().map(|r| r.triangle()).collect::<Vec<_>>()
    };
    let one = part(1);
    let mut all = one.clone();
    all.sort_unstable();
    assert!(all.iter().enumerate().all(|(i, &t)| i == t as usize));
    for threads in [2, 3, 5] {
        assert_eq!(part(threads), one, "{threads} threads");
    }
}

#[test]
fn grids_leave_alone_what_they_cannot_part() {
    let same = vec![Reference::new(Bounds::point([1.0, 2.0, 3.0]), 7); 5000];
    let mut to = same.clone();
    assert!(cells::part(&same, &mut to, centres(&same)).is_none());
}
