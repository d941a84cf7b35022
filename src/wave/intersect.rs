//! Intersect and occlude: the two stages that ask the geometry.
//!
//! Intersect. In: paths. Out: hits, item by item.
//! Occlude. In: occlusion rays. Out: light added to the samples of those that met nothing.

use super::queue::Queue;
use crate::film::SampleBuffer;
use crate::geometry::Geometry;
use huygens_kernels::emission::unoccluded;
use huygens_kernels::queues::{OcclusionMut, PathHitsMut, PathsMut, ShadowsMut};
use huygens_kernels::rays::{Hits, Rays, Segments};

/// Finds the closest hit of each path's ray.
pub(crate) fn intersect(
    geometry: &Geometry,
    paths: &Queue<PathsMut<'static>>,
    hits: &mut Queue<PathHitsMut<'static>>,
) {
    let (n, view) = (paths.len(), paths.view());
    let out = hits.view_mut();
    geometry.closest(
        Rays {
            len: n,
            origin: view.origin,
            direction: view.direction,
            leaves: view.leaves,
        },
        Hits {
            primitive: out.primitive,
            t: out.t,
            u: out.u,
            v: out.v,
        },
    );
    hits.set_len(n);
}

/// Answers the occlusion rays and adds the light of the free ones.
pub(crate) fn occlude(
    geometry: &Geometry,
    shadows: &Queue<ShadowsMut<'static>>,
    occlusion: &mut Queue<OcclusionMut<'static>>,
    samples: &mut SampleBuffer,
    dropped: impl FnMut(u32),
) {
    let (n, view) = (shadows.len(), shadows.view());
    geometry.occluded(
        Segments {
            len: n,
            origin: view.origin,
            direction: view.direction,
            t_max: view.t_max,
            leaves: view.leaves,
            reaches: view.reaches,
        },
        occlusion.view_mut().occluded,
    );
    occlusion.set_len(n);
    unoccluded(
        n,
        occlusion.view().occluded,
        view.slot,
        view.radiance,
        &mut samples.columns(),
        dropped,
    );
}
