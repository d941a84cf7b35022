//! What a walk with doors asks of each query: how its rays lie in slots.

use crate::avx512::prepare::View;
use crate::avx512::slot::{Slot, key};
use crate::levels::{Ask, Filter, World, fly};
use crate::query::{Closest, ClosestHit, Occlusion, Within};
use crate::rays::NO_PRIMITIVE;
use crate::slabs::PAD;

/// A query whose rays can be carried in slots.
pub(crate) trait Carried<'a>: Ask {
    /// Its rays.
    fn view(&self) -> View<'a>;
    /// Puts into a slot what is known of its ray.
    fn take_up(&self, slot: &mut Slot);
    /// Writes the answer of a slot's ray.
    fn hand_in(&mut self, slot: &Slot);
    /// What is known of a slot's ray.
    fn state(slot: &Slot) -> Self::State;
    /// Puts that back.
    fn keep(slot: &mut Slot, state: &Self::State);
    /// Answers ray `i` by the portable form.
    fn alone<F: Filter, const MOVES: bool>(
        &mut self,
        world: &World,
        filter: &F,
        times: &[f32],
        i: usize,
    );
}

/// The filter of a view for ray `.1` alone.
struct Of<'a, F>(&'a F, usize);

impl<F: Filter> Filter for Of<'_, F> {
    const ASKS: bool = F::ASKS;
    fn accepts(&self, _: usize, primitive: u32, u: f32, v: f32) -> bool {
        self.0.accepts(self.1, primitive, u, v)
    }
}

/// The moment of ray `i` alone.
fn time<const MOVES: bool>(times: &[f32], i: usize) -> &[f32] {
    if MOVES { &times[i..=i] } else { &[] }
}

impl<'a> Carried<'a> for ClosestHit<'a, '_> {
    #[inline(always)]
    fn view(&self) -> View<'a> {
        View::of_rays(&self.rays)
    }

    #[inline(always)]
    fn take_up(&self, slot: &mut Slot) {
        let i = slot.id as usize;
        slot.best = match self.hits.primitive[i] {
            NO_PRIMITIVE => key(f32::MAX, NO_PRIMITIVE),
            known => {
                slot.uv = [self.hits.u[i], self.hits.v[i]];
                key((self.hits.t[i] / slot.ray.span).min(f32::MAX), known)
            }
        };
    }

    #[inline(always)]
    fn hand_in(&mut self, slot: &Slot) {
        slot.hand_in(&mut self.hits);
    }

    #[inline(always)]
    fn state(slot: &Slot) -> Closest {
        Closest {
            t: slot.t(),
            limit: slot.t() * (1.0 + PAD),
            primitive: slot.best as u32,
            u: slot.uv[0],
            v: slot.uv[1],
            leaves: slot.ray.leaves,
        }
    }

    #[inline(always)]
    fn keep(slot: &mut Slot, state: &Closest) {
        slot.best = key(state.t, state.primitive);
        slot.uv = [state.u, state.v];
    }

    #[cold]
    fn alone<F: Filter, const MOVES: bool>(
        &mut self,
        world: &World,
        filter: &F,
        times: &[f32],
        i: usize,
    ) {
        let mut one = ClosestHit {
            rays: self.rays.part(i..i + 1),
            hits: self.hits.part(i..i + 1),
        };
        fly::<_, _, 1, MOVES>(world, &Of(filter, i), time::<MOVES>(times, i), &mut one);
    }
}

impl<'a> Carried<'a> for Occlusion<'a, '_> {
    #[inline(always)]
    fn view(&self) -> View<'a> {
        View::of_segments(&self.segments)
    }

    #[inline(always)]
    fn take_up(&self, slot: &mut Slot) {
        let i = slot.id as usize;
        slot.reaches = self.segments.reaches[i];
        slot.best = u64::from(self.occluded[i]);
    }

    #[inline(always)]
    fn hand_in(&mut self, slot: &Slot) {
        self.occluded[slot.id as usize] = slot.best as u32;
    }

    #[inline(always)]
    fn state(slot: &Slot) -> Within {
        Within {
            t_max: slot.ray.span,
            limit: slot.ray.span * (1.0 + PAD),
            excluded: [slot.ray.leaves, slot.reaches],
            occluded: slot.best as u32,
        }
    }

    #[inline(always)]
    fn keep(slot: &mut Slot, state: &Within) {
        slot.best = u64::from(state.occluded);
    }

    #[cold]
    fn alone<F: Filter, const MOVES: bool>(
        &mut self,
        world: &World,
        filter: &F,
        times: &[f32],
        i: usize,
    ) {
        let mut one = Occlusion {
            segments: self.segments.part(i..i + 1),
            occluded: &mut self.occluded[i..=i],
        };
        fly::<_, _, 1, MOVES>(world, &Of(filter, i), time::<MOVES>(times, i), &mut one);
    }
}
