//! What must hold of a tree whose nodes were moved.

use super::*;
use glam::Vec3A;

/// A tree over `n` boxes in the unit cube, halved in the order in which they come.
fn random_tree(n: u32) -> Vec<Bvh2Node> {
    let mut state = 1u64;
    let mut unit = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f32 / 16_777_216.0
    };
    let mut leaf = || {
        let low = Vec3A::new(unit(), unit(), unit());
        Aabb::new(low, low + 0.05 * Vec3A::new(unit(), unit(), unit()))
    };
    let leaves: Vec<Aabb> = (0..n).map(|_| leaf()).collect();
    let mut nodes = vec![Bvh2Node::default()];
    grow(&mut nodes, 0, &leaves, 0);
    nodes
}

fn grow(nodes: &mut Vec<Bvh2Node>, at: usize, leaves: &[Aabb], first: u32) {
    let around = leaves.iter().fold(Aabb::INVALID, |sum, of| sum.union(of));
    if leaves.len() == 1 {
        nodes[at] = Bvh2Node::new(around, 1, first);
        return;
    }
    let children = nodes.len();
    nodes[at] = Bvh2Node::new(around, 0, children as u32);
    nodes.extend([Bvh2Node::default(); 2]);
    let (low, high) = leaves.split_at(leaves.len() / 2);
    grow(nodes, children, low, first);
    grow(nodes, children + 1, high, first + low.len() as u32);
}

/// Checks boxes and gathers leaves; the sum of the areas of inner nodes.
fn check(nodes: &[Bvh2Node], at: u32, leaves: &mut Vec<u32>) -> f64 {
    let node = &nodes[at as usize];
    if node.is_leaf() {
        leaves.push(node.first_index);
        return 0.0;
    }
    let children = [node.first_index, node.first_index + 1];
    assert_eq!(children[0] % 2, 1, "siblings come in pairs");
    let [low, high] = children.map(|child| *nodes[child as usize].aabb());
    assert_eq!(*node.aabb(), low.union(&high), "boxes are tight");
    let below = children.map(|child| check(nodes, child, leaves));
    f64::from(node.aabb().half_area()) + below[0] + below[1]
}

#[test]
fn moves_keep_all_leaves_and_make_boxes_smaller() {
    for n in [1, 2, 3, 5, 100, 3000] {
        let mut nodes = random_tree(n);
        let before = check(&nodes, 0, &mut Vec::new());
        improve(&mut nodes, 0.2);
        let mut leaves = Vec::new();
        let after = check(&nodes, 0, &mut leaves);
        leaves.sort_unstable();
        assert!(leaves.into_iter().eq(0..n), "{n} leaves");
        assert!(after <= before, "{n}: {after} and {before}");
        // In random order something is to be gained.
        assert!(n < 100 || after < before, "{n}: {after} and {before}");
    }
}

fn tree(nodes: &mut [Bvh2Node]) -> Tree<'_> {
    Tree {
        parents: parents(nodes),
        touched: vec![0; nodes.len()],
        nodes,
    }
}

/// Whether `node` is `above` or below it.
fn is_below(tree: &Tree, mut node: u32, above: u32) -> bool {
    while node != above && node != 0 {
        node = tree.parent(node);
    }
    node == above
}

/// Every move of every node is made, each in a tree of its own, and all boxes are measured.
#[test]
fn no_move_gains_more_than_the_one_that_is_found() {
    let n = 24;
    let nodes = random_tree(n);
    let before = check(&nodes, 0, &mut Vec::new());
    // A gain is a sum over the levels of areas, of three roundings each, that are no larger than `before`,
    // up to the root and down again: twelve levels at most, some of them counted twice.
    let tolerance = 12.0 * 8.0 * f64::from(f32::EPSILON) * before;
    let mut gainful = 0;
    for from in 1..nodes.len() as u32 {
        let mut copy = nodes.clone();
        let found = tree(&mut copy).find(from, &mut Vec::new());
        let mut most = 0.0f64;
        for to in 1..nodes.len() as u32 {
            let mut copy = nodes.clone();
            let mut tree = tree(&mut copy);
            let (parent, beside) = (tree.parent(from), sibling(from));
            // A node goes neither into itself nor on top of what it is in.
            if is_below(&tree, to, from) || is_below(&tree, from, to) || to == beside {
                continue;
            }
            assert_ne!(to, parent);
            tree.make(
                &Move {
                    from,
                    to,
                    gain: 0.0,
                },
                1,
            );
            let mut leaves = Vec::new();
            let gain = before - check(&copy, 0, &mut leaves);
            leaves.sort_unstable();
            assert!(leaves.into_iter().eq(0..n), "{from} to {to}");
            if to == found.to {
                let expected = f64::from(found.gain);
                assert!(
                    (gain - expected).abs() <= tolerance,
                    "{from} to {to}: {gain}, {expected}"
                );
            }
            most = most.max(gain);
        }
        let expected = f64::from(found.gain);
        assert!(
            (most - expected).abs() <= tolerance,
            "{from}: {most} and {expected}"
        );
        gainful += usize::from(found.gain > 0.0);
    }
    assert!(gainful > 5, "{gainful} moves would gain something");
}

#[test]
fn moves_are_the_same_for_any_number_of_threads() {
    let improved = |threads: usize| {
        let mut nodes = random_tree(20_000);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        pool.build().unwrap().install(|| improve(&mut nodes, 0.2));
        bytemuck::cast_slice::<_, u8>(&nodes).to_vec()
    };
    let one = improved(1);
    for threads in [2, 3] {
        assert!(improved(threads) == one, "{threads} threads");
    }
}

#[test]
fn equal_leaves_stay_where_they_are() {
    let mut nodes = random_tree(64);
    let one = Aabb::new(Vec3A::ZERO, Vec3A::ONE);
    nodes.iter_mut().for_each(|node| node.set_aabb(one));
    let before = nodes.clone();
    improve(&mut nodes, 0.2);
    assert!(bytemuck::cast_slice::<_, u8>(&nodes) == bytemuck::cast_slice::<_, u8>(&before));
}
