//! Subtrees as they are built, by many tasks, and the tree that they make.

use super::bounds::Bounds;
use super::reference::Reference;
use crate::geometry::build::Binary;
use crate::pages::Table;
use obvhs::bvh2::node::Bvh2Node;

/// A subtree that one task builds. Its root is node 0; leaves refer to `triangles`.
pub(super) struct Run {
    pub(super) nodes: Vec<Bvh2Node>,
    pub(super) triangles: Vec<u32>,
}

impl Run {
    /// Makes node `at` an inner one and returns where its children are to come.
    pub(super) fn fork(&mut self, at: usize, bounds: Bounds) -> usize {
        let first = self.nodes.len();
        self.nodes[at] = Bvh2Node::new(bounds.to_aabb(), 0, first as u32);
        self.nodes.extend([Bvh2Node::default(); 2]);
        first
    }
}

/// A subtree that is built.
pub(super) enum Grown {
    /// Built by one task.
    Run(Run),
    /// Two halves that were built in parallel.
    Fork(Bounds, Box<[Grown; 2]>),
}

impl Grown {
    /// A subtree of `count` references, and room for so many, that `write` writes to node 0 and below.
    pub(super) fn run(count: usize, room: usize, write: impl FnOnce(&mut Run)) -> Self {
        let mut run = Run {
            nodes: Vec::with_capacity(count),
            triangles: Vec::with_capacity(room),
        };
        run.nodes.push(Bvh2Node::default());
        write(&mut run);
        Self::Run(run)
    }

    /// The whole tree, over so many triangles, its nodes in the place of references that are done with.
    pub(super) fn into_tree(self, kept: usize, done: Table<Reference>) -> Binary {
        let (nodes, triangles) = self.len();
        let mut tree = Binary {
            nodes: Table::in_place_of(done, nodes),
            triangles: Table::zeroed(triangles),
            repeats: triangles > kept,
        };
        let (root, below) = tree.nodes.split_at_mut(1);
        root[0] = self.write([1, 0], below, &mut tree.triangles);
        tree
    }

    /// Nodes and references.
    fn len(&self) -> (usize, usize) {
        match self {
            Self::Run(run) => (run.nodes.len(), run.triangles.len()),
            Self::Fork(_, halves) => {
                let [low, high] = halves.each_ref().map(Self::len);
                (1 + low.0 + high.0, low.1 + high.1)
            }
        }
    }

    /// Writes the tree but for its root, which it returns, and the references. `first` says which
    /// node and which reference of the whole tree `nodes` and `triangles` begin with.
    fn write(self, first: [usize; 2], nodes: &mut [Bvh2Node], triangles: &mut [u32]) -> Bvh2Node {
        match self {
            Self::Run(run) => {
                let moved = |mut node: Bvh2Node| {
                    // The run's second node comes first, and is there.
                    node.first_index += if node.is_leaf() {
                        first[1] as u32
                    } else {
                        first[0] as u32 - 1
                    };
                    node
                };
                triangles.copy_from_slice(&run.triangles);
                for (to, &node) in nodes.iter_mut().zip(&run.nodes[1..]) {
                    *to = moved(node);
                }
                moved(run.nodes[0])
            }
            Self::Fork(bounds, halves) => {
                let [low, high] = *halves;
                let (pair, rest) = nodes.split_at_mut(2);
                let len = low.len();
                let below = first[0] + 2;
                let nodes = rest.split_at_mut(len.0 - 1);
                let triangles = triangles.split_at_mut(len.1);
                let at = [below + len.0 - 1, first[1] + len.1];
                let (low, high) = rayon::join(
                    || low.write([below, first[1]], nodes.0, triangles.0),
                    || high.write(at, nodes.1, triangles.1),
                );
                pair.copy_from_slice(&[low, high]);
                Bvh2Node::new(bounds.to_aabb(), 0, first[0] as u32)
            }
        }
    }
}
