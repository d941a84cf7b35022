//! The vector types, and the only place that knows their width.
//!
//! [`Fx`] and [`Ux`] are `LANES` values of `f32` and `u32`. A [`Mask`] is an `Fx` whose lanes are
//! all ones (true) or all zeros (false), as `wide`'s comparisons return it.
//!
//! Slices walked by vectors are read and written through [`load`], [`store`] and their `u32`
//! twins, which check bounds once a vector: a kernel that indexes `0..padded(n)` needs slices of
//! at least `padded(n)` elements.

pub use crate::gather::{gather, gather_rows, gather_u32};
pub use wide::{f32x8 as Fx, u32x8 as Ux};

/// Lanes in a vector.
pub const LANES: usize = 8;

/// A vector of booleans: all bits of a lane set, or none.
pub type Mask = Fx;

/// `n` rounded up to a whole number of vectors.
#[inline(always)]
#[must_use]
pub const fn padded(n: usize) -> usize {
    n.next_multiple_of(LANES)
}

/// Reads the vector that starts at element `i`.
#[inline(always)]
#[must_use]
pub fn load(slice: &[f32], i: usize) -> Fx {
    let lanes: &[f32; LANES] = slice[i..i + LANES].try_into().expect("one vector");
    Fx::new(*lanes)
}

/// Reads the vector of `u32` that starts at element `i`.
#[inline(always)]
#[must_use]
pub fn load_u32(slice: &[u32], i: usize) -> Ux {
    let lanes: &[u32; LANES] = slice[i..i + LANES].try_into().expect("one vector");
    Ux::new(*lanes)
}

/// Writes a vector from element `i` on.
#[inline(always)]
pub fn store(slice: &mut [f32], i: usize, value: Fx) {
    slice[i..i + LANES].copy_from_slice(value.as_array());
}

/// Writes a vector of `u32` from element `i` on.
#[inline(always)]
pub fn store_u32(slice: &mut [u32], i: usize, value: Ux) {
    slice[i..i + LANES].copy_from_slice(value.as_array());
}

/// `0, 1, 2, …` plus `start`.
#[inline(always)]
#[must_use]
pub fn iota(start: u32) -> Ux {
    Ux::new(std::array::from_fn(|lane| lane as u32)) + Ux::splat(start)
}

/// True in the lanes below `n`: the lanes of a queue's last, partly filled vector.
#[inline(always)]
#[must_use]
pub fn first(n: usize) -> Mask {
    as_mask(iota(0).simd_lt(Ux::splat(n.min(LANES) as u32)))
}

/// A comparison of `u32` lanes as a [`Mask`].
#[inline(always)]
#[must_use]
pub fn as_mask(compared: Ux) -> Mask {
    bytemuck::cast(compared)
}

/// A [`Mask`] as a comparison of `u32` lanes would have given it.
#[inline(always)]
#[must_use]
pub fn as_bits(mask: Mask) -> Ux {
    bytemuck::cast(mask)
}

/// The lanes of `value` where `mask` is true, 0 elsewhere (also where `value` is not finite).
#[inline(always)]
#[must_use]
pub fn keep(mask: Mask, value: Fx) -> Fx {
    mask & value
}

/// `u32` below 2^24 to `f32`, exactly.
#[inline(always)]
#[must_use]
pub fn to_f32(value: Ux) -> Fx {
    Fx::from_i32x8(bytemuck::cast(value))
}

/// `f32` in `0 ..= 2^31 - 1` to `u32`, towards zero.
#[inline(always)]
#[must_use]
pub fn to_u32(value: Fx) -> Ux {
    bytemuck::cast(value.fast_trunc_int())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn first_covers_exactly_the_lanes_below_n() {
        for n in 0..=LANES + 2 {
            assert_eq!(first(n).to_bitmask(), (1u32 << n.min(LANES)) - 1, "n = {n}");
        }
    }

    #[test]
    fn integers_below_two_to_the_24_survive_the_round_trip() {
        for start in [0u32, 1, 65_535, (1 << 24) - LANES as u32] {
            assert_eq!(
                to_u32(to_f32(iota(start))).to_array(),
                iota(start).to_array()
            );
        }
    }
}
