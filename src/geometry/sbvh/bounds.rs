//! A box in one vector, so that the hot loops of the builder are one instruction a box: the lower
//! corner negated, and the upper corner. The union of two boxes is then the larger of each lane,
//! and their intersection the smaller.
//!
//! Lanes 3 and 7 belong to whoever stores something there; no operation reads them.

use bytemuck::{Pod, Zeroable};
use huygens_kernels::bvh::BLOCK;
use obvhs::aabb::Aabb;
use wide::{f32x4, f32x8, i32x4};

/// `-min x, -min y, -min z, any, max x, max y, max z, any`.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(transparent)]
pub(super) struct Bounds(pub(super) f32x8);

impl Bounds {
    /// The box of nothing: what it is united with stays as it is.
    pub(super) const EMPTY: Self = Self(f32x8::new([f32::NEG_INFINITY; 8]));

    /// The box of one point.
    pub(super) fn point(p: [f32; 3]) -> Self {
        // Anything may stand in the last lanes. For a zero there the compiler uses an encoding of `vmovq`
        // that valgrind 3.19 does not know, and the gate on instructions runs under valgrind.
        let [x, y, z] = p;
        let high = f32x4::new([x, y, z, z]);
        Self(bytemuck::cast([-high, high]))
    }

    #[inline(always)]
    #[must_use]
    pub(super) fn union(self, other: Self) -> Self {
        Self(self.0.fast_max(other.0))
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

    /// As [`Self::half_area`] of each, to the last bit.
    #[inline(always)]
    pub(super) fn half_areas(boxes: [Self; 4]) -> f32x4 {
        let columns = f32x4::transpose(boxes.map(Self::extent));
        let [x, y, z, _] = columns.map(|extent| extent.fast_max(f32x4::ZERO));
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

/// Blocks that so many references take; infinitely many for none, so that no box of nothing seems cheap:
/// its area times these is not a number, or infinite.
#[inline(always)]
pub(super) fn blocks(counts: i32x4) -> f32x4 {
    const { assert!(BLOCK.is_power_of_two()) };
    let blocks = (counts + i32x4::splat(BLOCK as i32 - 1)) >> BLOCK.ilog2() as i32;
    let none: f32x4 = bytemuck::cast(counts.simd_lt(i32x4::ONE));
    none.select(f32x4::splat(f32::INFINITY), blocks.round_float())
}

/// The least of many costs, four at a time, and the number that goes with it; of equal ones the one
/// with the least number.
pub(super) struct Least {
    costs: f32x4,
    numbers: i32x4,
}

impl Least {
    pub(super) fn new() -> Self {
        Self {
            costs: f32x4::splat(f32::INFINITY),
            numbers: i32x4::ZERO,
        }
    }

    /// Considers four costs numbered from `first` on, which grows from call to call. What is no number
    /// is not less.
    #[inline(always)]
    pub(super) fn consider(&mut self, costs: f32x4, first: usize) {
        let less = costs.simd_lt(self.costs);
        let numbers = i32x4::splat(first as i32) + i32x4::new([0, 1, 2, 3]);
        self.costs = less.select(costs, self.costs);
        self.numbers = bytemuck::cast::<f32x4, i32x4>(less).select(numbers, self.numbers);
    }

    /// Cost and number, if one was less than infinity.
    #[inline(always)]
    pub(super) fn get(&self) -> Option<(f32, usize)> {
        let (costs, numbers) = (self.costs.to_array(), self.numbers.to_array());
        // Costs are not negative, so their bits are in their order.
        let key = |i: usize| u64::from(costs[i].to_bits()) << 32 | numbers[i] as u64;
        let least = key(0).min(key(1)).min(key(2).min(key(3)));
        let cost = f32::from_bits((least >> 32) as u32);
        (cost < f32::INFINITY).then_some((cost, least as u32 as usize))
    }
}
