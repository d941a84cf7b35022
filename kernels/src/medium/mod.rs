//! Homogeneous media: what light loses on its way, and where it is scattered.
//!
//! A medium absorbs `sigma_a` and scatters `sigma_s` of the light along a unit of length, each by red,
//! green and blue; together they are its extinction `sigma_t`. Of light, `T(s) = exp(-sigma_t s)` is left
//! after a length of `s`.
//!
//! **Where a path is.** Each path carries the number of the medium that its ray runs through, a row of
//! [`Media`]: [`OUTSIDE`], which may be bounded by a box, [`CLEAR`], or a medium inside of glass. It is
//! changed where a path passes through a surface, and nowhere else ([`cross`]): each surface of
//! glass says what is behind its front and before it, which is `OUTSIDE` unless it lies in other glass.
//! Media do not overlap.
//!
//! * [`travel`]: how far a ray goes before it is scattered, if it is.
//! * [`attenuate`]: what occlusion rays lose.
//! * [`cross`]: into which medium scattered paths go.
//! * `scatter::medium`: what happens where a ray was scattered.

mod boundary;
mod travel;

pub use boundary::{attenuate, cross};
pub use travel::{TRAVEL, travel};

use crate::lanes::{Fx, Mask, Ux, as_mask, gather};
use crate::vec3::{Columns, Vec3x};

/// The row of what lies outside of all glass.
pub const OUTSIDE: u32 = 0;
/// The row of nothing at all.
pub const CLEAR: u32 = 1;
/// In `interior` of a material: whoever passes stays in the medium where it was, as through a pane.
pub const UNCHANGED: u32 = u32::MAX;

/// What stands in a hit's `primitive` where the ray was scattered before it met anything. No primitive
/// has this number.
pub const IN_MEDIUM: u32 = u32::MAX - 1;

/// Media, a row each. Extinction, scattering and rate are finite and `>= 0`, per unit of length.
#[derive(Clone, Copy, Debug, Default)]
pub struct Media<'a> {
    /// `sigma_t`.
    pub extinction: Columns<'a>,
    /// `sigma_s`, at most `sigma_t`.
    pub scattering: Columns<'a>,
    /// `sigma_t` of media that scatter any light, 0 of others: the density of scattering events that
    /// paths draw.
    pub rate: Columns<'a>,
    /// Mean cosine of the phase function; see `phase` for its domain.
    pub g: &'a [f32],
    /// The box that [`OUTSIDE`] fills, low and high corner; infinite where it has no bounds.
    pub bounds: [[f32; 3]; 2],
    /// By material: the row of what lies behind its surfaces, or [`UNCHANGED`].
    pub interior: &'a [u32],
    /// By material: the row of what lies before its surfaces.
    pub exterior: &'a [u32],
}

/// The part of a ray that runs through its medium.
#[derive(Clone, Copy, Debug)]
struct Reach {
    /// Where it enters: a ray parameter, `>= 0`.
    enter: Fx,
    /// How long it stays, `>= 0`; may be infinite.
    length: Fx,
}

impl Media<'_> {
    /// The part of rays of unit `direction` and the given `length`, which may be infinite, that lies in
    /// their media.
    #[inline(always)]
    fn reach(&self, row: Ux, origin: Vec3x, direction: Vec3x, length: Fx) -> Reach {
        let outside = as_mask(row.simd_eq(Ux::splat(OUTSIDE)));
        let everywhere = (Fx::ZERO, length);
        let (low, high) = self.slab(origin, direction);
        let enter = outside.select(low.fast_max(everywhere.0), everywhere.0);
        let leave = outside.select(high.fast_min(everywhere.1), everywhere.1);
        let meets = enter.simd_lt(leave);
        Reach {
            enter,
            length: meets.select(leave - enter, Fx::ZERO),
        }
    }

    /// Ray parameters at which rays enter and leave the box.
    #[inline(always)]
    fn slab(&self, origin: Vec3x, direction: Vec3x) -> (Fx, Fx) {
        let infinite = Fx::splat(f32::INFINITY);
        let axis = |o: Fx, d: Fx, k: usize| {
            let (low, high) = (Fx::splat(self.bounds[0][k]), Fx::splat(self.bounds[1][k]));
            let over = Fx::ONE / d;
            let (a, b) = ((low - o) * over, (high - o) * over);
            // A ray along the slab is within it all the way or never.
            let along = d.simd_eq(Fx::ZERO);
            let within: Mask = o.simd_ge(low) & o.simd_le(high);
            let enter = within.select(-infinite, infinite);
            (
                along.select(enter, a.fast_min(b)),
                along.select(-enter, a.fast_max(b)),
            )
        };
        let x = axis(origin.x, direction.x, 0);
        let y = axis(origin.y, direction.y, 1);
        let z = axis(origin.z, direction.z, 2);
        (
            x.0.fast_max(y.0).fast_max(z.0),
            x.1.fast_min(y.1).fast_min(z.1),
        )
    }

    /// `T(length)`: what is left of light after this length of medium, which may be infinite.
    #[inline(always)]
    fn transmittance(&self, row: Ux, length: Fx) -> Vec3x {
        let along = |column: &[f32]| falloff(gather(column, row), length);
        let [r, g, b] = self.extinction;
        Vec3x::new(along(r), along(g), along(b))
    }
}

/// `exp(-sigma length)`, both `>= 0` and `length` perhaps infinite; 1 where `sigma` is 0.
#[inline(always)]
fn falloff(sigma: Fx, length: Fx) -> Fx {
    // Beyond, the exponential is 0 in f32; and 0 times infinity is no number.
    const NOTHING_LEFT: f32 = 104.0;
    let depth = sigma.simd_gt(Fx::ZERO).select(sigma * length, Fx::ZERO);
    (-depth.fast_min(Fx::splat(NOTHING_LEFT))).exp()
}
