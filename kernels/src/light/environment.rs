//! Environment maps: radiance from every direction, in equirectangular form, and directions drawn
//! by it.
//!
//! *Radiance*: bilinear between the centres of `width x height` texels, the left edge joined to the
//! right one, the rows at the poles repeated beyond them. In the map's frame (x to the right of its
//! middle, y up, z backwards) a unit direction is at
//!
//! ```text
//! u = 1/2 + atan2(x, -z) / (2 pi)    v = atan2(sqrt(x^2 + z^2), y) / pi
//! ```
//!
//! *Directions*: the sphere is cut into `columns x rows` cells, of equal angles both ways. A row is
//! drawn from its distribution, a column from the row's (the marginal and conditional distributions
//! of *PBRT* 4th ed., A.5.5), and a direction uniformly over the cell: uniformly in longitude and in
//! `cos(theta)` (Archimedes). Inverting distributions, unlike an alias table, keeps neighbouring
//! numbers together, and with them what a sampler's points gain over independent ones.
//!
//! *Exactness*: distributions are whole numbers of 2^-24, the very grid of the random numbers, so
//! the probability of a cell is exactly what the table says; whoever builds one gives each cell that
//! can shine at least one unit. What is left of a number within its unit comes from `spare`.
//!
//! Pdf in solid angle: the cell's probability over its solid angle, `columns / (2 pi (cos(theta_0) -
//! cos(theta_1)))` times it. Bytes a look-up: 52; a draw: up to `4 log2(columns rows) + 24`.

use crate::lanes::{Fx, Ux, as_bits, as_mask, gather, gather_u32, to_f32, to_u32};
use crate::math::{INV_PI, sin_cos_turn};
use crate::vec3::Vec3x;

/// The unit of probability: `2^-24`.
pub const UNITS: u32 = 1 << 24;

/// An environment map as kernels see it.
#[derive(Clone, Copy, Debug)]
pub struct Environment<'a> {
    /// Texels across, at least 1, below 2^16.
    pub width: u32,
    /// Texels down, at least 1, below 2^16.
    pub height: u32,
    /// Radiance of each texel, by rows from straight up.
    pub texels: &'a [[f32; 3]],
    /// The map's axes in the world: rightwards of its middle, up, and against its middle.
    pub frame: [[f32; 3]; 3],
    /// Cells across.
    pub columns: u32,
    /// Cells down.
    pub rows: u32,
    /// Cumulated probabilities of rows in [`UNITS`]: 0 first, [`UNITS`] last; `rows + 1` of them.
    pub marginal: &'a [u32],
    /// The same of the cells of each row; `columns + 1` a row.
    pub conditional: &'a [u32],
    /// `cos(theta)` of the rows' edges: from 1 to -1, `rows + 1` of them.
    pub cosines: &'a [f32],
    /// Pdf per solid angle of each cell's directions.
    pub density: &'a [f32],
}

/// The last of `n` entries of `table` from `start` on that is at most `value`; the first one is.
#[inline(always)]
fn last_at_most(table: &[u32], start: Ux, n: u32, value: Ux) -> Ux {
    let mut found = start;
    let mut size = n;
    while size > 1 {
        let half = size / 2;
        let probe = found + Ux::splat(half);
        let beyond = value.simd_lt(gather_u32(table, probe));
        found = beyond.select(found, probe);
        size -= half;
    }
    found
}

/// Draws one of `n` intervals, whose `n + 1` bounds start at `start`; its index in the table, and a
/// number in `[0, 1]` that is uniform within it.
#[inline(always)]
fn invert(table: &[u32], start: Ux, n: u32, u: Fx, spare: Fx) -> (Ux, Fx) {
    let unit = to_u32(u * Fx::splat(UNITS as f32));
    let at = last_at_most(table, start, n, unit);
    let low = gather_u32(table, at);
    let size = gather_u32(table, at + Ux::ONE) - low;
    (at, (to_f32(unit - low) + spare) / to_f32(size))
}

impl Environment<'_> {
    /// Draws unit directions; `u`, `v` and `spare` in `[0, 1)`. With them, the radiance from there
    /// and the pdf in solid angle.
    #[inline(always)]
    #[must_use]
    pub fn sample(&self, u: Fx, v: Fx, spare: Fx) -> (Vec3x, Vec3x, Fx) {
        let (row, within) = invert(self.marginal, Ux::splat(0), self.rows, v, spare);
        let [top, bottom] = [row, row + Ux::ONE].map(|r| gather(self.cosines, r));
        let cos = (bottom - top).mul_add(within, top);
        let start = row * Ux::splat(self.columns + 1);
        // Another part of the spare number: its bits below the twelfth.
        let finer = spare * Fx::splat(4096.0);
        let finer = finer - finer.floor();
        let (at, within) = invert(self.conditional, start, self.columns, u, finer);
        let column = at - start;
        let turn = (to_f32(column) + within) * Fx::splat(1.0 / self.columns as f32);
        let turn = turn.fast_min(Fx::ONE);
        let sin = ((Fx::ONE - cos) * (Fx::ONE + cos))
            .fast_max(Fx::ZERO)
            .sqrt();
        let (s, c) = sin_cos_turn(turn);
        // At u = 1/2 straight ahead, -z; at 3/4 to the right, +x.
        let [x, y, z] = self.frame.map(Vec3x::splat);
        let direction = x.scale_add(-(sin * s), y.scale_add(cos, z * (sin * c)));
        let down = sin.atan2(cos) * Fx::splat(INV_PI);
        let cell = row * Ux::splat(self.columns) + column;
        let pdf = gather(self.density, cell);
        // The polynomials' sine and cosine are off by up to 1.2e-7 each; directions are unit vectors
        // to rounding.
        (direction.normalized(), self.radiance(turn, down), pdf)
    }

    /// The radiance from unit directions, and the pdf with which [`Self::sample`] draws them.
    #[inline(always)]
    #[must_use]
    pub fn look_up(&self, direction: Vec3x) -> (Vec3x, Fx) {
        let [x, y, z] = self.frame.map(|axis| Vec3x::splat(axis).dot(direction));
        let half = Fx::splat(0.5);
        let u = x.atan2(-z).mul_add(half * Fx::splat(INV_PI), half);
        let v = x.mul_add(x, z * z).sqrt().atan2(y) * Fx::splat(INV_PI);
        let cell = |at: Fx, n: u32| to_u32(at * Fx::splat(n as f32)).min(Ux::splat(n - 1));
        let cell = cell(v, self.rows) * Ux::splat(self.columns) + cell(u, self.columns);
        (self.radiance(u, v), gather(self.density, cell))
    }

    /// Bilinear at `(u, v)`, each in `[0, 1]`.
    #[inline(always)]
    fn radiance(&self, u: Fx, v: Fx) -> Vec3x {
        let (width, height) = (Ux::splat(self.width), Ux::splat(self.height));
        let half = Fx::splat(0.5);
        // From the centre of the texel left of the first one.
        let x = u.mul_add(Fx::splat(self.width as f32), half);
        let left = to_u32(x);
        let dx = x - to_f32(left);
        // `left` is 0 for the column left of the first, `width` for the last one.
        let wrap = |k: Ux| as_bits(as_mask(k.simd_lt(width))).select(k, k - width);
        let (left, right) = (wrap(left + width - Ux::ONE), wrap(left));
        let y = v.mul_add(Fx::splat(self.height as f32), half);
        let above = to_u32(y);
        let dy = y - to_f32(above);
        let last = height - Ux::ONE;
        let (above, below) = (above.max(Ux::ONE) - Ux::ONE, above.min(last));
        let above = above.min(last);
        let mix = |row: Ux| {
            let a = Vec3x::gather(self.texels, row * width + left);
            let b = Vec3x::gather(self.texels, row * width + right);
            (b - a).scale_add(dx, a)
        };
        let (a, b) = (mix(above), mix(below));
        (b - a).scale_add(dy, a)
    }
}
