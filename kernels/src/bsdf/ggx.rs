//! The GGX distribution of facets: density, shadowing and masking, visible normals.
//!
//! With `alpha` the widths along x and y, `m` a facet's normal and `L(w) = |(ax w.x, ay w.y, w.z)|`:
//!
//! * density `D(m) = 1 / (pi ax ay ((m.x/ax)^2 + (m.y/ay)^2 + m.z^2)^2)` (B. Walter et al.,
//!   "Microfacet Models for Refraction through Rough Surfaces", EGSR 2007);
//! * masking `G1(w) = 2 |w.z| / (|w.z| + L(w))`; height-correlated shadowing and masking
//!   `G2 = 2 o.z |i.z| / (o.z L(i) + |i.z| L(o))` (E. Heitz, "Understanding the Masking-Shadowing
//!   Function", JCGT 3(2), 2014). A refraction takes the same `G2`, as pbrt's does: it is symmetric,
//!   and for light that goes straight on it stays above a half, where a product of two `G1` would
//!   fall to nothing at grazing;
//! * visible normals, pdf `D(m) G1(o) (o.m) / o.z`, by a uniform point on a spherical cap (J. Dupuy,
//!   A. Benyoub, "Sampling Visible GGX Normals with Spherical Caps", HPG 2023).
//!
//! Cosines cancel in all products that are used, so that nothing is divided by one: grazing
//! directions are ordinary input.
//!
//! Domain: `alpha` in `[ALPHA_FLOOR, 1]`.

use crate::lanes::Fx;
use crate::math::{INV_PI, sin_cos_turn};
use crate::vec3::Vec3x;

/// The narrowest lobe: below, the smooth kernels are to be chosen. A half vector from directions
/// in f32 is off by a rounding or two, which moves D by a part of `4 x 2^-24 / alpha`: 2.4e-4 here,
/// and that grows as the floor falls, while a lobe of 0.06 degrees is already narrower than a pixel
/// of most pictures.
pub const ALPHA_FLOOR: f32 = 1e-3;

/// Facets of GGX, one distribution a lane.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ggx {
    pub(super) alpha: [Fx; 2],
}

/// What a reflection off the facets is, but for Fresnel's factor.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reflection {
    /// `D G2 / (4 o.z)`: the value for a facet that reflects everything.
    pub(super) value: Fx,
    /// `D G1(o) / (4 o.z)`.
    pub(super) pdf: Fx,
}

impl Ggx {
    /// The same width in all directions.
    #[inline(always)]
    pub(super) fn isotropic(alpha: Fx) -> Self {
        Self {
            alpha: [alpha, alpha],
        }
    }

    /// `L(w)`.
    #[inline(always)]
    pub(super) fn stretched(&self, w: Vec3x) -> Fx {
        let (x, y) = (w.x * self.alpha[0], w.y * self.alpha[1]);
        x.mul_add(x, y.mul_add(y, w.z * w.z)).sqrt()
    }

    /// `D(m)`.
    #[inline(always)]
    pub(super) fn density(&self, m: Vec3x) -> Fx {
        let [ax, ay] = self.alpha;
        let (x, y) = (m.x / ax, m.y / ay);
        let s = x.mul_add(x, y.mul_add(y, m.z * m.z));
        Fx::splat(INV_PI) / (ax * ay * s * s)
    }

    /// `G2 / G1(o)`: the part of the light that the facets let go, after what they let come.
    #[inline(always)]
    pub(super) fn shadowing(&self, o: Vec3x, i: Vec3x) -> Fx {
        let (lo, li, z) = (self.stretched(o), self.stretched(i), i.z.abs());
        z * (o.z + lo) / (o.z * li + z * lo)
    }

    /// Pdf of the normal `m` among those visible from `o`, over normals.
    #[inline(always)]
    pub(super) fn visible(&self, o: Vec3x, m: Vec3x) -> Fx {
        let twice = o.dot(m) * Fx::splat(2.0);
        self.density(m) * twice / (o.z + self.stretched(o))
    }

    /// A normal visible from `o`; unit, with `z > 0`.
    #[inline(always)]
    pub(super) fn sample_normal(&self, o: Vec3x, u: Fx, v: Fx) -> Vec3x {
        let [ax, ay] = self.alpha;
        let s = Vec3x::new(o.x * ax, o.y * ay, o.z).normalized();
        // The cap's point c has c.z even in (-s.z, 1]; s + c is along the normal where facets are
        // a sphere. (1 - c.z)(1 + c.z) is taken without cancellation.
        let up = Fx::ONE + s.z;
        let z = (Fx::ONE - v) * up;
        let below = s.x.mul_add(s.x, s.y * s.y) / up;
        let sin = (v * up * (z + below)).sqrt();
        let (sin_turn, cos_turn) = sin_cos_turn(u);
        let x = sin.mul_add(cos_turn, s.x);
        let y = sin.mul_add(sin_turn, s.y);
        Vec3x::new(x * ax, y * ay, z).normalized()
    }

    /// Reflection from `o` to `i` by facets of normal `m`, the half vector; `o.z, i.z > 0`.
    #[inline(always)]
    pub(super) fn reflection(&self, o: Vec3x, i: Vec3x, m: Vec3x) -> Reflection {
        let half_d = self.density(m) * Fx::splat(0.5);
        let (lo, li) = (self.stretched(o), self.stretched(i));
        Reflection {
            value: half_d * i.z / (o.z * li + i.z * lo),
            pdf: half_d / (o.z + lo),
        }
    }
}

/// `o` mirrored at the plane of normal `m`.
#[inline(always)]
pub(super) fn reflect(o: Vec3x, m: Vec3x) -> Vec3x {
    let cos = o.dot(m);
    m.scale_add(cos + cos, -o)
}

/// The half vector of a reflection; where the directions are opposite to the last bit, z.
#[inline(always)]
pub(super) fn half_vector(o: Vec3x, i: Vec3x) -> Vec3x {
    let h = o + i;
    let square = h.dot(h);
    let sound = square.simd_ge(Fx::splat(f32::MIN_POSITIVE));
    let scale = Fx::ONE / square.sqrt();
    Vec3x::select(sound, h * scale, Vec3x::splat([0.0, 0.0, 1.0]))
}
