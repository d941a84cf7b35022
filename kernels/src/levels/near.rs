//! Which rays may meet anything of a world of two levels, asked eight rays at a time; those are brought
//! together and walk.
//!
//! Reads 44 bytes of a ray with its answer and writes up to 16.

mod boxes;

use super::{Filter, World, fly};
use crate::compact::Kept;
use crate::few::load_part;
use crate::lanes::{Fx, LANES, Mask, Ux, as_mask, first, iota};
use crate::query::{ClosestHit, Occlusion};
use crate::rays::{Hits, NO_PRIMITIVE, Rays, Segments};
use crate::vec3::Columns;
use boxes::Boxes;
use std::cell::RefCell;

/// Rays under way together: see `docs/performance/rays.md`.
const IN_FLIGHT: usize = 32;
/// Rays that walk together at most, but for a vector.
const MOST: usize = 2048;
const ROOM: usize = MOST + 2 * LANES;
/// A word of each ray that is brought together.
type Column = [u32; ROOM];

thread_local! {
    /// 107 KB that need not be written at every call.
    static NEAR: RefCell<Near> = const {
        RefCell::new(Near {
            place: [0; ROOM],
            time: [0; ROOM],
            ray: [[0; ROOM]; 6],
            words: [[0; ROOM]; 5],
            len: 0,
        })
    };
}

/// Puts in place of each ray's hit the closest one that lies before it. `hits` holds what rays are known to
/// meet, [`NO_PRIMITIVE`] for nothing. Where instances move ray `i` lives at `times[i]`.
///
/// # Panics
/// If a column is shorter than `rays.len`.
pub fn nearer<F: Filter>(world: &World, filter: &F, times: Option<&[f32]>, rays: Rays, hits: Hits) {
    improve::<F, false>(world, filter, times, rays, hits);
}

/// [`nearer`] as it is where there is no AVX-512.
///
/// # Panics
/// As [`nearer`].
pub fn nearer_without_avx512<F: Filter>(
    world: &World,
    filter: &F,
    times: Option<&[f32]>,
    rays: Rays,
    hits: Hits,
) {
    improve::<F, true>(world, filter, times, rays, hits);
}

fn improve<F: Filter, const PORTABLE: bool>(
    world: &World,
    filter: &F,
    times: Option<&[f32]>,
    rays: Rays,
    mut hits: Hits,
) {
    let Some(boxes) = Boxes::new(world) else {
        return;
    };
    let view = (rays.len, rays.origin, rays.direction);
    NEAR.with_borrow_mut(|near| {
        for i in (0..rays.len).step_by(LANES) {
            let words = [
                Ux::new(load_part(rays.leaves, i)),
                Ux::new(load_part(hits.primitive, i)),
                words_of(hits.t, i),
                words_of(hits.u, i),
                words_of(hits.v, i),
            ];
            let nothing = as_mask(words[1].simd_eq(Ux::splat(NO_PRIMITIVE)));
            let end = nothing.select(Fx::splat(f32::MAX), bytemuck::cast(words[2]));
            near.gather(&boxes, view, times, i, end, Fx::ZERO, words);
            if near.len >= MOST {
                near.closest::<F, PORTABLE>(world, filter, times.is_some(), &mut hits);
            }
        }
        near.closest::<F, PORTABLE>(world, filter, times.is_some(), &mut hits);
    });
}

/// Writes 1 for each segment that something lies on; of others, what is in `occluded` stays, and segments
/// that have a 1 already are not asked about. Where instances move segment `i` lives at `times[i]`.
///
/// # Panics
/// If a column is shorter than `segments.len`.
pub fn obstructed<F: Filter>(
    world: &World,
    filter: &F,
    times: Option<&[f32]>,
    segments: Segments,
    occluded: &mut [u32],
) {
    block::<F, false>(world, filter, times, segments, occluded);
}

/// [`obstructed`] as it is where there is no AVX-512.
///
/// # Panics
/// As [`obstructed`].
pub fn obstructed_without_avx512<F: Filter>(
    world: &World,
    filter: &F,
    times: Option<&[f32]>,
    segments: Segments,
    occluded: &mut [u32],
) {
    block::<F, true>(world, filter, times, segments, occluded);
}

fn block<F: Filter, const PORTABLE: bool>(
    world: &World,
    filter: &F,
    times: Option<&[f32]>,
    segments: Segments,
    occluded: &mut [u32],
) {
    let Some(boxes) = Boxes::new(world) else {
        return;
    };
    let view = (segments.len, segments.origin, segments.direction);
    NEAR.with_borrow_mut(|near| {
        for i in (0..segments.len).step_by(LANES) {
            let words = [
                Ux::new(load_part(segments.leaves, i)),
                Ux::new(load_part(segments.reaches, i)),
                words_of(segments.t_max, i),
                Ux::ZERO,
                Ux::ZERO,
            ];
            let known = Ux::new(load_part(occluded, i)).simd_eq(Ux::ONE);
            let end = bytemuck::cast(words[2]);
            near.gather(&boxes, view, times, i, end, as_mask(known), words);
            if near.len >= MOST {
                near.occluded::<F, PORTABLE>(world, filter, times.is_some(), occluded);
            }
        }
        near.occluded::<F, PORTABLE>(world, filter, times.is_some(), occluded);
    });
}

fn words_of(column: &[f32], i: usize) -> Ux {
    Ux::new(load_part(bytemuck::cast_slice(column), i))
}

/// Rays that may meet something, brought together.
struct Near {
    /// Where they lie in the view.
    place: Column,
    /// Their moments, where instances move.
    time: Column,
    /// Origins, then directions.
    ray: [Column; 6],
    /// What a query has besides.
    words: [Column; 5],
    len: usize,
}

impl Near {
    /// Adds those of the rays `i .. i + LANES` of a view that may meet something before their `end`, but
    /// for those `known`.
    #[inline(always)]
    #[expect(
        clippy::too_many_arguments,
        reason = "a view, a place in it, and what is there"
    )]
    fn gather(
        &mut self,
        boxes: &Boxes,
        (len, origin, direction): (usize, Columns, Columns),
        times: Option<&[f32]>,
        i: usize,
        end: Fx,
        known: Mask,
        words: [Ux; 5],
    ) {
        let origin = origin.map(|column| Fx::new(load_part(column, i)));
        let direction = direction.map(|column| Fx::new(load_part(column, i)));
        let met = boxes.met(origin, direction, end) & !known & first(len - i);
        if met.none() {
            return;
        }
        let time = times.map_or(Ux::ZERO, |times| words_of(times, i));
        let kept = Kept::new(met);
        let keep = |column: &mut Column, word| kept.store_u32(column, self.len, word);
        keep(&mut self.place, iota(i as u32));
        keep(&mut self.time, time);
        for (column, number) in self.ray.iter_mut().zip(origin.into_iter().chain(direction)) {
            keep(column, bytemuck::cast(number));
        }
        for (column, word) in self.words.iter_mut().zip(words) {
            keep(column, word);
        }
        self.len += kept.count;
    }

    /// Has the rays walk and hands in what they meet.
    fn closest<F: Filter, const PORTABLE: bool>(
        &mut self,
        world: &World,
        filter: &F,
        moves: bool,
        hits: &mut Hits,
    ) {
        let len = std::mem::take(&mut self.len);
        if len == 0 {
            return;
        }
        let Self {
            place,
            time,
            ray,
            words: [leaves, primitive, t, u, v],
            ..
        } = self;
        let [origin, direction] = vectors(ray);
        let rays = Rays {
            len,
            origin,
            direction,
            leaves,
        };
        let found = Hits {
            primitive,
            t: bytemuck::cast_slice_mut(t),
            u: bytemuck::cast_slice_mut(u),
            v: bytemuck::cast_slice_mut(v),
        };
        let filter = Placed { filter, place };
        let times = moves.then_some(numbers(time));
        walk::<_, _, PORTABLE>(world, &filter, times, ClosestHit { rays, hits: found });
        for (j, &i) in place[..len].iter().enumerate() {
            let i = i as usize;
            hits.primitive[i] = primitive[j];
            hits.t[i] = f32::from_bits(t[j]);
            hits.u[i] = f32::from_bits(u[j]);
            hits.v[i] = f32::from_bits(v[j]);
        }
    }

    /// Has the segments walk and hands in whether something lies on them.
    fn occluded<F: Filter, const PORTABLE: bool>(
        &mut self,
        world: &World,
        filter: &F,
        moves: bool,
        occluded: &mut [u32],
    ) {
        let len = std::mem::take(&mut self.len);
        if len == 0 {
            return;
        }
        let Self {
            place,
            time,
            ray,
            words: [leaves, reaches, t_max, out, _],
            ..
        } = self;
        let [origin, direction] = vectors(ray);
        let segments = Segments {
            len,
            origin,
            direction,
            t_max: numbers(t_max),
            leaves,
            reaches,
        };
        let filter = Placed { filter, place };
        let times = moves.then_some(numbers(time));
        let query = Occlusion {
            segments,
            occluded: out,
        };
        walk::<_, _, PORTABLE>(world, &filter, times, query);
        for (&i, &out) in place[..len].iter().zip(&*out) {
            occluded[i as usize] = out;
        }
    }
}

fn numbers(column: &Column) -> &[f32] {
    bytemuck::cast_slice(column)
}

/// Origins and directions of [`Near::ray`].
fn vectors([ox, oy, oz, dx, dy, dz]: &[Column; 6]) -> [Columns<'_>; 2] {
    [[ox, oy, oz], [dx, dy, dz]].map(|vector| vector.map(numbers))
}

/// A filter of the view from which rays were brought together.
struct Placed<'a, F> {
    filter: &'a F,
    place: &'a [u32],
}

impl<F: Filter> Filter for Placed<'_, F> {
    const ASKS: bool = F::ASKS;
    #[inline(always)]
    fn accepts(&self, ray: usize, primitive: u32, u: f32, v: f32) -> bool {
        let ray = self.place[ray] as usize;
        self.filter.accepts(ray, primitive, u, v)
    }
}

/// Has rays walk, by the fastest form that this processor has.
fn walk<'a, Q: Walked<'a>, F: Filter, const PORTABLE: bool>(
    world: &World,
    filter: &F,
    times: Option<&[f32]>,
    mut query: Q,
) {
    #[cfg(target_arch = "x86_64")]
    if !PORTABLE && crate::avx512::levels::can_fly(world) {
        use crate::avx512::levels::fly;
        return match times {
            None => fly::<Q, F, false>(world, filter, &[], &mut query),
            Some(times) => fly::<Q, F, true>(world, filter, times, &mut query),
        };
    }
    match times {
        None => fly::<Q, F, IN_FLIGHT, false>(world, filter, &[], &mut query),
        Some(times) => fly::<Q, F, IN_FLIGHT, true>(world, filter, times, &mut query),
    }
}

#[cfg(target_arch = "x86_64")]
use crate::avx512::levels::Carried as Walked;
/// A query that any form can answer.
#[cfg(not(target_arch = "x86_64"))]
trait Walked<'a>: super::Ask {}
#[cfg(not(target_arch = "x86_64"))]
impl<Q: super::Ask> Walked<'_> for Q {}
