//! The queues of the wave: what a path is between two stages.

use crate::lanes::{LANES, Mask, Ux, first, gather_u32, load_u32, padded};
use crate::soa;

/// Set in `bounces` of a path that may find light but does not scatter again.
pub const LAST_RAY: u32 = 1 << 31;

/// Set in `bounces` of a path whose ray leaves a surface that light passes through: next-event
/// estimation there looked for light on both sides, which the pdf of light found depends on.
pub const BOTH_SIDES: u32 = 1 << 30;

/// All marks that may be set in `bounces`.
pub const MARKS: u32 = LAST_RAY | BOTH_SIDES;

soa! {
    /// Paths, each at the start of its next ray.
    pub struct Paths, PathsMut {
        /// Where the ray starts, world space.
        origin: Vec3,
        /// Its direction, a unit vector to rounding.
        direction: Vec3,
        /// Product of BSDF * cos / pdf (and 1 / survival) over the path so far.
        throughput: Vec3,
        /// Solid-angle pdf of `direction`; infinite where nothing but this ray could have found what
        /// it finds: camera rays, and directions that a delta lobe gave.
        pdf: F32,
        /// The triangle that the ray leaves, or `NO_PRIMITIVE`.
        leaves: U32,
        /// The camera sample in the job: where the path's radiance is added up.
        slot: U32,
        /// The pixel, as the sampler knows it; see `sampler::Sampler::pixel`.
        pixel: U32,
        /// Sample index within the pixel.
        sample: U32,
        /// Scattering events so far: the path's dimension counter. [`MARKS`] may be set in it.
        bounces: U32,
    }
}

soa! {
    /// What the rays of [`Paths`] met, item by item.
    pub struct PathHits, PathHitsMut {
        /// Index of the triangle, or `NO_PRIMITIVE`.
        primitive: U32,
        /// Ray parameter.
        t: F32,
        /// Barycentric weight of the second vertex.
        u: F32,
        /// Barycentric weight of the third vertex.
        v: F32,
    }
}

/// Some of the wave's paths at the ends of their rays: what a shading kernel is given.
#[derive(Clone, Copy, Debug)]
pub struct Listed<'a> {
    /// Which paths, padded with valid indices to whole vectors.
    pub index: &'a [u32],
    /// How many.
    pub len: usize,
    /// The wave's paths.
    pub paths: Paths<'a>,
    /// Their hits.
    pub hits: PathHits<'a>,
}

impl<'a> Listed<'a> {
    /// A vector of paths at a time: the place of its first item in the list, the paths' places in
    /// the queue, and which lanes hold one.
    #[inline(always)]
    pub fn vectors(self) -> impl Iterator<Item = (usize, Ux, Mask)> + 'a {
        let start = (0..padded(self.len)).step_by(LANES);
        start.map(move |i| (i, load_u32(self.index, i), first(self.len - i)))
    }
}

/// Which paths the lanes of a vector hold: what names their random numbers and their samples.
#[derive(Clone, Copy, Debug)]
pub struct Identity {
    /// Camera sample in the job.
    pub slot: Ux,
    /// The pixel's name to the sampler.
    pub pixel: Ux,
    /// Sample index within the pixel.
    pub sample: Ux,
    /// Scattering events so far, without marks.
    pub bounces: Ux,
}

impl Paths<'_> {
    /// The identities of the paths at places `at` of the queue.
    #[inline(always)]
    #[must_use]
    pub fn identity(&self, at: Ux) -> Identity {
        Identity {
            slot: gather_u32(self.slot, at),
            pixel: gather_u32(self.pixel, at),
            sample: gather_u32(self.sample, at),
            bounces: gather_u32(self.bounces, at) & Ux::splat(!MARKS),
        }
    }
}

soa! {
    /// Occlusion rays, and the light that arrives if nothing is in the way.
    pub struct Shadows, ShadowsMut {
        /// Where the segment starts.
        origin: Vec3,
        /// Towards its end; its length is in `t_max`'s unit.
        direction: Vec3,
        /// Ray parameter of its end; may be infinite.
        t_max: F32,
        /// The triangle that it leaves.
        leaves: U32,
        /// The triangle that it ends on, or `NO_PRIMITIVE`.
        reaches: U32,
        /// Radiance to add to the path's sample, throughput included.
        radiance: Vec3,
        /// The path's camera sample in the job.
        slot: U32,
        /// Scattering events of the path before this one; for the accounting.
        bounces: U32,
    }
}

soa! {
    /// Answers to [`Shadows`], item by item.
    pub struct Occlusion, OcclusionMut {
        /// 1 if something is in the way, 0 if not.
        occluded: U32,
    }
}
