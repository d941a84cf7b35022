//! Many rays at once through a world of two levels: the portable form.

use super::ask::Ask;
use super::spheres::roll;
use super::{DOOR, Filter, World, place};
use crate::bvh::{BLOCK, Block, LEAF, NOTHING, index};
use crate::flight::{Queue, prefetch};
use crate::order::Stack;
use crate::query::Prepared;
use crate::triangle::normalize_exponent;
use crate::visits;
use wide::{f32x4, u32x4};

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
pub(crate) fn fly<Q: Ask, F: Filter, const N: usize, const MOVES: bool>(
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
            let kind = kind(world, slots[id].next);
            queues[kind].offer(id, true);
        }
    }
    loop {
        for i in 0..std::mem::take(&mut queues[DONE].len) {
            let id = queues[DONE].get(i);
            let slot = &mut slots[id];
            query.finish(slot.id, &slot.home, &slot.state);
            if refill(query, &mut source, world.root, slot) {
                let kind = kind(world, slot.next);
                queues[kind].offer(id, true);
            }
        }
        let turn = (NODES..DONE)
            .max_by_key(|&kind| queues[kind].len)
            .unwrap_or(NODES);
        let len = std::mem::take(&mut queues[turn].len);
        visits::add(
            len * usize::from(turn == NODES),
            BLOCK * len * usize::from(turn == BLOCKS),
        );
        for i in 0..len {
            let slot = &mut slots[queues[turn].get(i)];
            match turn {
                NODES => {
                    let node = &world.bvh.nodes[index(slot.next)];
                    let (hits, enter) = slot.ray.slabs.test(node, Q::limit(&slot.state));
                    slot.stacks[slot.level].push::<Q>(node, hits, enter);
                }
                BLOCKS => visit::<Q, F>(slot, &world.bvh.blocks[index(slot.next)], filter),
                SPHERES => {
                    let ray = (slot.id, slot.origin, slot.direction);
                    let block = &world.spheres[place(slot.next)];
                    roll::<Q, F>(ray, &mut slot.state, block, filter);
                }
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
            fetch(world, slot.next);
            let kind = kind(world, slot.next);
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
        let Some((ray, state)) = query.begin(id) else {
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

/// What kind of turn a reference asks for.
#[inline(always)]
fn kind(world: &World, next: u32) -> usize {
    if next & LEAF == 0 {
        NODES
    } else if next == NOTHING {
        DONE
    } else if next & DOOR == 0 {
        BLOCKS
    } else if place(next) < world.spheres.len() {
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
    match world.behind::<MOVES>(slot.next, slot.id, times) {
        Some(instance) => {
            let origin = instance.point_in(slot.origin);
            let direction = instance.direction_in(slot.direction);
            slot.ray = slot.home.seen_as(origin, direction);
            slot.first = instance.first;
            slot.next = instance.root;
        }
        None => {
            slot.first = 0;
            slot.next = world.own_root;
        }
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
fn fetch(world: &World, next: u32) {
    let (base, bytes) = match kind(world, next) {
        BLOCKS => address(world.bvh.blocks, index(next)),
        SPHERES => address(world.spheres, place(next)),
        DOORS => address(world.instances, place(next) - world.spheres.len()),
        DONE => return,
        _ => address(world.bvh.nodes, index(next)),
    };
    for offset in (0..bytes).step_by(64) {
        prefetch(base.wrapping_add(offset));
    }
}

/// Where an element of a table lies, and how many bytes it has.
#[inline(always)]
fn address<T>(table: &[T], i: usize) -> (*const u8, usize) {
    (table.as_ptr().wrapping_add(i).cast(), size_of::<T>())
}
