//! Fresnel's equations for unpolarised light, exactly: conductors and dielectrics.
//!
//! * Conductor of index `eta + i k` (relative to the medium outside), from Lagarde, "Memo on Fresnel
//!   Equations", 2013, after E. Hecht, *Optics*: no complex arithmetic, no branch.
//! * Dielectric of relative index `eta` (far side over near side): with `c` the cosine on the near
//!   side, `q = sqrt((eta - 1)(eta + 1) + c^2)` is `eta` times the cosine on the far side, and
//!   `r_s = (c - q) / (c + q)`, `r_p = (eta^2 c - q) / (eta^2 c + q)`. In this form `eta = 1` gives
//!   `q = c` to the bit, so no reflection and no deflection. A negative radicand is total internal
//!   reflection.
//!
//! The metals' indices: see [`Metal`].

use crate::lanes::{Fx, Mask};
use crate::vec3::Vec3x;

/// Reflectance of a conductor; `cos` in `[0, 1]`, `eta >= 0`, `k >= 0`. In `[0, 1]`; 0 for
/// `eta = 1, k = 0`, which is no surface at all.
#[inline(always)]
#[must_use]
pub fn conductor(cos: Fx, eta: Fx, k: Fx) -> Fx {
    let cos = cos.fast_min(Fx::ONE);
    let cos2 = cos * cos;
    let sin2 = (Fx::ONE - cos) * (Fx::ONE + cos);
    let (eta2, k2) = (eta * eta, k * k);
    // eta^2 - k^2 - sin^2, in which eta near 1 and grazing light cancel nothing.
    let t = (eta - Fx::ONE).mul_add(eta + Fx::ONE, cos2) - k2;
    let root = t.mul_add(t, Fx::splat(4.0) * eta2 * k2).sqrt();
    // a^2 = (root + t) / 2, by its other form where t < 0 would cancel.
    let other = Fx::splat(4.0) * eta2 * k2 / (root - t);
    let a2 = t.simd_lt(Fx::ZERO).select(other, root + t) * Fx::splat(0.5);
    let t2 = (a2.fast_max(Fx::ZERO)).sqrt() * (cos + cos);
    let t1 = root + cos2;
    let t3 = cos2.mul_add(root, sin2 * sin2);
    let t4 = t2 * sin2;
    let s = ratio(t1 - t2, t1 + t2);
    let p = s * ratio(t3 - t4, t3 + t4);
    ((s + p) * Fx::splat(0.5)).fast_clamp(Fx::ZERO, Fx::ONE)
}

/// Red, green and blue of [`conductor`].
#[inline(always)]
#[must_use]
pub fn conductor_rgb(cos: Fx, eta: Vec3x, k: Vec3x) -> Vec3x {
    Vec3x::new(
        conductor(cos, eta.x, k.x),
        conductor(cos, eta.y, k.y),
        conductor(cos, eta.z, k.z),
    )
}

/// `a / b`, and 0 for 0 / 0; `b >= 0`.
#[inline(always)]
fn ratio(a: Fx, b: Fx) -> Fx {
    b.simd_gt(Fx::ZERO) & (a / b)
}

/// Light at the boundary of two dielectrics.
#[derive(Clone, Copy, Debug)]
pub struct Dielectric {
    /// Reflectance, in `[0, 1]`; 1 where reflection is total.
    pub reflectance: Fx,
    /// `eta` times the cosine on the far side; 0 where reflection is total.
    pub q: Fx,
    /// Where light can pass.
    pub passes: Mask,
}

/// Reflectance and refraction at a boundary of relative index `eta > 0`, far side over near side;
/// `cos` in `[0, 1]` on the near side.
#[inline(always)]
#[must_use]
pub fn dielectric(cos: Fx, eta: Fx) -> Dielectric {
    let square = (eta - Fx::ONE) * (eta + Fx::ONE);
    let radicand = cos.mul_add(cos, square);
    let passes = radicand.simd_gt(Fx::ZERO);
    // At eta = 1 this is the root of a rounded square, which IEEE rounds to the number itself.
    let q = (passes & radicand).sqrt();
    let p = eta * eta * cos;
    let (s, p) = (ratio(cos - q, cos + q), ratio(p - q, p + q));
    let half = Fx::splat(0.5);
    Dielectric {
        reflectance: passes.select(s.mul_add(s, p * p) * half, Fx::ONE),
        q,
        passes,
    }
}

/// Mean of [`conductor`] over a hemisphere, weighed by the cosine, `2 int F(c) c dc`, by Simpson's
/// rule on 64 intervals in f64: within 1e-6 for the metals here. Set-up, not for kernels.
#[must_use]
pub fn conductor_mean(eta: f64, k: f64) -> f64 {
    const STEPS: usize = 64;
    let at = |step: usize| {
        let cos = step as f64 / STEPS as f64;
        // f32 lanes serve: 1e-6 is theirs too.
        let f = conductor(
            Fx::splat(cos as f32),
            Fx::splat(eta as f32),
            Fx::splat(k as f32),
        );
        2.0 * cos * f64::from(f.as_array()[0])
    };
    let inner: f64 = (1..STEPS).map(|s| [2.0, 4.0][s % 2] * at(s)).sum();
    (at(0) + inner + at(STEPS)) / (3.0 * STEPS as f64)
}

/// A metal that was measured: complex index of refraction in vacuum, for red, green and blue.
///
/// Au, Ag, Cu: P. B. Johnson, R. W. Christy, Phys. Rev. B 6, 4370, 1972. Fe: the same, Phys. Rev. B
/// 9, 5056, 1974. Al: A. D. Rakic, Appl. Opt. 34, 4755, 1995. Each is the mean of the measured
/// `eta(lambda)` and `k(lambda)` (linear between the measurements) over 380 to 730 nm, weighed by
/// the matching function of that primary of sRGB (from CIE 1931, the fit of C. Wyman, P. Sloan,
/// P. Shirley, JCGT 2(2), 2013), itself scaled to integral 1. Reflectances at normal incidence are
/// then within 0.014 of the same mean of the spectral reflectance, except gold's red, which is
/// outside sRGB (1.006) and comes out as 0.968. The test `metals` recomputes them from the tables.
#[derive(Clone, Copy, Debug)]
pub struct Metal {
    /// Chemical symbol.
    pub symbol: &'static str,
    /// Real part of the index.
    pub eta: [f32; 3],
    /// Imaginary part, positive for absorption.
    pub k: [f32; 3],
}

/// The metals that are known by name.
pub const METALS: [Metal; 5] = [
    Metal {
        symbol: "Au",
        eta: [0.1077, 0.4888, 1.4780],
        k: [3.5087, 2.3375, 1.8090],
    },
    Metal {
        symbol: "Ag",
        eta: [0.0554, 0.0547, 0.0427],
        k: [4.2931, 3.5428, 2.5343],
    },
    Metal {
        symbol: "Cu",
        eta: [0.2368, 1.0374, 1.2982],
        k: [3.2438, 2.6012, 2.3525],
    },
    Metal {
        symbol: "Al",
        eta: [1.4411, 0.9884, 0.5852],
        k: [7.5577, 6.5661, 5.3056],
    },
    Metal {
        symbol: "Fe",
        eta: [2.9166, 2.9213, 2.5317],
        k: [3.0649, 2.9394, 2.7418],
    },
];
