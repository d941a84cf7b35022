//! The tree over a world of two levels: its leaves are blocks of spheres, and doors to other trees.
//!
//! Clustered (`ploc.rs`), then collapsed from the root down: of a wide node's children the one with
//! the largest area is opened until there are eight. A subtree of a block's worth of spheres is a leaf.

use super::ploc;
use huygens_kernels::bvh::{MAX_DEPTH, Node, WIDTH};
use huygens_kernels::sphere::BLOCK;
use obvhs::{aabb::Aabb, bvh2::node::Bvh2Node};

/// From this depth on what is left is cut into eight equal runs: at most 11 levels more, since
/// 8^11 is more than can be numbered.
const BALANCE_FROM: usize = MAX_DEPTH - 12;

/// What the tree is over.
pub(super) struct Item {
    pub(super) aabb: Aabb,
    /// Whether up to [`BLOCK`] of them make a leaf.
    pub(super) is_sphere: bool,
}

/// A tree under construction.
pub(super) struct Top<'a, L> {
    items: &'a [Item],
    binary: Vec<Bvh2Node>,
    /// Of each binary node: items below, and whether all are spheres.
    below: Vec<(u32, bool)>,
    /// Makes a leaf of items and returns its reference.
    leaf: L,
    nodes: Vec<Node>,
    depth: usize,
}

enum What {
    Tree(u32),
    Run(Vec<u32>),
}

impl<'a, L: FnMut(&[u32]) -> u32> Top<'a, L> {
    /// The nodes over `items`, of which there must be some, the root first, and the depth. `leaf` is
    /// called with one item that is no sphere, or up to [`BLOCK`] that are.
    pub(super) fn build(items: &'a [Item], leaf: L) -> (Vec<Node>, usize) {
        let boxes: Vec<Aabb> = items.iter().map(|item| item.aabb).collect();
        let binary = ploc::build(&boxes);
        let mut below = vec![(1, false); binary.len()];
        // Children come after their parents.
        for i in (0..binary.len()).rev() {
            let first = binary[i].first_index as usize;
            below[i] = if binary[i].is_leaf() {
                (1, items[first].is_sphere)
            } else {
                let (a, b) = (below[first], below[first + 1]);
                (a.0 + b.0, a.1 && b.1)
            };
        }
        let mut top = Top {
            items,
            binary,
            below,
            leaf,
            nodes: vec![Node::EMPTY],
            depth: 0,
        };
        let mut pending = vec![(0, 1, What::Tree(0))];
        while let Some((index, depth, what)) = pending.pop() {
            top.depth = top.depth.max(depth);
            for (slot, what) in top.children(what, depth).into_iter().enumerate() {
                let aabb = top.aabb(&what);
                let reference = match top.as_leaf(&what) {
                    Some(items) => (top.leaf)(&items),
                    None => {
                        let index = top.nodes.len() as u32;
                        top.nodes.push(Node::EMPTY);
                        pending.push((index, depth + 1, what));
                        index
                    }
                };
                let (min, max) = (aabb.min.to_array(), aabb.max.to_array());
                top.nodes[index as usize].set(slot, min, max, reference);
            }
        }
        assert!(top.depth <= MAX_DEPTH, "the depth of a tree is bounded");
        (top.nodes, top.depth)
    }

    fn aabb(&self, what: &What) -> Aabb {
        match what {
            What::Tree(node) => *self.binary[*node as usize].aabb(),
            What::Run(run) => run.iter().fold(Aabb::INVALID, |aabb, &i| {
                aabb.union(&self.items[i as usize].aabb)
            }),
        }
    }

    fn is_leaf(&self, node: u32) -> bool {
        let (items, spheres) = self.below[node as usize];
        items == 1 || (spheres && items as usize <= BLOCK)
    }

    /// The items of what is a leaf.
    fn as_leaf(&self, what: &What) -> Option<Vec<u32>> {
        match what {
            What::Tree(node) => self.is_leaf(*node).then(|| self.run(*node)),
            What::Run(run) => {
                let spheres = run.iter().all(|&i| self.items[i as usize].is_sphere);
                let is_leaf = run.len() == 1 || (spheres && run.len() <= BLOCK);
                is_leaf.then(|| run.clone())
            }
        }
    }

    /// One to eight.
    fn children(&self, what: What, depth: usize) -> Vec<What> {
        let node = match what {
            What::Tree(node) if depth < BALANCE_FROM => node,
            What::Tree(node) => return evenly(&self.run(node)),
            What::Run(run) => return evenly(&run),
        };
        let mut open = vec![node];
        while open.len() < WIDTH {
            let area = |node: u32| self.binary[node as usize].aabb().half_area();
            let largest = (0..open.len())
                .filter(|&i| !self.is_leaf(open[i]))
                .max_by(|&i, &j| area(open[i]).total_cmp(&area(open[j])));
            let Some(i) = largest else {
                break;
            };
            let first = self.binary[open[i] as usize].first_index;
            open.splice(i..=i, [first, first + 1]);
        }
        open.into_iter().map(What::Tree).collect()
    }

    /// All items below a node, left to right.
    fn run(&self, node: u32) -> Vec<u32> {
        let mut run = Vec::new();
        let mut pending = vec![node];
        while let Some(i) = pending.pop() {
            let node = &self.binary[i as usize];
            if node.is_leaf() {
                run.push(node.first_index);
            } else {
                pending.extend([node.first_index + 1, node.first_index]);
            }
        }
        run
    }
}

fn evenly(run: &[u32]) -> Vec<What> {
    run.chunks(run.len().div_ceil(WIDTH))
        .map(|run| What::Run(run.to_vec()))
        .collect()
}
