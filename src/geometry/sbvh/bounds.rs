//! A box in one vector, so that the hot loops of the builder are one instruction a box: the lower
//! corner negated, and the upper corner. The union of two boxes is then the larger of each lane,
//! and their intersection the smaller.
//!
//! Lanes 3 and 7 belong to whoever stores something there; no operation reads them.

use bytemuck::{Pod, Zeroable};
use obvhs::aabb::Aabb;
use wide::{f32x4, f32x8};

/// `-min x, -min y, -min z, any, max x, max y, max z, any`.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(transparent)]
pub(super) struct Bounds(pub(super) f32x8);

impl Bounds {
    /// The box of nothing: what it is united with stays as it is.
    pub(super) const EMPTY: Self = Self(f32x8::new([f32::NEG_INFINITY; 8]));

    /// The box of one point.
    pub(super) fn point(p: [f32; 3]) -> Self {
        let [x, y, z] = p;
        Self(f32x8::new([-x, -y, -z, 0.0, x, y, z, 0.0]))
    }

    #[inline(always)]
    #[must_use]
    pub(super) fn union(self, other: Self) -> Self {
        Self(self.0.fast_max(other.0))
    }

    /// Itself, or the box of nothing if `empty`; without a branch.
    #[inline(always)]
    #[must_use]
    pub(super) fn or_empty(self, empty: bool) -> Self {
        let mask = f32x8::splat(f32::from_bits(u32::from(empty).wrapping_neg()));
        Self(mask.select(Self::EMPTY.0, self.0))
    }

    #[inline(always)]
    #[must_use]
    pub(super) fn intersection(self, other: Self) -> Self {
        Self(self.0.fast_min(other.0))
    }

    /// Extent along x, y, z; below 0 where nothing is inside. The last lane means nothing.
    #[inline(always)]
    pub(super) fn extent(self) -> f32x4 {
        let [low, high]: [f32x4; 2] = bytemuck::cast(self.0);
        low + high
    }

    /// Whether it holds not even a point.
    #[inline(always)]
    pub(super) fn is_empty(self) -> bool {
        self.extent().simd_lt(f32x4::ZERO).to_bitmask() & 7 != 0
    }

    /// Half its surface; of an empty box, 0.
    #[inline(always)]
    pub(super) fn half_area(self) -> f32 {
        let [x, y, z, _] = self.extent().fast_max(f32x4::ZERO).to_array();
        (x + y) * z + x * y
    }

    /// Twice the centre, as the box of that point.
    #[inline(always)]
    #[must_use]
    pub(super) fn twice_centre(self) -> Self {
        let [low, high]: [f32x4; 2] = bytemuck::cast(self.0);
        Self(self.0 - bytemuck::cast::<[f32x4; 2], f32x8>([high, low]))
    }

    /// Lower end along x, y, z.
    #[inline(always)]
    pub(super) fn min(self) -> f32x4 {
        let [low, _]: [f32x4; 2] = bytemuck::cast(self.0);
        -low
    }

    /// Upper end along x, y, z.
    #[inline(always)]
    pub(super) fn max(self) -> f32x4 {
        let [_, high]: [f32x4; 2] = bytemuck::cast(self.0);
        high
    }

    pub(super) fn to_aabb(self) -> Aabb {
        let [low, high] = [self.min(), self.max()].map(f32x4::to_array);
        Aabb::new(
            glam::Vec3A::from_slice(&low[..3]),
            glam::Vec3A::from_slice(&high[..3]),
        )
    }
}
