//! Writes the tables as they are planned: every part knows where its share begins, so all write at once.

use super::{Layout, Part, What};
use crate::geometry::collapse::{Collapse, NODE_COST};
use crate::pages::Table;
use crate::scene::Mesh;
use huygens_kernels::bvh::{BLOCK, Block, LEAF, MAX_DEPTH, NOTHING, Node, WIDTH, index, leaf};
use rayon::prelude::*;
use wide::{f32x4, u32x4, u32x8};

impl Part {
    /// Writes the part's blocks, and its nodes but the first, which it returns. `first_node` and
    /// `first_block` are what its own count from.
    fn write(
        &self,
        mesh: &Mesh,
        collapse: &Collapse,
        (first_node, nodes): (usize, &mut [Node]),
        (first_block, blocks): (usize, &mut [Block]),
    ) -> (Node, usize) {
        let mut root = Node::EMPTY;
        let (mut found, mut all) = (Vec::new(), 0);
        for (i, children) in self.nodes.iter().enumerate() {
            let mut boxes = [NOWHERE; WIDTH];
            let mut references = [NOTHING; WIDTH];
            for (slot, &(what, reference)) in self.children[children.clone()].iter().enumerate() {
                boxes[slot] = match what {
                    What::Tree(node) => collapse.corners(node),
                    What::Run(run) => {
                        let aabb = self.runs[run as usize].aabb;
                        [aabb.min, aabb.max].map(|p| f32x4::new([p.x, p.y, p.z, 0.0]))
                    }
                };
                references[slot] = if reference & LEAF == 0 {
                    first_node as u32 + reference
                } else {
                    let triangles = match what {
                        What::Tree(node) => collapse.run_of(node, &mut found),
                        What::Run(run) => &self.runs[run as usize].triangles,
                    };
                    all += triangles.len();
                    blocks[index(reference)] = block(mesh, triangles);
                    leaf(first_block + index(reference))
                };
            }
            let node = node(&boxes, references);
            if i == 0 {
                root = node;
            } else {
                nodes[i - 1] = node;
            }
        }
        (root, all)
    }
}

/// Lower and upper corner of a slot that is not used.
const NOWHERE: [f32x4; 2] = [
    f32x4::new([f32::INFINITY; 4]),
    f32x4::new([f32::NEG_INFINITY; 4]),
];

/// The node of eight boxes, whose corners' last lanes mean nothing.
#[inline(always)]
fn node(boxes: &[[f32x4; 2]; WIDTH], references: [u32; WIDTH]) -> Node {
    const { assert!(WIDTH == 8) };
    let columns = |four: usize, end: usize| {
        f32x4::transpose(std::array::from_fn(|i| boxes[4 * four + i][end]))
    };
    let [low, high] = [0, 1].map(|end| [columns(0, end), columns(1, end)]);
    let plane = |[a, b]: [[f32x4; 4]; 2], axis: usize| bytemuck::cast([a[axis], b[axis]]);
    Node {
        planes: [
            plane(low, 0),
            plane(high, 0),
            plane(low, 1),
            plane(high, 1),
            plane(low, 2),
            plane(high, 2),
        ],
        child: u32x8::new(references),
        spare: u32x8::ZERO,
    }
}

/// The block of a leaf.
#[inline(always)]
fn block(mesh: &Mesh, triangles: &[u32]) -> Block {
    const { assert!(BLOCK == 4) };
    // What is not used comes last, and repeats the last that is.
    let row = |i: usize| triangles.get(i).copied().unwrap_or(u32::MAX);
    let [a, b, c, d] = [0, 1, 2, 3].map(row);
    // By rising index: first in pairs, then the pairs with each other.
    let ([a, b], [c, d]) = ([a.min(b), a.max(b)], [c.min(d), c.max(d)]);
    let ([a, c], [b, d]) = ([a.min(c), a.max(c)], [b.min(d), b.max(d)]);
    let rows = [a, b.min(c), b.max(c), d];
    let last = rows[triangles.len() - 1];
    let rows = rows.map(|i| i.min(last));
    let corners = rows.map(|i| mesh.corners(i as usize));
    let column = |corner: usize| {
        let [a, b, c, d] = corners.map(|corners| {
            let [x, y, z] = corners[corner];
            f32x4::new([x, y, z, 0.0])
        });
        f32x4::transpose([a, b, c, d])
    };
    let columns = [column(0), column(1), column(2)];
    Block {
        vertex: [0, 1, 2].map(|axis| columns.map(|column| column[axis])),
        primitive: u32x4::new(rows),
    }
}

/// The whole of the top and its subtrees, each to hang at the node named with it.
pub(super) fn write(
    mesh: &Mesh,
    collapse: &Collapse,
    top: &Part,
    subtrees: &[(u32, Part)],
) -> Layout {
    let parts = || subtrees.iter().map(|(_, part)| part);
    let nodes = parts().map(|p| p.nodes.len() - 1).sum::<usize>() + top.nodes.len();
    let blocks = parts().map(|p| p.blocks).sum::<usize>() + top.blocks;
    let mut out = Layout {
        nodes: Table::zeroed(nodes),
        blocks: Table::zeroed(blocks),
        depth: parts().map(|p| p.depth).fold(top.depth, usize::max),
        triangles: 0,
        sah: f64::from(NODE_COST),
    };
    assert!(out.depth <= MAX_DEPTH, "the depth of a tree is bounded");
    let cost = parts().map(|p| p.cost).sum::<f64>() + top.cost;
    let root_area = f64::from(collapse.aabb(0).half_area());
    if root_area > 0.0 {
        out.sah += cost / root_area;
    }
    let (mut nodes, mut blocks) = (&mut out.nodes[..], &mut out.blocks[..]);
    let (mut node, mut block) = (0, 0);
    // The next so many of each, and the numbers of the first of them.
    let mut take = |some_nodes: usize, some_blocks: usize| {
        let at = (node, block);
        (node, block) = (node + some_nodes, block + some_blocks);
        let mine = nodes.split_off_mut(..some_nodes).unwrap_or_default();
        let mine = (at.0, mine);
        (
            mine,
            (
                at.1,
                blocks.split_off_mut(..some_blocks).unwrap_or_default(),
            ),
        )
    };
    let (top_nodes, top_blocks) = take(top.nodes.len(), top.blocks);
    let places: Vec<_> = parts().map(|p| take(p.nodes.len() - 1, p.blocks)).collect();
    // A part's second node is the first of its share.
    let write = |((_, part), (nodes, blocks)): (&(u32, Part), _)| {
        let (first, nodes): (usize, &mut [Node]) = nodes;
        part.write(mesh, collapse, (first - 1, nodes), blocks)
    };
    let roots: Vec<(Node, usize)> = subtrees.par_iter().zip(places).map(write).collect();
    let (first, rest) = top_nodes.1.split_at_mut(1);
    let (root, triangles) = top.write(mesh, collapse, (0, rest), top_blocks);
    first[0] = root;
    out.triangles = triangles;
    for ((at, _), (root, triangles)) in subtrees.iter().zip(roots) {
        out.nodes[*at as usize] = root;
        out.triangles += triangles;
    }
    out
}
