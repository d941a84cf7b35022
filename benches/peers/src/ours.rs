//! Huygens' side: the seam that the wave uses, in calls of a wave's size.

use crate::queue::{Closest, Found, Occluded, Queue};
use huygens::geometry::{Geometry, Preset};
use huygens::scene::Mesh;

/// Rays a call: what a wave of the default capacity asks at once.
pub(crate) const WAVE: usize = 4096;

/// Huygens over one mesh.
#[derive(Debug)]
pub(crate) struct Ours(Geometry);

impl Ours {
    /// Builds on the current rayon pool.
    pub(crate) fn build(mesh: &Mesh, preset: Preset) -> Self {
        Self(Geometry::build_with(mesh, preset))
    }

    /// Bytes of tree and leaf blocks.
    pub(crate) fn bytes(&self) -> usize {
        self.0.memory().iter().map(|(_, bytes)| bytes).sum()
    }
}

impl Closest for Ours {
    fn closest(&self, rays: &Queue, found: &mut Found) {
        for start in (0..rays.len()).step_by(WAVE) {
            let range = start..rays.len().min(start + WAVE);
            self.0.closest(rays.rays(range.clone()), found.hits(&range));
        }
    }
}

impl Occluded for Ours {
    fn occluded(&self, rays: &Queue, blocked: &mut [u32]) {
        for start in (0..rays.len()).step_by(WAVE) {
            let segments = rays.segments(start..rays.len().min(start + WAVE));
            let padded = segments.t_max.len();
            self.0
                .occluded(segments, &mut blocked[start..start + padded]);
        }
    }
}
