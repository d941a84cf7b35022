//! The tree that the traversal kernels walk: nodes of eight boxes, leaves of blocks of four
//! triangles, in two flat tables.
//!
//! A node is 256 bytes, four cache lines: six planes of eight boxes and eight references. A block
//! is 160 bytes and holds whole vertices, which the watertight test needs (an edge that two
//! triangles share must be computed from the same numbers in both). A reference is a `u32`: an
//! inner node by its index, or, with [`LEAF`] set, a block. A leaf is one block: how much work a
//! step is does not depend on data, and a branch that would is not there to be mispredicted.

use bytemuck::{Pod, Zeroable};
use wide::{f32x4, f32x8, u32x4, u32x8};

/// Children of a node. The tree's own width: it happens to be the lanes of a vector, and does not
/// change with them.
pub const WIDTH: usize = 8;
/// Triangles in a block.
pub const BLOCK: usize = 4;
/// The bit of a reference that says leaf.
pub const LEAF: u32 = 1 << 31;
/// What an unused slot of a node refers to (its box is inside out, so nothing ever enters it), and
/// what a ray with nothing left to visit visits next.
pub const NOTHING: u32 = u32::MAX;
/// Most blocks that a tree can refer to.
pub const MAX_BLOCKS: usize = (LEAF - 1) as usize;
/// Most nodes on a path from the root to a leaf, whatever the scene. Builders promise it.
pub const MAX_DEPTH: usize = 32;

/// Eight boxes and what they hold.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C, align(64))]
pub struct Node {
    /// Planes `min x, max x, min y, max y, min z, max z`, one box a lane. An unused slot has
    /// `min = inf`, `max = -inf`.
    pub planes: [f32x8; 6],
    /// References, one a lane.
    pub child: u32x8,
    /// Fills the fourth cache line.
    pub spare: u32x8,
}

impl Node {
    /// A node that holds nothing.
    pub const EMPTY: Self = Self {
        planes: [
            f32x8::new([f32::INFINITY; WIDTH]),
            f32x8::new([f32::NEG_INFINITY; WIDTH]),
            f32x8::new([f32::INFINITY; WIDTH]),
            f32x8::new([f32::NEG_INFINITY; WIDTH]),
            f32x8::new([f32::INFINITY; WIDTH]),
            f32x8::new([f32::NEG_INFINITY; WIDTH]),
        ],
        child: u32x8::new([NOTHING; WIDTH]),
        spare: u32x8::new([0; WIDTH]),
    };

    /// The largest coordinate of its boxes that is finite, without its sign.
    #[must_use]
    pub fn extent(&self) -> f32 {
        // Unused slots have infinite planes.
        let planes = self.planes.iter();
        let sizes = planes.flat_map(|row| row.to_array()).map(f32::abs);
        sizes.filter(|size| size.is_finite()).fold(0.0, f32::max)
    }

    /// Fills slot `slot` with the box `min ..= max` and a reference.
    pub fn set(&mut self, slot: usize, min: [f32; 3], max: [f32; 3], child: u32) {
        for axis in 0..3 {
            self.planes[2 * axis].as_mut_array()[slot] = min[axis];
            self.planes[2 * axis + 1].as_mut_array()[slot] = max[axis];
        }
        self.child.as_mut_array()[slot] = child;
    }
}

/// Four triangles by rising index, so that of equally near ones the first is the one to take.
/// Unused lanes repeat the last used one, which changes no answer; a degenerate filler would send
/// every ray that comes by through the slow path of the triangle test.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C, align(32))]
pub struct Block {
    /// `vertex[axis][corner]`, one triangle a lane.
    pub vertex: [[f32x4; 3]; 3],
    /// Indices of the triangles in the mesh.
    pub primitive: u32x4,
}

impl Block {
    /// A block of one to [`BLOCK`] triangles: `(index in the mesh, corners)`.
    ///
    /// # Panics
    /// On none or too many.
    #[must_use]
    pub fn new(triangles: &[(u32, [[f32; 3]; 3])]) -> Self {
        let used = triangles.len();
        let mut rows = [triangles[0]; BLOCK];
        rows[..used].copy_from_slice(triangles);
        // Few and often in order already: by insertion.
        for i in 1..used {
            for j in (1..=i).rev() {
                if rows[j].0 < rows[j - 1].0 {
                    rows.swap(j, j - 1);
                }
            }
        }
        let lane = |lane: usize| rows[lane.min(used - 1)];
        let column = |corner: usize, axis: usize| {
            f32x4::new(std::array::from_fn(|l| lane(l).1[corner][axis]))
        };
        Self {
            vertex: std::array::from_fn(|a| std::array::from_fn(|c| column(c, a))),
            primitive: u32x4::new(std::array::from_fn(|l| lane(l).0)),
        }
    }
}

/// The reference to block `index`.
///
/// # Panics
/// If `index` is not below [`MAX_BLOCKS`].
#[must_use]
pub fn leaf(index: usize) -> u32 {
    assert!(index < MAX_BLOCKS, "at most {MAX_BLOCKS} blocks");
    LEAF | index as u32
}

/// The index of the block or node that a reference means.
#[inline(always)]
#[must_use]
pub fn index(reference: u32) -> usize {
    (reference & !LEAF) as usize
}

/// A tree as the kernels see it. Node 0 is the root; no nodes, no geometry.
#[derive(Clone, Copy, Debug)]
pub struct Bvh<'a> {
    /// Inner nodes.
    pub nodes: &'a [Node],
    /// Triangles.
    pub blocks: &'a [Block],
}
