//! Rays through a world of two levels: a tree whose leaves are spheres, copies of objects and the
//! world's own triangles, and below it a tree an object.
//!
//! As in `flight.rs`, `N` rays are under way together, each in a queue for what it wants next: a
//! node, a block of triangles, a block of spheres, or a *door*, behind which another tree begins. At a
//! door the ray is taken into the object's space (`instance.rs`) and goes on from the root there with a
//! stack of its own; when that is empty it is put back and goes on in the world. So rays in objects
//! and rays between them are in flight together.
//!
//! This is a kernel of its own: worlds of nothing but triangles go through `flight.rs`, `packet.rs`
//! and `few.rs` and pay nothing for what is here.
//!
//! **Opacity.** A [`Filter`] is asked about a triangle's hit before it counts; one that it rejects is as
//! if it were not there, and the walk goes on from where it is. [`Everything`] is compiled away.
//!
//! Input and output: as `traverse.rs`; numbers of hits are global, see [`World`]. Of equally near
//! hits the one with the smallest number is taken.

mod spheres;

use crate::bvh::{Block, Bvh, LEAF, NOTHING, Node, index};
use crate::flight::{Queue, prefetch};
use crate::instance::Instance;
use crate::motion::{Motion, STILL};
use crate::order::Stack;
use crate::query::{ClosestHit, Occlusion, Prepared, Query};
use crate::rays::{Hits, Rays, Segments};
use crate::slabs::PAD;
use crate::sphere::SphereBlock;
use crate::triangle::normalize_exponent;
use wide::{f32x4, u32x4};

/// The tables of a world of two levels.
///
/// Hits are numbered: first the world's own triangles, then the spheres, then the triangles of each
/// instance in a row.
#[derive(Clone, Copy, Debug)]
pub struct World<'a> {
    /// All trees, one after the other. In the tree over the world a leaf refers to spheres, then
    /// instances, then the world's own triangles as a whole, by their places in this order; in the
    /// others to a block.
    pub bvh: Bvh<'a>,
    /// Root of the tree over the world, or [`NOTHING`].
    pub root: u32,
    /// Root of the tree over the world's own triangles; unspecified if nothing refers to it.
    pub own_root: u32,
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
            spheres: &[],
            instances: &[],
            motions: &[],
        }
    }

    /// The reference by which the tree over the world means block `i` of spheres.
    #[must_use]
    pub fn sphere_leaf(i: usize) -> u32 {
        LEAF | i as u32
    }

    /// The reference that means instance `i`, where there are so many blocks of spheres.
    #[must_use]
    pub fn instance_leaf(spheres: usize, i: usize) -> u32 {
        LEAF | (spheres + i) as u32
    }

    /// The reference that means the world's own triangles.
    #[must_use]
    pub fn own_leaf(spheres: usize, instances: usize) -> u32 {
        LEAF | (spheres + instances) as u32
    }
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

/// Writes the closest hit of each ray.
///
/// # Panics
/// If a column is shorter than `rays.len`.
pub fn closest<const N: usize>(world: &World, filter: &impl Filter, rays: Rays, hits: Hits) {
    fly::<_, _, N, false>(world, filter, &[], &mut ClosestHit { rays, hits });
}

/// Writes 1 for each segment that something lies on, else 0.
///
/// # Panics
/// If a column is shorter than `segments.len`.
pub fn occluded<const N: usize>(
    world: &World,
    filter: &impl Filter,
    segments: Segments,
    occluded: &mut [u32],
) {
    fly::<_, _, N, false>(world, filter, &[], &mut Occlusion { segments, occluded });
}

/// [`closest`] where instances move: ray `i` lives at `times[i]`.
///
/// # Panics
/// If a column is shorter than `rays.len`.
pub fn closest_at<const N: usize>(
    world: &World,
    filter: &impl Filter,
    times: &[f32],
    rays: Rays,
    hits: Hits,
) {
    fly::<_, _, N, true>(world, filter, times, &mut ClosestHit { rays, hits });
}

/// [`occluded`] where instances move: segment `i` lives at `times[i]`.
///
/// # Panics
/// If a column is shorter than `segments.len`.
pub fn occluded_at<const N: usize>(
    world: &World,
    filter: &impl Filter,
    times: &[f32],
    segments: Segments,
    occluded: &mut [u32],
) {
    fly::<_, _, N, true>(world, filter, times, &mut Occlusion { segments, occluded });
}

/// What a query does with one hit at a time.
trait Ask: Query {
    /// Ray `i` of the view.
    fn ray(&self, i: usize) -> [[f32; 3]; 2];
    /// What a hit must not lie beyond.
    fn reach(state: &Self::State) -> f32;
    /// The triangle that must not be hit, or the sphere that is left.
    fn leaves(state: &Self::State) -> u32;
    /// Whether hits of `primitive` do not count, left or not.
    fn spares(state: &Self::State, primitive: u32) -> bool;
    /// Whether a hit at `t` would change the answer.
    fn wants(state: &Self::State, primitive: u32, t: f32) -> bool;
    /// Takes it.
    fn take(state: &mut Self::State, primitive: u32, t: f32, uv: impl FnOnce() -> [f32; 2]);
}

impl Ask for ClosestHit<'_, '_> {
    #[inline(always)]
    fn ray(&self, i: usize) -> [[f32; 3]; 2] {
        [self.rays.origin, self.rays.direction].map(|columns| columns.map(|c| c[i]))
    }

    #[inline(always)]
    fn reach(state: &Self::State) -> f32 {
        state.t
    }

    #[inline(always)]
    fn leaves(state: &Self::State) -> u32 {
        state.leaves
    }

    #[inline(always)]
    fn spares(_: &Self::State, _: u32) -> bool {
        false
    }

    #[inline(always)]
    fn wants(state: &Self::State, primitive: u32, t: f32) -> bool {
        t < state.t || (t == state.t && primitive < state.primitive)
    }

    #[inline(always)]
    fn take(state: &mut Self::State, primitive: u32, t: f32, uv: impl FnOnce() -> [f32; 2]) {
        [state.u, state.v] = uv();
        state.primitive = primitive;
        state.t = t;
        state.limit = t * (1.0 + PAD);
    }
}

impl Ask for Occlusion<'_, '_> {
    #[inline(always)]
    fn ray(&self, i: usize) -> [[f32; 3]; 2] {
        [self.segments.origin, self.segments.direction].map(|columns| columns.map(|c| c[i]))
    }

    #[inline(always)]
    fn reach(state: &Self::State) -> f32 {
        state.t_max
    }

    #[inline(always)]
    fn leaves(state: &Self::State) -> u32 {
        state.excluded[0]
    }

    #[inline(always)]
    fn spares(state: &Self::State, primitive: u32) -> bool {
        primitive == state.excluded[1]
    }

    #[inline(always)]
    fn wants(state: &Self::State, _: u32, t: f32) -> bool {
        t < state.t_max
    }

    #[inline(always)]
    fn take(state: &mut Self::State, _: u32, _: f32, _: impl FnOnce() -> [f32; 2]) {
        state.occluded = 1;
    }
}

/// A ray under way.
#[derive(Default)]
#[repr(align(64))]
struct Slot<S> {
    /// As the tree where it is sees it.
    ray: Prepared,
    /// As the world sees it.
    home: Prepared,
    origin: [f32; 3],
    direction: [f32; 3],
    state: S,
    /// What the first triangle of the tree where it is is called.
    first: u32,
    /// Its place in the view.
    id: usize,
    /// What it visits in its next turn.
    next: u32,
    /// 0 in the tree over the world, 1 behind a door.
    level: usize,
    stacks: [Stack; 2],
}

/// The kinds of turns.
const NODES: usize = 0;
const BLOCKS: usize = 1;
const SPHERES: usize = 2;
const DOORS: usize = 3;
const DONE: usize = 4;

/// `MOVES` where instances may move; else there are no `times`.
fn fly<Q: Ask, F: Filter, const N: usize, const MOVES: bool>(
    world: &World,
    filter: &F,
    times: &[f32],
    query: &mut Q,
) {
    const { assert!(N.is_power_of_two() && N <= 256) };
    let mut slots: [Slot<Q::State>; N] = std::array::from_fn(|_| Slot::default());
    let mut queues = [const { Queue::<N>::new() }; 5];
    let mut source = 0;
    for id in 0..N {
        if refill(query, &mut source, world.root, &mut slots[id]) {
            let kind = kind(world, &slots[id]);
            queues[kind].offer(id, true);
        }
    }
    loop {
        for i in 0..std::mem::take(&mut queues[DONE].len) {
            let id = queues[DONE].get(i);
            let slot = &mut slots[id];
            query.finish(slot.id, &slot.home, &slot.state);
            if refill(query, &mut source, world.root, slot) {
                let kind = kind(world, slot);
                queues[kind].offer(id, true);
            }
        }
        let turn = (NODES..DONE)
            .max_by_key(|&kind| queues[kind].len)
            .unwrap_or(NODES);
        let len = std::mem::take(&mut queues[turn].len);
        for i in 0..len {
            let slot = &mut slots[queues[turn].get(i)];
            match turn {
                NODES => {
                    let node = &world.bvh.nodes[index(slot.next)];
                    let (hits, enter) = slot.ray.slabs.test(node, Q::limit(&slot.state));
                    slot.stacks[slot.level].push::<Q>(node, hits, enter);
                }
                BLOCKS => visit::<Q, F>(slot, &world.bvh.blocks[index(slot.next)], filter),
                SPHERES => spheres::roll::<Q, F>(slot, &world.spheres[index(slot.next)], filter),
                _ => enter::<_, MOVES>(world, slot, times),
            }
        }
        // A queue is written behind where it is read.
        for i in 0..len {
            let id = queues[turn].get(i);
            let slot = &mut slots[id];
            if turn != DOORS {
                slot.next = next::<Q>(slot);
            }
            fetch(world, slot);
            let kind = kind(world, slot);
            queues[kind].offer(id, true);
        }
        if queues.iter().all(|queue| queue.len == 0) {
            break;
        }
    }
}

/// Puts the next ray that can meet anything into `slot`; false if there is none.
#[inline(always)]
fn refill<Q: Ask>(query: &mut Q, source: &mut usize, root: u32, slot: &mut Slot<Q::State>) -> bool {
    while *source < query.len() {
        let id = *source;
        *source += 1;
        let Some((ray, state)) = query.start(id) else {
            continue;
        };
        let [origin, direction] = query.ray(id);
        let Some((direction, _)) = normalize_exponent(direction) else {
            continue;
        };
        (slot.ray, slot.home) = (ray, ray);
        (slot.origin, slot.direction) = (origin, direction);
        slot.state = state;
        slot.id = id;
        slot.next = root;
        slot.level = 0;
        slot.stacks.iter_mut().for_each(Stack::clear);
        return true;
    }
    false
}

/// Where a ray goes after a turn that led to no door: back into the world where the tree behind one
/// is done.
#[inline(always)]
fn next<Q: Ask>(slot: &mut Slot<Q::State>) -> u32 {
    if Q::settled(&slot.state) {
        return NOTHING;
    }
    let limit = Q::limit(&slot.state);
    let next = slot.stacks[slot.level].pop::<Q>(limit);
    if next != NOTHING || slot.level == 0 {
        return next;
    }
    slot.level = 0;
    slot.ray = slot.home;
    slot.stacks[0].pop::<Q>(limit)
}

/// What kind of turn a ray waits for.
#[inline(always)]
fn kind<S>(world: &World, slot: &Slot<S>) -> usize {
    let next = slot.next;
    if next & LEAF == 0 {
        NODES
    } else if next == NOTHING {
        DONE
    } else if slot.level == 1 {
        BLOCKS
    } else if index(next) < world.spheres.len() {
        SPHERES
    } else {
        DOORS
    }
}

/// Takes a ray through a door.
#[inline(always)]
fn enter<S, const MOVES: bool>(world: &World, slot: &mut Slot<S>, times: &[f32]) {
    slot.level = 1;
    slot.stacks[1].clear();
    let place = index(slot.next) - world.spheres.len();
    if let Some(instance) = world.instances.get(place) {
        let moved;
        let instance = match MOVES && instance.motion != STILL {
            false => instance,
            true => {
                let motion = &world.motions[instance.motion as usize];
                moved = motion.placed(instance, times[slot.id]);
                &moved
            }
        };
        let origin = instance.point_in(slot.origin);
        let direction = instance.direction_in(slot.direction);
        slot.ray = slot.home.seen_as(origin, direction);
        slot.first = instance.first;
        slot.next = instance.root;
    } else {
        slot.first = 0;
        slot.next = world.own_root;
    }
}

/// Tests a block of triangles.
#[inline(always)]
fn visit<Q: Ask, F: Filter>(slot: &mut Slot<Q::State>, block: &Block, filter: &F) {
    let named = block.primitive + u32x4::splat(slot.first);
    let own: f32x4 = bytemuck::cast(named.simd_eq(u32x4::splat(Q::leaves(&slot.state))));
    let found = slot.ray.shear.test_but(block, own);
    let near: f32x4 = found.t.simd_le(f32x4::splat(Q::reach(&slot.state)));
    let mut lanes = (found.met & near).to_bitmask();
    while lanes != 0 {
        let lane = lanes.trailing_zeros() as usize & 3;
        lanes &= lanes - 1;
        let at = |v: &f32x4| v.as_array()[lane];
        let primitive = slot.first + block.primitive.as_array()[lane];
        let (t, u, v) = (at(&found.t), at(&found.u), at(&found.v));
        let counts = Q::wants(&slot.state, primitive, t)
            && primitive != Q::leaves(&slot.state)
            && !Q::spares(&slot.state, primitive);
        if counts && (!F::ASKS || filter.accepts(slot.id, primitive, u, v)) {
            Q::take(&mut slot.state, primitive, t, || [u, v]);
        }
    }
}

/// Asks for the cache lines that a ray's next turn will read.
#[inline(always)]
fn fetch<S>(world: &World, slot: &Slot<S>) {
    let i = if slot.next == NOTHING {
        0
    } else {
        index(slot.next)
    };
    let blocks = world.spheres.len();
    let (base, bytes) = match kind(world, slot) {
        BLOCKS => (
            world.bvh.blocks.as_ptr().wrapping_add(i).cast::<u8>(),
            size_of::<Block>(),
        ),
        SPHERES => (
            world.spheres.as_ptr().wrapping_add(i).cast(),
            size_of::<SphereBlock>(),
        ),
        DOORS => {
            let door = world.instances.as_ptr();
            (door.wrapping_add(i - blocks).cast(), size_of::<Instance>())
        }
        _ => (
            world.bvh.nodes.as_ptr().wrapping_add(i).cast(),
            size_of::<Node>(),
        ),
    };
    for offset in (0..bytes).step_by(64) {
        prefetch(base.wrapping_add(offset));
    }
}
