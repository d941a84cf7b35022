//! Light from spheres: directions uniform over the cone in which a sphere is seen.
//!
//! From distance `d` a sphere of radius `r` fills the cone of `sin = r / d`, `2 pi (1 - cos)` of solid
//! angle; from inside, all of it. With `x = u (1 - cos)`, a direction at `cos theta = 1 - x`,
//! `sin^2 theta = x (2 - x)` is uniform in the cone (P. Shirley, C. Wang, K. Zimmermann, "Monte Carlo
//! Techniques for Direct Lighting Calculations", TOG 15(1), 1996), and
//! `1 - cos = sin^2 / (1 + cos)` loses nothing where the sphere is small and far: so neither does
//! the pdf, `selection / (2 pi (1 - cos))`.
//!
//! *The way there* is `(d^2 - r^2) / (d cos theta + half)`, with `half` of the chord under the root
//! of `r^2 - d^2 sin^2 theta`: no cancellation but that in `d - r`, however near the sphere is.
//!
//! Each sphere has a probability of its own to be selected.

use crate::hemisphere::Frame;
use crate::lanes::{Fx, LANES, Mask, Ux, as_bits, as_mask, gather_u32};
use crate::light::{Departure, LightSample};
use crate::math::{INV_PI, sin_cos_turn};
use crate::others::Others;
use crate::rays::NO_PRIMITIVE;
use crate::sphere;
use crate::surface::{Anchor, gamma};
use crate::tables::Tables;
use crate::vec3::Vec3x;

/// Spheres as they are seen from points.
struct Seen {
    radius: Fx,
    material: Ux,
    selection: Fx,
    /// To the centre.
    way: Vec3x,
    /// Its length.
    distance: Fx,
    inside: Mask,
    /// `1 - cos` of the cone; 2 from inside.
    extent: Fx,
}

impl Seen {
    /// Lanes that hold no sphere stand for the first.
    #[inline(always)]
    fn from(others: &Others, primitive: Ux, point: Vec3x) -> Self {
        let last = others.spheres.len() - 1;
        let index = primitive
            .to_array()
            .map(|p| (p.saturating_sub(others.first) as usize).min(last));
        let (centre, radius) = sphere::gather(others.spheres, index);
        let way = centre - point;
        // By the largest component, so that no square vanishes or overflows.
        let unit = Fx::ONE / way.abs().max_component().fast_max(radius);
        let (to, r) = (way * unit, radius * unit);
        let d2 = to.dot(to);
        let inside = d2.simd_le(r * r);
        let sin2 = inside.select(Fx::ONE, r * r / d2).fast_min(Fx::ONE);
        let cos = (Fx::ONE - sin2).sqrt();
        Self {
            distance: d2.sqrt() / unit,
            radius,
            material: Ux::new(index.map(|i| others.sphere_material[i])),
            selection: Fx::new(index.map(|i| others.sphere_selection[i])),
            way,
            inside,
            extent: inside.select(Fx::splat(2.0), sin2 / (Fx::ONE + cos)),
        }
    }

    /// Pdf in solid angle of any direction that meets the sphere, selection included.
    #[inline(always)]
    fn pdf(&self) -> Fx {
        self.selection * Fx::splat(0.5 * INV_PI) / self.extent
    }
}

/// The pdf in solid angle with which [`sample`] would have found what rays found on spheres.
#[inline(always)]
#[must_use]
pub fn pdf(others: &Others, from: &Departure, primitive: Ux) -> Fx {
    Seen::from(others, primitive, from.origin).pdf()
}

/// Samples the spheres `primitive` as lights for the surfaces `anchor`; of lanes that hold none the
/// result is unspecified. There must be a sphere.
#[must_use]
pub fn sample(
    tables: &Tables,
    others: &Others,
    anchor: &Anchor,
    primitive: Ux,
    u: Fx,
    v: Fx,
) -> LightSample {
    let near = Seen::from(others, primitive, anchor.point);
    let origin = anchor.start(near.way);
    let seen = Seen::from(others, primitive, origin);
    let x = u * seen.extent;
    let cos = Fx::ONE - x;
    let sin2 = (x * (Fx::splat(2.0) - x)).fast_max(Fx::ZERO);
    let (sin_phi, cos_phi) = sin_cos_turn(v);
    let sin = sin2.sqrt();
    let local = Vec3x::new(sin * cos_phi, sin * sin_phi, cos);
    // From the very centre every axis is as good.
    let at_centre = !seen.distance.simd_gt(Fx::ZERO);
    let up = Vec3x::splat([0.0, 0.0, 1.0]);
    let to = seen.way * (Fx::ONE / seen.distance);
    let axis = Vec3x::select(at_centre, up, to);
    let direction = Frame::about(axis).to_world(local);
    // Half the chord, and the way to its nearer end from outside, to its end from inside.
    let (d, r) = (seen.distance, seen.radius);
    let aside = d * sin;
    let half = ((r - aside) * (r + aside)).fast_max(Fx::ZERO).sqrt();
    let along = d * cos;
    let near = (d - r) * (d + r) / (along + half);
    let way = seen.inside.select(along + half, near);
    // So much of it is rounding, of which the sphere's own far side must not come to lie before the
    // end: 2 in the way to the centre, 2 in its length, 8 in the rest.
    let slack = Fx::splat(gamma(16.0)) * (d + r);
    let pdf = seen.pdf();
    let emits = !seen.inside | as_mask(gather_u32(tables.materials.two_sided, seen.material));
    // From inside, the sphere may be what the ray leaves: so that nothing excludes it, the segment
    // ends before it.
    let reaches = as_bits(seen.inside).select(Ux::splat(NO_PRIMITIVE), primitive);
    LightSample {
        origin,
        segment: direction,
        t_max: (way - slack).fast_max(Fx::ZERO),
        primitive: reaches,
        direction,
        radiance: Vec3x::gather_columns(tables.materials.emission, seen.material),
        pdf,
        delta: Fx::ZERO,
        valid: emits & pdf.simd_gt(Fx::ZERO) & pdf.is_finite(),
    }
}

/// Of lights that are spheres in the lanes `spheres` the name that stands for a triangle in all
/// lanes, so that every look-up is in range; none if no lane holds a triangle.
#[inline(always)]
#[must_use]
pub fn triangles_only(primitive: Ux, spheres: Mask) -> Option<Ux> {
    let lane = (!spheres.to_bitmask()).trailing_zeros() as usize;
    (lane < LANES).then(|| {
        let some = Ux::splat(primitive.as_array()[lane]);
        as_bits(spheres).select(some, primitive)
    })
}
