//! Rays through a world of two levels: a tree whose leaves are spheres, copies of objects and
//! triangles of the world that a filter is asked about, and below it a tree an object.
//!
//! Triangles of the world that are wholly there are none of its business: they go through `flight.rs`,
//! `packet.rs` or `few.rs`, as in worlds of nothing else, and before. What they answer is where a ray ends
//! here. So what is hidden from all rays costs a box test, eight rays at a time (`near.rs`), and
//! only rays that may meet something else walk.
//!
//! As in `flight.rs`, `N` rays are under way together, each in a queue for what it wants next: a
//! node, a block of triangles, a block of spheres, or a *door*, behind which another tree begins. At a
//! door the ray is taken into the object's space (`instance.rs`) and goes on from the root there with a
//! stack of its own; when that is empty it is put back and goes on in the world (`walk.rs`; for processors
//! with AVX-512 `avx512/levels.rs`, with the same answers). So rays in objects and rays between them are
//! in flight together.
//!
//! **Opacity.** A [`Filter`] is asked about a triangle's hit before it counts; one that it rejects is as
//! if it were not there, and the walk goes on from where it is. [`Everything`] is compiled away.
//!
//! Input and output: as `traverse.rs`; numbers of hits are global, see [`World`]. Of equally near
//! hits the one with the smallest number is taken.

mod ask;
mod near;
mod spheres;
mod walk;

pub(crate) use ask::Ask;
pub use near::{nearer, nearer_without_avx512, obstructed, obstructed_without_avx512};
pub(crate) use spheres::roll;
pub(crate) use walk::fly;

use crate::bvh::{Bvh, LEAF, MAX_DEPTH, NOTHING, Node, index};
use crate::instance::Instance;
use crate::motion::{Motion, STILL};
use crate::sphere::SphereBlock;

/// The tables of a world of two levels.
///
/// Hits are numbered: first the world's own triangles, then the spheres, then the triangles of each
/// instance in a row.
#[derive(Clone, Copy, Debug)]
pub struct World<'a> {
    /// All trees, one after the other. In the tree over the world a leaf refers to a [`DOOR`]: spheres,
    /// then instances, then triangles of the world as a whole, by their places in this order; in the
    /// others to one of less than 2^30 blocks.
    pub bvh: Bvh<'a>,
    /// Root of the tree over the world, or [`NOTHING`].
    pub root: u32,
    /// Root of a tree over triangles of the world; unspecified if nothing refers to it.
    pub own_root: u32,
    /// Most nodes on a way from the root through an object.
    pub depth: usize,
    /// Spheres.
    pub spheres: &'a [SphereBlock],
    /// Instances, at time 0.
    pub instances: &'a [Instance],
    /// How some of them move.
    pub motions: &'a [Motion],
}

impl<'a> World<'a> {
    /// A world of nothing but its own triangles, with their tree's root as node 0.
    #[must_use]
    pub fn of_triangles(bvh: Bvh<'a>) -> Self {
        let root = if bvh.nodes.is_empty() {
            NOTHING
        } else {
            Self::own_leaf(0, 0)
        };
        Self {
            bvh,
            root,
            own_root: 0,
            depth: MAX_DEPTH,
            spheres: &[],
            instances: &[],
            motions: &[],
        }
    }

    /// The reference by which the tree over the world means block `i` of spheres.
    #[must_use]
    pub fn sphere_leaf(i: usize) -> u32 {
        LEAF | DOOR | i as u32
    }

    /// The reference that means instance `i`, where there are so many blocks of spheres.
    #[must_use]
    pub fn instance_leaf(spheres: usize, i: usize) -> u32 {
        LEAF | DOOR | (spheres + i) as u32
    }

    /// The reference that means the world's own triangles.
    #[must_use]
    pub fn own_leaf(spheres: usize, instances: usize) -> u32 {
        LEAF | DOOR | (spheres + instances) as u32
    }
}

impl World<'_> {
    /// The instance behind a door, which is none of spheres, where it is for ray `id`; none if the world's
    /// own triangles lie there.
    #[inline(always)]
    pub(crate) fn behind<const MOVES: bool>(
        &self,
        door: u32,
        id: usize,
        times: &[f32],
    ) -> Option<Instance> {
        let instance = self.instances.get(place(door) - self.spheres.len())?;
        if !MOVES || instance.motion == STILL {
            return Some(*instance);
        }
        Some(self.motions[instance.motion as usize].placed(instance, times[id]))
    }

    /// The reference to the node whose children hold all there is, or [`NOTHING`].
    pub(crate) fn first_reference(&self) -> u32 {
        match self.root {
            NOTHING => NOTHING,
            // Where there is but one door it leads to triangles of the world.
            door if door & LEAF != 0 => self.own_root,
            root => root,
        }
    }

    /// That node; none if there is nothing.
    pub(crate) fn first_node(&self) -> Option<&Node> {
        let root = self.first_reference();
        (root != NOTHING).then(|| &self.bvh.nodes[index(root)])
    }
}

/// The bit of a leaf's reference in the tree over the world that says that it refers to no block.
pub const DOOR: u32 = 1 << 30;

/// What a [`DOOR`] refers to.
#[inline(always)]
pub(crate) fn place(door: u32) -> usize {
    (door & !(LEAF | DOOR)) as usize
}

/// Says which hits count.
pub trait Filter {
    /// Whether there is anything to ask.
    const ASKS: bool;
    /// Whether the hit of ray `ray` of the view with triangle `primitive`, at the barycentric weights
    /// `u` and `v` of its second and third corner, counts. The answer must be a function of the
    /// arguments.
    fn accepts(&self, ray: usize, primitive: u32, u: f32, v: f32) -> bool;
}

/// Every hit counts.
#[derive(Clone, Copy, Debug)]
pub struct Everything;

impl Filter for Everything {
    const ASKS: bool = false;
    #[inline(always)]
    fn accepts(&self, _: usize, _: u32, _: f32, _: f32) -> bool {
        true
    }
}
