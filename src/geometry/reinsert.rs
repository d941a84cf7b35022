//! Reinsertion takes badly placed subtrees out of a binary tree and puts them where they cost least
//! (D. Meister, J. Bittner, "Parallel Reinsertion for Bounding Volume Hierarchy Optimization", CGF
//! 37(2), 2018).
//!
//! A pass looks for the best place of each of some nodes, all in parallel, in the tree as it stands. Then
//! nodes are moved, the one that gains most first, and those left out whose move has to do with a node
//! that an earlier one changed. Passes are over fewer and fewer nodes, always those with the largest boxes
//! among twice as many near the root: of nodes taken from anywhere in the tree the expected cost is as
//! good, but not the speed of rays (`docs/performance/trees.md`).
//!
//! Leaves move whole, and splitting has filled them: on trees with one triangle a leaf reinsertion
//! spoils the blocks.

#[cfg(test)]
mod tests_of_moves;

use obvhs::{aabb::Aabb, bvh2::node::Bvh2Node};
use rayon::prelude::*;
use std::sync::atomic::{AtomicU32, Ordering};

/// The n-th pass considers one (2n + 1)-th of the nodes of the first.
const PASSES: u8 = 16;
/// Nodes whose place one task looks for, at least, and whose parents it writes down.
const SOME: usize = 32;
const MANY: usize = 1 << 12;

/// Improves the tree `nodes`, whose root is node 0 and whose children lie side by side, the first of two
/// on an odd place. Of all nodes the first pass considers `share`. The same for any number of threads.
pub(super) fn improve(nodes: &mut [Bvh2Node], share: f32) {
    let most = (nodes.len() as f32 * share) as usize;
    if nodes[0].is_leaf() {
        return;
    }
    let front = breadth_first(nodes, 2 * most + 1);
    let mut tree = Tree {
        parents: parents(nodes),
        touched: vec![0; nodes.len()],
        nodes,
    };
    for pass in 0..PASSES {
        let candidates = largest(
            tree.nodes,
            &front,
            (most / (2 * usize::from(pass) + 1)).max(1),
        );
        let mut moves: Vec<Move> = candidates
            .par_iter()
            .with_min_len(SOME)
            .map_init(Vec::new, |stack, &node| tree.find(node, stack))
            .collect();
        moves.par_sort_unstable_by(|a, b| b.gain.total_cmp(&a.gain));
        for one in moves.iter().take_while(|one| one.gain > 0.0) {
            tree.make(one, pass + 1);
        }
    }
}

/// The other child of the same parent.
fn sibling(node: u32) -> u32 {
    ((node - 1) ^ 1) + 1
}

/// The first of two siblings.
fn first(node: u32) -> u32 {
    ((node - 1) & !1) + 1
}

/// Where the parent of `node` and its sibling is written down.
fn pair(node: u32) -> usize {
    (node as usize - 1) / 2
}

/// A node to be put beside another one, and the area that all boxes together lose by that.
#[derive(Clone, Copy)]
struct Move {
    from: u32,
    to: u32,
    gain: f32,
}

struct Tree<'a> {
    nodes: &'a mut [Bvh2Node],
    /// By pairs of siblings. (Atomic, because threads write all over the table to begin with.)
    parents: Vec<AtomicU32>,
    /// The last pass that changed a node.
    touched: Vec<u8>,
}

impl Tree<'_> {
    fn parent(&self, node: u32) -> u32 {
        self.parents[pair(node)].load(Ordering::Relaxed)
    }

    fn aabb(&self, node: u32) -> &Aabb {
        self.nodes[node as usize].aabb()
    }

    /// The best place for `from`; gains nothing where it is best where it stands.
    ///
    /// Taking it out makes its ancestors smaller, and its sibling takes the place of its parent. Putting
    /// it elsewhere makes what is above that place larger. So the search climbs to the root and, from
    /// each ancestor, down the other side, as long as a box no larger than the node's own could still gain.
    fn find(&self, from: u32, stack: &mut Vec<(f32, u32)>) -> Move {
        let moved = self.aabb(from);
        let area = moved.half_area();
        let parent = self.parent(from);
        let mut best = Move {
            from,
            to: 0,
            gain: 0.0,
        };
        // What is gained above, if it comes to stand below `side`; `rest` is the ancestor's box without it.
        let (mut above, mut side, mut ancestor) =
            (self.aabb(parent).half_area(), sibling(from), parent);
        let mut rest = *self.aabb(side);
        loop {
            stack.push((above, side));
            while let Some((above, node)) = stack.pop() {
                if above - area <= best.gain {
                    continue;
                }
                let there = &self.nodes[node as usize];
                let gain = above - there.aabb().union(moved).half_area();
                if gain > best.gain {
                    (best.to, best.gain) = (node, gain);
                }
                if !there.is_leaf() {
                    let above = gain + there.aabb().half_area();
                    if above - area > best.gain {
                        stack.extend([(above, there.first_index), (above, there.first_index + 1)]);
                    }
                }
            }
            if ancestor != parent {
                rest = rest.union(self.aabb(side));
                above += self.aabb(ancestor).half_area() - rest.half_area();
            }
            if ancestor == 0 {
                break;
            }
            side = sibling(ancestor);
            ancestor = self.parent(ancestor);
        }
        if best.to == sibling(from) || best.to == parent {
            best.gain = 0.0;
        }
        best
    }

    /// Moves a node, if nothing about it has been changed in this pass.
    fn make(&mut self, &Move { from, to, .. }: &Move, pass: u8) {
        let (parent, beside) = (self.parent(from), sibling(from));
        let changed = [to, from, beside, self.parent(to), parent].map(|node| node as usize);
        if changed.iter().any(|&node| self.touched[node] == pass) {
            return;
        }
        for node in changed {
            self.touched[node] = pass;
        }
        // The sibling takes the parent's place, and its old one is for what stood at `to`.
        let (kept, there) = (self.nodes[beside as usize], self.nodes[to as usize]);
        self.put(parent, kept);
        self.put(beside, there);
        let root = Bvh2Node::new(*there.aabb(), 0, first(from));
        self.put(to, root);
        self.fit(to);
        if parent != 0 {
            self.fit(self.parent(parent));
        }
    }

    fn put(&mut self, at: u32, node: Bvh2Node) {
        self.nodes[at as usize] = node;
        if !node.is_leaf() {
            *self.parents[pair(node.first_index)].get_mut() = at;
        }
    }

    /// Fits the box of an inner node, and those above it, as far as they change.
    fn fit(&mut self, mut node: u32) {
        loop {
            let first = self.nodes[node as usize].first_index;
            let fitted = self.aabb(first).union(self.aabb(first + 1));
            if *self.aabb(node) == fitted {
                return;
            }
            self.nodes[node as usize].set_aabb(fitted);
            if node == 0 {
                return;
            }
            node = self.parent(node);
        }
    }
}

fn parents(nodes: &[Bvh2Node]) -> Vec<AtomicU32> {
    let pairs = (0..nodes.len() / 2).into_par_iter().with_min_len(MANY);
    let parents: Vec<AtomicU32> = pairs.map(|_| AtomicU32::new(0)).collect();
    let all = nodes.par_iter().enumerate().with_min_len(MANY);
    all.filter(|(_, node)| !node.is_leaf())
        .for_each(|(i, node)| {
            parents[pair(node.first_index)].store(i as u32, Ordering::Relaxed);
        });
    parents
}

/// The first nodes below the root, level by level, `most` of them if there are so many.
fn breadth_first(nodes: &[Bvh2Node], most: usize) -> Vec<u32> {
    let mut front = Vec::with_capacity(most + 2);
    let children = |node: u32| {
        let node = &nodes[node as usize];
        (!node.is_leaf()).then(|| [node.first_index, node.first_index + 1])
    };
    front.extend(children(0).into_iter().flatten());
    let mut next = 0;
    while next < front.len() && front.len() < most {
        front.extend(children(front[next]).into_iter().flatten());
        next += 1;
    }
    front
}

/// Of twice as many nodes at the front of a list the `most` that have the largest boxes, by falling
/// area.
fn largest(nodes: &[Bvh2Node], front: &[u32], most: usize) -> Vec<u32> {
    // Areas are not negative, so their bits are in their order.
    let key = |(i, &node): (usize, &u32)| {
        let area = nodes[node as usize].aabb().half_area();
        u64::from(!area.to_bits()) << 32 | i as u64
    };
    let front = &front[..front.len().min(2 * most + 1)];
    let all = front.par_iter().enumerate().with_min_len(MANY);
    let mut keys: Vec<u64> = all.map(key).collect();
    if most < keys.len() {
        keys.select_nth_unstable(most);
        keys.truncate(most);
    }
    keys.par_sort_unstable();
    let node = |key: u64| front[key as u32 as usize];
    keys.into_iter().map(node).collect()
}
