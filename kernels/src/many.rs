//! Many rays through the tree, or past a few triangles, by the fastest form that this processor has:
//! `avx512/`, or `flight.rs` and `few.rs`. Both give the same answers, bit for bit.
//!
//! Input and output: as `traverse.rs`.

use crate::bvh::Bvh;
use crate::few::{self, Few};
use crate::flight;
use crate::rays::{Hits, Rays, Segments};

/// Writes the closest hit of each ray.
///
/// # Panics
/// If a column is shorter than `rays.len`.
pub fn closest(bvh: Bvh, rays: Rays, hits: Hits) {
    #[cfg(target_arch = "x86_64")]
    if rays.len >= WORTH_IT && crate::avx512::available() {
        return crate::avx512::closest(bvh, rays, hits);
    }
    flight::closest::<IN_FLIGHT>(bvh, rays, hits);
}

/// Writes 1 for each segment that something lies on, else 0.
///
/// # Panics
/// If a column is shorter than `segments.len`.
pub fn occluded(bvh: Bvh, segments: Segments, occluded: &mut [u32]) {
    #[cfg(target_arch = "x86_64")]
    if segments.len >= WORTH_IT && crate::avx512::available() {
        return crate::avx512::occluded(bvh, segments, occluded);
    }
    flight::occluded::<IN_FLIGHT>(bvh, segments, occluded);
}

/// [`closest`] without a tree.
///
/// # Panics
/// If a column is shorter than `rays.len`, or there are too many vertices.
pub fn closest_of_few(few: Few, rays: Rays, hits: Hits) {
    #[cfg(target_arch = "x86_64")]
    if crate::avx512::available() {
        return crate::avx512::few::closest(few, rays, hits);
    }
    few::closest(few, rays, hits);
}

/// [`occluded`] without a tree.
///
/// # Panics
/// If a column is shorter than `segments.len`, or there are too many vertices.
pub fn occluded_by_few(few: Few, segments: Segments, occluded: &mut [u32]) {
    #[cfg(target_arch = "x86_64")]
    if crate::avx512::available() {
        return crate::avx512::few::occluded(few, segments, occluded);
    }
    few::occluded(few, segments, occluded);
}

/// What these functions use here.
#[must_use]
pub fn form() -> &'static str {
    #[cfg(target_arch = "x86_64")]
    if crate::avx512::available() {
        return "AVX-512";
    }
    "portable"
}

/// Rays under way together: see `docs/performance/rays.md`.
const IN_FLIGHT: usize = 32;
/// Fewer rays do not fill the slots of the form for AVX-512.
#[cfg(target_arch = "x86_64")]
const WORTH_IT: usize = 64;
