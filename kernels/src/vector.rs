//! What an algorithm that is written once for vectors of several widths needs of them.
//!
//! The triangle test runs with a triangle in every lane (one ray, a block of four) and with a ray in
//! every lane (eight rays, one triangle): the arithmetic is the same, and so are the bits.

use std::ops::{Add, BitAnd, BitOr, Div, Mul, Not, Sub};
use wide::{f32x4, f32x8};

/// A vector of `f32`; comparisons give masks, all bits of a lane set or none.
pub trait Lanes:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + BitAnd<Output = Self>
    + BitOr<Output = Self>
    + Not<Output = Self>
{
    /// The same number in every lane.
    fn splat(x: f32) -> Self;
    /// `self * a + b`, fused.
    fn mul_add(self, a: Self, b: Self) -> Self;
    /// `b - self * a`, fused.
    fn mul_neg_add(self, a: Self, b: Self) -> Self;
    /// Absolute values.
    fn abs(self) -> Self;
    /// The lesser of two, either if one is NaN.
    fn fast_min(self, other: Self) -> Self;
    /// The greater of two, either if one is NaN.
    fn fast_max(self, other: Self) -> Self;
    /// `self < other`.
    fn less(self, other: Self) -> Self;
    /// `self <= other`.
    fn at_most(self, other: Self) -> Self;
    /// Whether a mask is true everywhere.
    fn all(self) -> bool;
    /// The numbers.
    fn lanes(&self) -> &[f32];
    /// The numbers.
    fn lanes_mut(&mut self) -> &mut [f32];
}

macro_rules! lanes {
    ($vector:ty) => {
        impl Lanes for $vector {
            #[inline(always)]
            fn splat(x: f32) -> Self {
                Self::splat(x)
            }
            #[inline(always)]
            fn mul_add(self, a: Self, b: Self) -> Self {
                self.mul_add(a, b)
            }
            #[inline(always)]
            fn mul_neg_add(self, a: Self, b: Self) -> Self {
                self.mul_neg_add(a, b)
            }
            #[inline(always)]
            fn abs(self) -> Self {
                self.abs()
            }
            #[inline(always)]
            fn fast_min(self, other: Self) -> Self {
                self.fast_min(other)
            }
            #[inline(always)]
            fn fast_max(self, other: Self) -> Self {
                self.fast_max(other)
            }
            #[inline(always)]
            fn less(self, other: Self) -> Self {
                self.simd_lt(other)
            }
            #[inline(always)]
            fn at_most(self, other: Self) -> Self {
                self.simd_le(other)
            }
            #[inline(always)]
            fn all(self) -> bool {
                self.all()
            }
            #[inline(always)]
            fn lanes(&self) -> &[f32] {
                self.as_array()
            }
            #[inline(always)]
            fn lanes_mut(&mut self) -> &mut [f32] {
                self.as_mut_array()
            }
        }
    };
}
lanes!(f32x4);
lanes!(f32x8);
