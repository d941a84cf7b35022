//! What materials read of images, and over how wide a footprint.
//!
//! *Footprint.* A ray is a cone about its direction (T. Akenine-Moeller et al., "Improved Shader and
//! Texture Level of Detail Using Ray Cones", JCGT 10(1), 2021) that begins anew with each ray: at
//! distance `t` its width is
//!
//! ```text
//! max(w0 + t s, t sqrt(4 / (pi N_d p)))
//! ```
//!
//! `w0` and `s` are the width at the camera and the spread of a pixel, both divided by
//! `sqrt(N_c)`; `p` is the pdf in solid angle with which scattering drew the direction: it stands
//! for the solid angle `1 / p`, of which the root is the diameter of a disc of the share `1 / N_d`
//! (the measure by which path differentials tell the footprint of a sample, F. Suykens, Y. Willems,
//! "Path Differentials and Applications", EGWR 2001). Where `p` is infinite, for camera rays and
//! mirrors, the first counts alone.
//!
//! `N_c` = [`CAMERA_SAMPLES`] and `N_d` = [`SCATTERED_SAMPLES`]: the samples of a pixel average over
//! it already, and what is blurred by more than the distance between so many samples is blurred
//! twice (*PBRT* 4th ed., 10.1.2, narrows by the root of the samples, down to 1/8). A blur of a
//! disc of half angle `a` changes what a matt surface collects by about `a^2 / 8` of the contrast,
//! here 0.0005. Where every image is to be read at its finest, the cone is none ([`Cone::NONE`]): of no
//! width anywhere. At grazing angles the footprint is the cone's width, not the longer one across the
//! surface: what it leaves out, the pixel's samples average.

use crate::interpolate::{Interpolated, towards};
use crate::lanes::{Fx, Mask, Ux, as_bits, as_mask, gather_u32};
use crate::math::INV_PI;
use crate::opacity::Opacity;
use crate::surface::Place;
use crate::tables::Tables;
use crate::texture::{NO_TEXTURE, Textures};
use crate::vec3::Vec3x;

/// Samples of a pixel that cover it without gaps.
pub const CAMERA_SAMPLES: f32 = 16.0;
/// Samples of a scattered direction that cover all of them without gaps.
pub const SCATTERED_SAMPLES: f32 = 256.0;

/// Most parameters of a kind of BSDF that images may vary.
pub const SITES: usize = 10;

/// A parameter that images may vary.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Site {
    /// Its place in the material tables: of a colour, that of red.
    pub slot: usize,
    /// Whether it is a colour.
    pub colour: bool,
}

/// How a normal or bump map is read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Relief {
    /// Index of the texture use, or [`NO_TEXTURE`] for none.
    pub texture: u32,
    /// Whether texels are heights, not normals.
    pub heights: bool,
    /// What x and y of normals, or heights, are multiplied with.
    pub strength: f32,
    /// Width of a texel of the whole image in the surface's (u, v): the geometric mean of both axes.
    pub texel: f32,
}

impl Relief {
    /// None.
    pub const NONE: Self = Self {
        texture: NO_TEXTURE,
        heights: false,
        strength: 0.0,
        texel: 1.0,
    };
}

/// How wide rays are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    /// Width at the camera, scene units.
    pub start: f32,
    /// By how much it grows over a distance of 1.
    pub spread: f32,
    /// The square of what a scattered ray's grows by over a distance of 1, times the pdf of its direction.
    pub scattered: f32,
}

impl Cone {
    /// Rays without width.
    pub const NONE: Self = Self {
        start: 0.0,
        spread: 0.0,
        scattered: 0.0,
    };

    /// The cone of rays of which neighbouring pixels' are `start` apart at the camera and diverge by
    /// `spread` radians.
    #[must_use]
    pub fn of_pixels(start: f64, spread: f64) -> Self {
        let share = 1.0 / f64::from(CAMERA_SAMPLES).sqrt();
        Self {
            start: (start * share) as f32,
            spread: (spread * share) as f32,
            scattered: 4.0 * INV_PI / SCATTERED_SAMPLES,
        }
    }

    /// The width at distance `t` of rays of which the direction was drawn with `pdf`.
    #[inline(always)]
    #[must_use]
    pub fn width(&self, t: Fx, pdf: Fx) -> Fx {
        let seen = t.mul_add(Fx::splat(self.spread), Fx::splat(self.start));
        seen.fast_max((Fx::splat(self.scattered) / pdf).sqrt() * t)
    }
}

/// What materials read of images.
#[derive(Clone, Copy, Debug)]
pub struct Images<'a> {
    /// The images and ways to read them.
    pub textures: Textures<'a>,
    /// By place among the parameters that images may vary in a kind of BSDF, and by material: the
    /// texture use, or [`NO_TEXTURE`].
    pub sites: [&'a [u32]; SITES],
    /// Normal and bump maps, by material; empty if there are none.
    pub relief: &'a [Relief],
    /// Texture uses of what is a material's colour in one word (`Materials::albedo`), by material.
    pub albedo: &'a [u32],
    /// Texture uses of emission, by material; empty if none has one.
    pub emission: &'a [u32],
    /// Opacities, by material; empty if all are wholly there.
    pub opacity: &'a [Opacity],
    /// The cone of the camera's rays.
    pub cone: Cone,
}

impl Images<'_> {
    /// The texture uses of the emission of `material` where `busy`, else [`NO_TEXTURE`].
    #[inline(always)]
    #[must_use]
    pub fn emission_of(&self, material: Ux, busy: Mask) -> Ux {
        if self.emission.is_empty() {
            return Ux::splat(NO_TEXTURE);
        }
        as_bits(busy).select(gather_u32(self.emission, material), Ux::splat(NO_TEXTURE))
    }

    /// Where the emission of `material` may vary over a surface: by an image, or by what is there.
    #[inline(always)]
    #[must_use]
    pub fn vary_emission(&self, material: Ux) -> Mask {
        let all = as_mask(Ux::splat(u32::MAX));
        let plain = self
            .emission_of(material, all)
            .simd_eq(Ux::splat(NO_TEXTURE));
        let whole = |m: u32| {
            self.opacity
                .get(m as usize)
                .is_none_or(|o| *o == Opacity::WHOLE)
        };
        let whole = material
            .to_array()
            .map(|m| if whole(m) { u32::MAX } else { 0 });
        !as_mask(plain & Ux::new(whole))
    }

    /// How much of `material` is there at points of triangles: of masks, 0 or 1.
    #[inline]
    #[must_use]
    pub fn opacity_at(&self, tables: &Tables, primitive: Ux, material: Ux, u: Fx, v: Fx) -> Fx {
        if self.opacity.is_empty() {
            return Fx::ONE;
        }
        let rows = material.to_array().map(|m| self.opacity[m as usize]);
        let which = Ux::new(rows.map(|row| row.texture));
        let uv = Read::at(tables, primitive, (u, v), Fx::ZERO, None);
        let uv = uv.map_or([Fx::ZERO; 2], |read| read.point.uv);
        let factor = Fx::new(rows.map(|row| row.factor));
        let alpha = factor * self.textures.sample(which, uv, Fx::ZERO).x;
        let cutoff = Fx::new(rows.map(|row| row.cutoff));
        let mask = alpha.simd_ge(cutoff) & Fx::ONE;
        cutoff.simd_eq(cutoff).select(mask, alpha)
    }
}

/// Where the lanes' hits are in texture coordinates.
#[derive(Clone, Copy, Debug)]
pub struct Read {
    /// What interpolation tells of the points.
    pub point: Interpolated,
    /// Width of the footprint in (u, v).
    pub width: Fx,
}

impl Read {
    /// Points with barycentric weights `u`, `v` of `primitive` that rays of cone width `width` met;
    /// (0, 0) where there are no coordinates, none if nothing has any.
    #[inline(always)]
    #[must_use]
    pub fn at(
        tables: &Tables,
        primitive: Ux,
        (u, v): (Fx, Fx),
        width: Fx,
        times: Option<Fx>,
    ) -> Option<Self> {
        let attributes = tables.attributes.as_ref()?;
        let triangles = &tables.triangles;
        let outside = || Place::of(triangles, primitive, u, v, || times).outside;
        let point = Interpolated::met(triangles, attributes, primitive, outside, (u, v), || times);
        Some(Self {
            width: width * point.uv_per_length,
            point,
        })
    }

    /// The shading normals as bent by the maps of materials, as fronts see them;
    /// and which lanes have one.
    #[inline]
    #[must_use]
    pub fn bent(&self, images: &Images, material: Ux) -> (Vec3x, Mask) {
        let rows = material.to_array().map(|m| images.relief[m as usize]);
        let which = Ux::new(rows.map(|r| r.texture));
        let some = !as_mask(which.simd_eq(Ux::splat(NO_TEXTURE)))
            & self.point.uv_per_length.simd_gt(Fx::ZERO);
        if some.none() {
            return (self.point.normal, some);
        }
        let heights = rows.map(|r| if r.heights { u32::MAX } else { 0 });
        let heights = as_mask(Ux::new(heights));
        let strength = Fx::new(rows.map(|r| r.strength));
        let [s, t] = self.point.uv;
        let texel = images.textures.sample(which, [s, t], self.width);
        let mapped = self.point.mapped(texel, strength);
        if (heights & some).none() {
            return (Vec3x::select(some, mapped, self.point.normal), some);
        }
        // Differences over a texel of the level that is read.
        let step = Fx::new(rows.map(|r| r.texel)).fast_max(self.width);
        let height = |uv: [Fx; 2]| images.textures.sample(which, uv, self.width).x;
        let slope = strength / step;
        let bumped = self.point.bumped(
            (height([s + step, t]) - texel.x) * slope,
            (height([s, t + step]) - texel.x) * slope,
        );
        let bent = Vec3x::select(heights, bumped, mapped);
        (Vec3x::select(some, bent, self.point.normal), some)
    }
}

/// The shading normal on the side of omega_o, of a normal as the front sees it; see
/// [`interpolate::towards`](crate::interpolate::towards).
#[inline(always)]
#[must_use]
pub fn facing(bent: Vec3x, front: Mask, geometric: Vec3x, omega_o: Vec3x) -> Vec3x {
    towards(Vec3x::select(front, bent, -bent), geometric, omega_o)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn width(cone: Cone, t: f32, pdf: f32) -> f32 {
        cone.width(Fx::splat(t), Fx::splat(pdf)).as_array()[0]
    }

    #[test]
    fn cones_are_as_wide_as_the_formula_says() {
        let cone = Cone::of_pixels(0.5, 0.02);
        // A quarter of a pixel, at the camera and by distance.
        assert_eq!(width(cone, 0.0, f32::INFINITY), 0.125);
        assert!((width(cone, 100.0, f32::INFINITY) - (0.125 + 0.5)).abs() < 1e-6);
        // A cosine lobe's middle, pdf 1 / pi: half an angle of 1/16, so an eighth of the distance.
        let matt = width(cone, 100.0, INV_PI);
        assert!((matt - 12.5).abs() < 1e-4, "{matt}");
        // A narrow lobe leaves the camera's cone as it is.
        assert_eq!(width(cone, 100.0, 1e9), width(cone, 100.0, f32::INFINITY));
        for pdf in [1e-30, INV_PI, f32::INFINITY] {
            assert_eq!(width(Cone::NONE, 100.0, pdf), 0.0);
        }
    }
}
