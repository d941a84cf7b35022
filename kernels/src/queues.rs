//! The queues of the wave: what a path is between two stages.

use crate::lanes::{Fx, LANES, Mask, Ux, first, gather, gather_u32, load_u32, padded};
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

soa! {
    /// The wavelengths of [`Paths`], item by item, where something disperses light.
    pub struct Wavelengths, WavelengthsMut {
        /// In nanometres; 0 while the path carries all of them.
        wavelength: F32,
    }
}

soa! {
    /// The media of [`Paths`], item by item, where a scene has any.
    pub struct Mediums, MediumsMut {
        /// The one that the ray runs through: a row of `medium::Media`.
        medium: U32,
    }
}

soa! {
    /// The moments at which [`Paths`] live, or [`Shadows`], item by item, where something moves.
    pub struct Times, TimesMut {
        /// 0 where the shutter opens, 1 where it closes.
        time: F32,
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
    /// The material that each path of the wave met, where that is not its triangle's: place by place
    /// of the queue, not of the list.
    pub material: Option<&'a [u32]>,
    /// The moments at which the wave's paths live, where something moves.
    pub times: Option<&'a [f32]>,
}

impl<'a> Listed<'a> {
    /// The moments of the paths at places `at`.
    #[inline(always)]
    #[must_use]
    pub fn times(&self, at: Ux) -> Option<Fx> {
        self.times.map(|times| gather(times, at))
    }

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
    /// Surface interactions: what [`Listed`] paths met, row by row of their list, where the surface
    /// is more than a plain diffuse one.
    pub struct Surfaces, SurfacesMut {
        /// The hit point.
        point: Vec3,
        /// How far along `normal`, to either side, a ray has to start to be off the surface.
        clearance: F32,
        /// Unit geometric normal on the side that the path came from.
        normal: Vec3,
        /// Unit shading normal: the z axis of the local frame.
        shading: Vec3,
        /// Unit vector back along the path, in the local frame.
        omega_o: Vec3,
        /// All bits set if the path came from the front, else 0.
        front: U32,
        /// The triangle.
        primitive: U32,
        /// Its material; of a mixture, the one that was drawn.
        material: U32,
    }
}

soa! {
    /// What interpolated surfaces have besides, row by row of [`Surfaces`].
    pub struct Smooth, SmoothMut {
        /// How well the corners' normals agree: `interpolate::Interpolated::coherence`.
        coherence: F32,
    }
}

soa! {
    /// Which way brushed surfaces lie, row by row of [`Surfaces`]: by which angle their local frame is
    /// turned about the shading normal (`scatter::align`).
    pub struct Aligned, AlignedMut {
        /// The angle's cosine.
        cos: F32,
        /// Its sine.
        sin: F32,
    }
}

soa! {
    /// The BSDF parameters of surfaces that read images, row by row of [`Surfaces`]: a material a row.
    pub struct Textured, TexturedMut {
        /// As `tables::Materials::parameters`.
        parameters: Slots,
        /// The row's own number: its material among `parameters`.
        row: U32,
    }
}

soa! {
    /// The uniform numbers that the rows of [`Surfaces`] use.
    pub struct Drawn, DrawnMut {
        /// For the next direction: two, and one that chooses a lobe.
        direction: Vec3,
        /// For a light: two to select it, two for a point on it.
        select: F32,
        /// See `select`.
        keep: F32,
        /// See `select`.
        u: F32,
        /// See `select`.
        v: F32,
    }
}

soa! {
    /// One sample of the light around each row of [`Surfaces`].
    pub struct Lit, LitMut {
        /// Where the occlusion ray starts.
        origin: Vec3,
        /// To the light; see `light::LightSample`.
        segment: Vec3,
        /// Ray parameter of the light along `segment`.
        t_max: F32,
        /// Triangle sampled, or `NO_PRIMITIVE`.
        primitive: U32,
        /// Unit vector to the light, world space.
        direction: Vec3,
        /// Radiance over the pdf; black where the sample can carry nothing.
        radiance: Vec3,
        /// The pdf of `direction` in solid angle, selection included; infinite if nothing but next-event
        /// estimation can find the light.
        pdf: F32,
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
