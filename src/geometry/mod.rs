//! What rays meet. Everything above sees only [`Geometry`].

use crate::scene::Mesh;
use huygens_kernels::rays::{Hits, Rays, Segments};

/// The acceleration structure over a mesh.
#[derive(Debug)]
pub struct Geometry {}

impl Geometry {
    /// Builds over all triangles of `mesh`, deterministically, on the current rayon pool.
    #[must_use]
    pub fn build(mesh: &Mesh) -> Self {
        let _ = mesh;
        Self {}
    }

    /// Closest hit of each ray.
    pub fn closest(&self, rays: Rays, hits: Hits) {
        let _ = (rays, hits);
        unimplemented!("written by the geometry room")
    }

    /// For each segment: 1 if something lies on it, 0 if its ends see each other.
    pub fn occluded(&self, segments: Segments, occluded: &mut [u32]) {
        let _ = (segments, occluded);
        unimplemented!("written by the geometry room")
    }
}
