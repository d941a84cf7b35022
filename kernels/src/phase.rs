//! Scattering in media: the phase function of L. Henyey and J. Greenstein, "Diffuse radiation in the
//! galaxy", Astrophysical Journal 93, 1941.
//!
//! With `c` the cosine between the direction that light had and the one it goes on in (forward: 1),
//! `p(c) = (1 - g^2) / (4 pi (1 + g^2 - 2 g c)^(3/2))`, per steradian; it integrates to 1, its mean
//! cosine is `g`, and it is drawn exactly, so that the weight of a sample is 1 and its pdf is the
//! value.
//!
//! The usual inversion divides by `g`. With `s = 2u - 1` it is, without that,
//!
//! * `1 - c = (1 - s) (1 - g)^2 (1 + g (1 + s) / 2) / (1 + g s)^2`,
//! * `1 + c = (1 + s) (1 + g)^2 (1 - g (1 - s) / 2) / (1 + g s)^2`,
//!
//! in which nothing cancels, so that isotropic media (`g = 0`) are ordinary input and peaks are exact.
//!
//! Domain: `|g| <= G_LIMIT`; `u` in `[0, 1 - 2^-24]`; unit vectors.

use crate::hemisphere::to_world;
use crate::lanes::Fx;
use crate::math::{INV_PI, sin_cos_turn};
use crate::vec3::Vec3x;

/// The largest `|g|`: beyond, a peak is narrower than what directions in f32 tell apart well (half of
/// it lies within `1.7 (1 - g)` radians).
pub const G_LIMIT: f32 = 0.999;

/// A phase function a lane.
#[derive(Clone, Copy, Debug)]
pub struct HenyeyGreenstein {
    /// Mean cosine.
    pub g: Fx,
}

impl HenyeyGreenstein {
    /// Value and pdf of going on along `i`, `o` pointing to where the path came from.
    #[inline(always)]
    #[must_use]
    pub fn pdf(&self, o: Vec3x, i: Vec3x) -> Fx {
        // 1 - c and 1 + c, from the sum and the difference of unit vectors.
        let (ahead, back) = (o + i, i - o);
        let half = Fx::splat(0.5);
        self.value(ahead.dot(ahead) * half, back.dot(back) * half)
    }

    /// A direction, and its pdf.
    #[inline(always)]
    #[must_use]
    pub fn sample(&self, o: Vec3x, u: [Fx; 2]) -> (Vec3x, Fx) {
        let (g, one, half) = (self.g, Fx::ONE, Fx::splat(0.5));
        // 1 - s and 1 + s, exactly.
        let (to_one, from_one) = ((one - u[0]) + (one - u[0]), u[0] + u[0]);
        let turned = one / g.mul_add(from_one - one, one);
        let (less, more) = ((one - g) * turned, (one + g) * turned);
        let below = to_one * less * less * (g * half).mul_add(from_one, one);
        let above = from_one * more * more * (g * half).mul_neg_add(to_one, one);
        let sin = (below * above).sqrt();
        let (y, x) = sin_cos_turn(u[1]);
        // The smaller of the two has the cosine without cancellation.
        let cos = below.simd_lt(above).select(one - below, above - one);
        let direction = to_world(-o, Vec3x::new(sin * x, sin * y, cos));
        (direction, self.value(below, above))
    }

    /// From `1 - c` and `1 + c`. `1 + g^2 - 2 g c` is `(1 - g)^2 + 2 g (1 - c)`, and with both signs
    /// turned the same; one of the two has no difference in it.
    #[inline(always)]
    fn value(&self, below: Fx, above: Fx) -> Fx {
        let (g, one) = (self.g, Fx::ONE);
        let away = g.simd_lt(Fx::ZERO).select(above, below);
        let size = g.abs();
        let least = one - size;
        let square = (size + size).mul_add(away, least * least);
        let scale = least * (one + size) * Fx::splat(0.25 * INV_PI);
        scale / (square * square.sqrt())
    }
}
