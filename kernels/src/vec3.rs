//! Three vectors of lanes: `LANES` points, directions or colours.

use crate::lanes::Ux;
use crate::lanes::{Fx, Mask, gather, gather_rows, load, store};
use std::ops::{Add, AddAssign, Mul, Neg, Sub};

/// One `f32` column for each of x, y and z (or red, green and blue).
pub type Columns<'a> = [&'a [f32]; 3];
/// One writable `f32` column for each of x, y and z (or red, green and blue).
pub type ColumnsMut<'a> = [&'a mut [f32]; 3];

/// `LANES` triples.
#[derive(Clone, Copy, Debug)]
pub struct Vec3x {
    /// First component.
    pub x: Fx,
    /// Second component.
    pub y: Fx,
    /// Third component.
    pub z: Fx,
}

impl Vec3x {
    /// Three components.
    #[inline(always)]
    #[must_use]
    pub const fn new(x: Fx, y: Fx, z: Fx) -> Self {
        Self { x, y, z }
    }

    /// The same triple in every lane.
    #[inline(always)]
    #[must_use]
    pub fn splat(v: [f32; 3]) -> Self {
        Self::new(Fx::splat(v[0]), Fx::splat(v[1]), Fx::splat(v[2]))
    }

    /// Reads the vectors that start at element `i` of each column.
    #[inline(always)]
    #[must_use]
    pub fn load(columns: Columns, i: usize) -> Self {
        Self::new(
            load(columns[0], i),
            load(columns[1], i),
            load(columns[2], i),
        )
    }

    /// Writes the vectors that start at element `i` of each column.
    #[inline(always)]
    pub fn store(self, columns: &mut ColumnsMut, i: usize) {
        store(columns[0], i, self.x);
        store(columns[1], i, self.y);
        store(columns[2], i, self.z);
    }

    /// Row `index` of a table of triples, one index a lane.
    #[inline(always)]
    #[must_use]
    pub fn gather(table: &[[f32; 3]], index: Ux) -> Self {
        let rows: &[[u32; 3]] = bytemuck::cast_slice(table);
        let [x, y, z] = gather_rows(rows, index);
        Self::new(bytemuck::cast(x), bytemuck::cast(y), bytemuck::cast(z))
    }

    /// Row `index` of a table in columns, one index a lane.
    #[inline(always)]
    #[must_use]
    pub fn gather_columns(columns: Columns, index: Ux) -> Self {
        Self::new(
            gather(columns[0], index),
            gather(columns[1], index),
            gather(columns[2], index),
        )
    }

    /// Scalar product.
    #[inline(always)]
    #[must_use]
    pub fn dot(self, o: Self) -> Fx {
        self.x.mul_add(o.x, self.y.mul_add(o.y, self.z * o.z))
    }

    /// Vector product.
    #[inline(always)]
    #[must_use]
    pub fn cross(self, o: Self) -> Self {
        Self::new(
            self.y.mul_sub(o.z, self.z * o.y),
            self.z.mul_sub(o.x, self.x * o.z),
            self.x.mul_sub(o.y, self.y * o.x),
        )
    }

    /// Product component by component.
    #[inline(always)]
    #[must_use]
    pub fn product(self, o: Self) -> Self {
        Self::new(self.x * o.x, self.y * o.y, self.z * o.z)
    }

    /// `self * scale + o`.
    #[inline(always)]
    #[must_use]
    pub fn scale_add(self, scale: Fx, o: Self) -> Self {
        Self::new(
            self.x.mul_add(scale, o.x),
            self.y.mul_add(scale, o.y),
            self.z.mul_add(scale, o.z),
        )
    }

    /// Absolute value of each component.
    #[inline(always)]
    #[must_use]
    pub fn abs(self) -> Self {
        Self::new(self.x.abs(), self.y.abs(), self.z.abs())
    }

    /// The largest component.
    #[inline(always)]
    #[must_use]
    pub fn max_component(self) -> Fx {
        self.x.fast_max(self.y).fast_max(self.z)
    }

    /// True where any component is other than 0: of a radiance, where there is any. No arithmetic, so
    /// that neither signs nor sizes matter; true also where a component is not a number.
    #[inline(always)]
    #[must_use]
    pub fn any_light(self) -> Mask {
        (self.x | self.y | self.z).simd_ne(Fx::ZERO)
    }

    /// Divided by its length. A zero vector gives NaN: mask such lanes.
    #[inline(always)]
    #[must_use]
    pub fn normalized(self) -> Self {
        self * (Fx::ONE / self.dot(self).sqrt())
    }

    /// The lanes where `mask` is true, 0 elsewhere.
    #[inline(always)]
    #[must_use]
    pub fn keep(self, mask: Mask) -> Self {
        Self::new(mask & self.x, mask & self.y, mask & self.z)
    }

    /// `a` where `mask` is true, `b` elsewhere.
    #[inline(always)]
    #[must_use]
    pub fn select(mask: Mask, a: Self, b: Self) -> Self {
        Self::new(
            mask.select(a.x, b.x),
            mask.select(a.y, b.y),
            mask.select(a.z, b.z),
        )
    }

    /// True where all three components are finite.
    #[inline(always)]
    #[must_use]
    pub fn is_finite(self) -> Mask {
        self.x.is_finite() & self.y.is_finite() & self.z.is_finite()
    }

    /// The triple in one lane.
    #[inline(always)]
    #[must_use]
    pub fn lane(self, lane: usize) -> [f32; 3] {
        [
            self.x.as_array()[lane],
            self.y.as_array()[lane],
            self.z.as_array()[lane],
        ]
    }
}

impl Add for Vec3x {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Self::new(self.x + o.x, self.y + o.y, self.z + o.z)
    }
}

impl AddAssign for Vec3x {
    #[inline(always)]
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}

impl Sub for Vec3x {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        Self::new(self.x - o.x, self.y - o.y, self.z - o.z)
    }
}

impl Mul<Fx> for Vec3x {
    type Output = Self;
    #[inline(always)]
    fn mul(self, s: Fx) -> Self {
        Self::new(self.x * s, self.y * s, self.z * s)
    }
}

impl Neg for Vec3x {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(-self.x, -self.y, -self.z)
    }
}
