//! Rays at doors: spheres are tested there and then; rays that enter a copy of an object are made ready
//! anew, sixteen at a time; those that come out are put back.

use super::Carried;
use crate::avx512::N;
use crate::avx512::simd::{load16, store16};
use crate::avx512::sixteen::{Sixteen, slack_in};
use crate::avx512::slot::{Ray, Slot};
use crate::bvh::NOTHING;
use crate::levels::{Filter, World, place, roll};

/// What the world knows of a ray under way.
#[derive(Clone, Copy)]
pub(super) struct Home {
    /// The ray as the world sees it.
    pub(super) ray: Ray,
    pub(super) leave: [f32; 3],
    pub(super) origin: [f32; 3],
    /// With its largest component in `[1, 2)`.
    pub(super) direction: [f32; 3],
    /// What the first triangle of the tree where it is is called.
    pub(super) first: u32,
    /// The door that it went through, or [`NOTHING`].
    pub(super) door: u32,
    /// Whether somebody else has answered it.
    pub(super) is_answered: bool,
}

impl Home {
    pub(super) const NEW: Self = Self {
        ray: Slot::NEW.ray,
        leave: [0.0; 3],
        origin: [0.0; 3],
        direction: [0.0; 3],
        first: 0,
        door: NOTHING,
        is_answered: false,
    };
}

/// The mark on a ray's stack where it leaves an object: a door that leads out.
const OUT: u32 = NOTHING - 1;

/// Has the rays `ids` go through their doors; `next` says where to, by place in `ids`.
#[inline]
#[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
pub(super) fn go_through<'a, Q: Carried<'a>, F: Filter, const MOVES: bool>(
    slots: &mut [Slot; N],
    homes: &mut [Home; N],
    world: &World,
    (filter, times): (&F, &[f32]),
    query: &mut Q,
    ids: &[u32],
    next: &mut [u32; N],
) {
    let mut group = Group::default();
    for &id in ids {
        let (slot, home) = (&mut slots[id as usize % N], &mut homes[id as usize % N]);
        let door = slot.next;
        let leads = place(door);
        if door == OUT {
            slot.ray = home.ray;
            slot.leave = home.leave;
            (home.first, home.door) = (0, NOTHING);
        } else if leads < world.spheres.len() {
            let ray = (slot.id as usize, home.origin, home.direction);
            let mut state = Q::state(slot);
            roll::<Q, F>(ray, &mut state, &world.spheres[leads], filter);
            Q::keep(slot, &state);
        } else {
            match world.behind::<MOVES>(door, slot.id as usize, times) {
                Some(object) => {
                    home.first = object.first;
                    home.door = door;
                    slot.push_mark(OUT);
                    slot.next = object.root;
                    let origin = object.point_in(home.origin);
                    group.add(
                        id,
                        origin,
                        object.direction_in(home.direction),
                        object.extent,
                    );
                    if group.len == 16 {
                        group.enter::<Q, F, MOVES>(slots, homes, world, (filter, times), query);
                    }
                }
                None => slot.next = world.own_root,
            }
            continue;
        }
        if Q::ORDERED {
            slot.pop_in_order();
        } else {
            slot.pop();
        }
    }
    group.enter::<Q, F, MOVES>(slots, homes, world, (filter, times), query);
    for (next, &id) in next.iter_mut().zip(ids) {
        *next = slots[id as usize % N].next;
    }
}

/// Rays that enter objects.
#[derive(Default)]
#[repr(align(64))]
struct Group {
    origin: [[f32; 16]; 3],
    direction: [[f32; 16]; 3],
    extent: [f32; 16],
    id: [u32; 16],
    len: usize,
}

impl Group {
    #[inline(always)]
    fn add(&mut self, id: u32, origin: [f32; 3], direction: [f32; 3], extent: f32) {
        let lane = self.len % 16;
        for axis in 0..3 {
            self.origin[axis][lane] = origin[axis];
            self.direction[axis][lane] = direction[axis];
        }
        self.extent[lane] = extent;
        self.id[lane] = id;
        self.len = lane + 1;
    }

    /// Makes the rays ready for their objects.
    #[inline(never)]
    #[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
    fn enter<'a, Q: Carried<'a>, F: Filter, const MOVES: bool>(
        &mut self,
        slots: &mut [Slot; N],
        homes: &mut [Home; N],
        world: &World,
        (filter, times): (&F, &[f32]),
        query: &mut Q,
    ) {
        let len = std::mem::take(&mut self.len);
        if len == 0 {
            return;
        }
        let [ox, oy, oz] = &self.origin;
        let [dx, dy, dz] = &self.direction;
        let (o, d) = (
            [load16(ox), load16(oy), load16(oz)],
            [load16(dx), load16(dy), load16(dz)],
        );
        let sixteen = Sixteen::of::<false>(o, d, len);
        let slack = slack_in(o, d, sixteen.inverse, load16(&self.extent), sixteen.scale);
        let (rows, sides) = sixteen.rows(slack, o[0], o[0]);
        let mut rays = [[0.0f32; 16]; 16];
        for (to, row) in rays.iter_mut().zip(rows) {
            store16(to, row);
        }
        let mut leave = [[0.0; 16]; 3];
        for (to, side) in leave.iter_mut().zip(sides) {
            store16(to, side);
        }
        let ready = sixteen.usual();
        for lane in 0..len.min(16) {
            let id = self.id[lane] as usize % N;
            let slot = &mut slots[id];
            if ready >> lane & 1 == 0 {
                homes[id].is_answered = true;
                slot.next = NOTHING;
                query.alone::<F, MOVES>(world, filter, times, slot.id as usize);
                continue;
            }
            let (span, leaves) = (slot.ray.span, slot.ray.leaves);
            slot.ray = Ray {
                span,
                leaves,
                ..bytemuck::cast(rays[lane])
            };
            slot.leave = [0, 1, 2].map(|axis| leave[axis][lane]);
        }
    }
}
