//! Rigid motion while the shutter is open: a turn about an axis at constant speed, and a translation
//! at constant speed. Time runs from 0, where the shutter opens, to 1; a ray lives at one moment.
//!
//! **An instance** turns about its own origin `c`: at time `s` a point `p` of the object lies at
//! `c + s v + R(s) A p`, and rays are taken into the object with `B R(s)^T`. With `k` the unit axis and
//! `phi` the angle, `R x = x cos phi + (k x x) sin phi + k (k . x) (1 - cos phi)` (O. Rodrigues, 1840).
//! Traversal and shading both make the map from time alone by [`Motion::placed`], so that they agree to
//! the bit about where things are: where the computed `B(s)` says.
//!
//! **Errors**, `u = 2^-24`: sine and cosine are off by 2 u (`math.rs`), an entry of `R` by less than 16 u
//! with the roundings of the axis, its rows by less than 48 u together; the product with `B` adds
//! `gamma(3)`. So `A(s)` and the inverse of `B(s)` differ by less than `160 u |A| |B|`, the roundings of a
//! still instance included ([`ROUNDINGS`]).
//!
//! **The camera** turns about its own position, after its ray is made.

use crate::instance::Instance;
use crate::lanes::{Fx, LANES, Ux, gather_u32, iota, load, padded, store};
use crate::math::sin_cos_turn;
use crate::queues::PathsMut;
use crate::sampler::{Apart, Sampler, apart};
use crate::vec3::Vec3x;
use std::ops::Range;

/// In `Instance::motion`: it stands still.
pub const STILL: u32 = u32::MAX;

/// Roundings that a point of a moving instance, and what a ray from there sees, is off by.
pub const ROUNDINGS: f32 = 160.0;

/// A motion from time 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// How far it goes, in scene units of the world.
    pub travel: [f32; 3],
    /// The axis that it turns about, a unit vector of the world to rounding.
    pub axis: [f32; 3],
    /// How far it turns, in whole turns, 0 to 1; right-handed.
    pub turns: f32,
}

/// A camera's motion, about where it stands at time 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraMotion {
    /// The motion.
    pub motion: Motion,
    /// The point that it turns about.
    pub pivot: [f32; 3],
}

impl Motion {
    /// Rows of `R(time)`, `time` in `[0, 1]`.
    #[inline]
    #[must_use]
    pub fn rotation(&self, time: f32) -> [[f32; 3]; 3] {
        let (sin, cos) = sin_cos_turn(Fx::splat(self.turns * time));
        let (sin, cos) = (sin.as_array()[0], cos.as_array()[0]);
        let [x, y, z] = self.axis;
        let rest = 1.0 - cos;
        [
            [
                cos + x * x * rest,
                x * y * rest - z * sin,
                x * z * rest + y * sin,
            ],
            [
                y * x * rest + z * sin,
                cos + y * y * rest,
                y * z * rest - x * sin,
            ],
            [
                z * x * rest - y * sin,
                z * y * rest + x * sin,
                cos + z * z * rest,
            ],
        ]
    }

    /// Where `still`, an instance at time 0, is at `time`.
    #[inline]
    #[must_use]
    pub fn placed(&self, still: &Instance, time: f32) -> Instance {
        let turned = self.rotation(time);
        let product = |row: [f32; 3], m: &[[f32; 3]; 3]| -> [f32; 3] {
            std::array::from_fn(|c| row[0] * m[0][c] + row[1] * m[1][c] + row[2] * m[2][c])
        };
        let back = [0, 1, 2].map(|r| turned.map(|row| row[r]));
        Instance {
            to_object: still.to_object.map(|row| product(row, &back)),
            to_world: turned.map(|row| product(row, &still.to_world)),
            origin: std::array::from_fn(|c| still.origin[c] + time * self.travel[c]),
            ..*still
        }
    }

    /// `R(time) v`, a time a lane.
    #[inline(always)]
    fn turn(&self, time: Fx, v: Vec3x) -> Vec3x {
        let (sin, cos) = sin_cos_turn(time * Fx::splat(self.turns));
        let axis = Vec3x::splat(self.axis);
        let along = axis * (axis.dot(v) * (Fx::ONE - cos));
        (axis.cross(v) * sin) + v.scale_add(cos, along)
    }
}

/// Draws the moments of the camera rays at rows `range` of `paths`, and moves the rays of a `camera` that
/// moves. Up to a vector behind them is overwritten.
pub fn open_shutter<S: Sampler>(
    range: Range<usize>,
    sampler: S,
    camera: Option<&CameraMotion>,
    paths: &mut PathsMut,
    times: &mut [f32],
) {
    for i in (0..padded(range.len())).step_by(LANES) {
        let at = range.start + i;
        let row = iota(at as u32);
        let (pixel, sample) = (gather_u32(paths.pixel, row), gather_u32(paths.sample, row));
        let [time, ..] = sampler.draw4(pixel, sample, apart(Ux::ZERO, Apart::Time));
        store(times, at, time);
        if let Some(CameraMotion { motion, pivot }) = camera {
            let vector = |columns: &[&mut [f32]; 3]| {
                let [x, y, z] = columns.each_ref().map(|c| load(c, at));
                Vec3x::new(x, y, z)
            };
            let pivot = Vec3x::splat(*pivot);
            let from = motion.turn(time, vector(&paths.origin) - pivot);
            let origin = from + Vec3x::splat(motion.travel).scale_add(time, pivot);
            origin.store(&mut paths.origin, at);
            let direction = motion.turn(time, vector(&paths.direction)).normalized();
            direction.store(&mut paths.direction, at);
        }
    }
}
