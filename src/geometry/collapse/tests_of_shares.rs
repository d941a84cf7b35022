//! What must hold of how nodes are shared out.

use super::*;

/// Costs of at most so many roots that fall, of a subtree with `leaves` leaves.
fn subtree(unit: &mut impl FnMut() -> f32, leaves: u32) -> Subtree {
    let mut costs = [f32::INFINITY; WIDTH];
    let mut cost = 10.0;
    for k in 0..(WIDTH - 1).min(leaves as usize) {
        costs[k] = cost;
        // Some more roots bring nothing, so that there are ties.
        cost -= (3.0 * unit()).floor() * 0.5;
    }
    Subtree {
        costs,
        leaves,
        references: leaves,
    }
}

/// As the header says, one number of roots after the other.
fn plainly(area: f32, leaf: f32, left: &Subtree, right: &Subtree) -> [f32; WIDTH - 1] {
    let best = |roots: usize| {
        let splits = (1..roots).map(|k| left.costs[k - 1] + right.costs[roots - k - 1]);
        splits.fold(f32::INFINITY, f32::min)
    };
    let all = (left.leaves + right.leaves) as usize;
    let mut costs = [f32::INFINITY; WIDTH - 1];
    costs[0] = leaf.min(area * NODE_COST + best(all.min(WIDTH)));
    for roots in 2..WIDTH.min(all + 1) {
        costs[roots - 1] = best(roots).min(costs[roots - 2]);
    }
    costs
}

#[test]
fn shares_cost_the_least_and_what_they_say() {
    let mut state = 3u64;
    let mut unit = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f32 / 16_777_216.0
    };
    for _ in 0..20_000 {
        let mut leaves = || 1 + (12.0 * unit().powi(2)) as u32;
        let (of_left, of_right) = (leaves(), leaves());
        let left = subtree(&mut unit, of_left);
        let right = subtree(&mut unit, of_right);
        let all = (of_left + of_right) as usize;
        let leaf = if unit() < 0.5 {
            f32::INFINITY
        } else {
            20.0 * unit()
        };
        let area = 4.0 * unit();
        let (costs, shares) = decide(area, leaf, &left, &right);
        // The same sums of two, so the same bits.
        assert_eq!(costs[..WIDTH - 1], plainly(area, leaf, &left, &right));
        assert_eq!(costs[WIDTH - 1], f32::INFINITY);
        for roots in (1..=WIDTH).filter(|&roots| roots <= all) {
            let says = match Share(shares[roots - 1]).split() {
                Some((from_left, from_right)) => {
                    assert!(from_left + from_right <= roots);
                    left.costs[from_left - 1] + right.costs[from_right - 1]
                }
                None if shares[roots - 1] == Share::LEAF.0 => leaf,
                None => costs[0],
            };
            if roots < WIDTH {
                assert_eq!(says, costs[roots - 1], "{roots} roots");
            } else {
                let own = area * NODE_COST + says;
                assert!(own == costs[0] || costs[0] == leaf, "{own}, {costs:?}");
            }
        }
    }
}
