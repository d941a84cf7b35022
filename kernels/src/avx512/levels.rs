//! `levels/walk.rs` for processors with AVX-512: rays in flight as in `mod.rs`, with doors.
//!
//! A ray has one stack. At a door that leads into a copy of an object a mark is put on it, the ray is made
//! ready anew (`doors.rs`), sixteen rays at a time, and goes on from the object's root; where it comes to
//! the mark it is put back. What is behind the door is nothing else to the sweeps over nodes and
//! leaves, but for what triangles are called. Triangles of the world are behind a door too, which changes
//! nothing about a ray.
//!
//! Rays that cannot be made ready sixteen at a time, in the world or in an object, are traced one at a
//! time by the portable form.
//!
//! Input and output: as `levels.rs`.

mod doors;
mod query;

use super::leaf::{self, Found, Groups};
use super::prepare::Stage;
use super::queue::{Queues, What};
use super::simd::{four_each_u32, store16, store16_u32};
use super::slot::{DEEPEST, Slot};
use super::{N, available, choose, choose_in_order, nodes, nodes_in_order};
use crate::bvh::{BLOCK, NOTHING, index};
use crate::flight::prefetch;
use crate::levels::{Filter, World, place};
use crate::query::Prepared;
use crate::triangle::normalize_exponent;
use crate::visits;
use doors::{Home, go_through};
pub(crate) use query::Carried;
use std::arch::x86_64::*;
use std::cell::RefCell;

thread_local! {
    /// As `SLOTS` of `mod.rs`, with what the world knows of each ray.
    static FLIGHT: RefCell<([Slot; N], [Home; N])> = const {
        RefCell::new(([const { Slot::NEW }; N], [Home::NEW; N]))
    };
}

/// Whether [`fly`] can be called for this world on this processor.
pub(crate) fn can_fly(world: &World) -> bool {
    available() && world.depth <= DEEPEST
}

/// Answers a query. `MOVES` where instances may move; else there are no `times`.
///
/// # Panics
/// If a column is shorter than the query's view, or [`can_fly`] is false.
pub(crate) fn fly<'a, Q: Carried<'a>, F: Filter, const MOVES: bool>(
    world: &World,
    filter: &F,
    times: &[f32],
    query: &mut Q,
) {
    assert!(can_fly(world), "a processor with AVX-512");
    if world.first_node().is_some() {
        FLIGHT.with_borrow_mut(|(slots, homes)| {
            // SAFETY: the processor has what the function is compiled for.
            unsafe { all::<Q, F, MOVES>(slots, homes, world, filter, times, query) }
        });
    }
}

#[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
fn all<'a, Q: Carried<'a>, F: Filter, const MOVES: bool>(
    slots: &mut [Slot; N],
    homes: &mut [Home; N],
    world: &World,
    filter: &F,
    times: &[f32],
    query: &mut Q,
) {
    let bvh = world.bvh;
    let extent = world.first_node().map_or(0.0, |node| node.extent());
    // Where there is but one door it leads to triangles of the world.
    let root = world.first_reference();
    let view = query.view();
    let (mut stage, mut queues) = (Stage::of(extent, [std::ptr::null(); 3]), Queues::new());
    let (mut next, mut groups) = ([0; N], Groups::NEW);
    let fetch = |door: u32| {
        let i = place(door).wrapping_sub(world.spheres.len());
        let start = world.instances.as_ptr().wrapping_add(i).cast::<u8>();
        prefetch(start);
        prefetch(start.wrapping_add(64));
    };
    queues.done.fill_with_all();
    let mut started = false;
    loop {
        queues.for_each_done(|id, nodes| {
            let (slot, home) = (&mut slots[id as usize % N], &mut homes[id as usize % N]);
            if started && !home.is_answered {
                query.hand_in(slot);
            }
            let odd = |i: usize| query.alone::<F, MOVES>(world, filter, times, i);
            if let Some((i, ray)) = stage.next(&view, odd) {
                slot.start(i, ray);
                slot.next = root;
                query.take_up(slot);
                let direction = view.direction.map(|column| column[i]);
                *home = Home {
                    ray: slot.ray,
                    leave: slot.leave,
                    origin: view.origin.map(|column| column[i]),
                    // A ray under way has a direction.
                    direction: normalize_exponent(direction).map_or(direction, |(d, _)| d),
                    ..Home::NEW
                };
                nodes.push(id);
            }
        });
        started = true;
        let [of_nodes, of_leaves] = [queues.nodes.len(), queues.leaves.len()];
        if queues.doors.len() > of_nodes.max(of_leaves) {
            go_through::<Q, F, MOVES>(
                slots,
                homes,
                world,
                (filter, times),
                query,
                queues.doors.ids(),
                &mut next,
            );
            queues.sort_with::<true>(bvh, What::Doors, &next, fetch);
        } else if of_nodes > of_leaves {
            let ids = queues.nodes.ids();
            visits::add(ids.len(), 0);
            if Q::ORDERED {
                nodes_in_order(bvh, slots, ids, &mut next);
            } else {
                nodes(bvh, slots, ids, &mut next);
            }
            queues.sort_with::<true>(bvh, What::Nodes, &next, fetch);
        } else if of_leaves > 0 {
            let ids = queues.leaves.ids();
            visits::add(0, BLOCK * ids.len());
            groups.edges(bvh, slots, ids);
            for (g, ids) in ids.chunks(4).enumerate() {
                let exactly = |r: usize| {
                    let id = ids[r] as usize % N;
                    exactly::<MOVES>(world, times, &slots[id], &homes[id], |i| {
                        Prepared::load(view.origin, view.direction, i)
                    })
                };
                let last = ids.len() - 1;
                let first = |r: usize| homes[ids[r.min(last)] as usize % N].first;
                let first = four_each_u32([first(0), first(1), first(2), first(3)]);
                let primitive = _mm512_add_epi32(leaf::primitives(bvh, slots, ids), first);
                let mut wanted = leaf::but_left(primitive, slots, ids);
                if !Q::ORDERED {
                    wanted = leaf::but_reached(wanted, primitive, slots, ids);
                }
                let found = groups.finish(g, slots, ids, wanted, exactly);
                if F::ASKS {
                    ask::<Q, F>(slots, ids, primitive, &found, filter);
                } else if Q::ORDERED {
                    let best = leaf::nearest(primitive, &found, slots, ids);
                    for (r, &id) in ids.iter().enumerate() {
                        slots[id as usize % N].improve(best.key[r], best.uv[r]);
                    }
                } else {
                    let blocked = leaf::blocked(&found, slots, ids);
                    for (r, &id) in ids.iter().enumerate() {
                        slots[id as usize % N].best = u64::from(blocked >> (4 * r) & 15 != 0);
                    }
                }
            }
            if Q::ORDERED {
                choose_in_order(slots, ids, &mut next);
            } else {
                choose(slots, ids, &mut next);
            }
            queues.sort_with::<true>(bvh, What::Leaves, &next, fetch);
        } else if queues.doors.len() == 0 {
            break;
        }
    }
}

/// Takes what is found, one hit at a time, where the filter accepts it.
#[inline]
#[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
fn ask<'a, Q: Carried<'a>, F: Filter>(
    slots: &mut [Slot; N],
    ids: &[u32],
    primitive: __m512i,
    found: &Found<__m512, __mmask16>,
    filter: &F,
) {
    let within = if Q::ORDERED {
        leaf::no_farther(found, slots, ids)
    } else {
        leaf::blocked(found, slots, ids)
    };
    if within == 0 {
        return;
    }
    let mut names = [0; 16];
    store16_u32(&mut names, primitive);
    let mut columns = [[0.0f32; 16]; 3];
    for (column, x) in columns.iter_mut().zip([found.t, found.u, found.v]) {
        store16(column, x);
    }
    let [t, u, v] = columns;
    let mut left = within;
    while left != 0 {
        let lane = left.trailing_zeros() as usize % 16;
        left &= left - 1;
        let slot = &mut slots[ids[lane / 4] as usize % N];
        let mut state = Q::state(slot);
        if Q::wants(&state, names[lane], t[lane])
            && filter.accepts(slot.id as usize, names[lane], u[lane], v[lane])
        {
            Q::take(&mut state, names[lane], t[lane], || [u[lane], v[lane]]);
            Q::keep(slot, &state);
        }
    }
}

/// A ray's leaf and the ray, where it is, as the exact test takes them.
#[cold]
fn exactly<const MOVES: bool>(
    world: &World,
    times: &[f32],
    slot: &Slot,
    home: &Home,
    load: impl Fn(usize) -> Option<Prepared>,
) -> Found<[f32; 4], u8> {
    // A ray under way could be loaded.
    let mut ray = load(slot.id as usize).unwrap_or_default();
    if home.door != NOTHING
        && let Some(object) = world.behind::<MOVES>(home.door, slot.id as usize, times)
    {
        let origin = object.point_in(home.origin);
        ray = ray.seen_as(origin, object.direction_in(home.direction));
    }
    leaf::exactly(&ray, &world.bvh.blocks[index(slot.next)])
}
