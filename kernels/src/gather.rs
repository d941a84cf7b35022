//! Table look-ups, one index a lane.
//!
//! By the processor's gathers where there are some (AVX2): eight loads for the price of a handful of
//! instructions, where lane by lane it is three or four for each. Indices are checked a vector at a
//! time. Tables of more than 2^31 numbers, which those instructions cannot reach, are read lane by lane.

use crate::lanes::{Fx, LANES, Ux};

/// Table look-up, one index a lane.
///
/// # Panics
/// On an index outside the table, in any lane.
#[inline(always)]
#[must_use]
pub fn gather(table: &[f32], index: Ux) -> Fx {
    bytemuck::cast(gather_u32(bytemuck::cast_slice(table), index))
}

/// Table look-up of `u32`, one index a lane.
///
/// # Panics
/// On an index outside the table, in any lane.
#[inline(always)]
#[must_use]
pub fn gather_u32(table: &[u32], index: Ux) -> Ux {
    let [column] = gather_rows(bytemuck::cast_slice::<u32, [u32; 1]>(table), index);
    column
}

/// Row `index` of a table, one index a lane, as one vector a column.
///
/// # Panics
/// On an index outside the table, in any lane.
#[inline(always)]
#[must_use]
pub fn gather_rows<const N: usize>(table: &[[u32; N]], index: Ux) -> [Ux; N] {
    #[cfg(all(target_arch = "x86_64", target_feature = "avx2"))]
    if table.len() <= i32::MAX as usize / N {
        check(table.len(), index);
        // SAFETY: every index is below the table's length, and all its numbers can be reached.
        return unsafe { by_instruction(table, index) };
    }
    let index = index.to_array();
    std::array::from_fn(|k| Ux::new(index.map(|i| table[i as usize][k])))
}

/// # Panics
/// If an index is not below `len`, at most 2^31.
#[cfg(all(target_arch = "x86_64", target_feature = "avx2"))]
#[inline(always)]
fn check(len: usize, index: Ux) {
    let within = index.simd_lt(Ux::splat(len as u32));
    if !crate::lanes::as_mask(within).all() {
        outside(len, index.to_array());
    }
}

#[cfg(all(target_arch = "x86_64", target_feature = "avx2"))]
#[cold]
#[inline(never)]
fn outside(len: usize, index: [u32; LANES]) -> ! {
    panic!("an index of {index:?} is outside a table of {len}");
}

/// # Safety
/// Indices are below the length of `table`, which has no more than 2^31 numbers.
#[cfg(all(target_arch = "x86_64", target_feature = "avx2"))]
#[inline(always)]
unsafe fn by_instruction<const N: usize>(table: &[[u32; N]], index: Ux) -> [Ux; N] {
    use std::arch::x86_64::{__m256i, _mm256_i32gather_epi32};
    let first: __m256i = bytemuck::cast(index * Ux::splat(N as u32));
    std::array::from_fn(|k| {
        let column = table.as_ptr().cast::<i32>().wrapping_add(k);
        // SAFETY: `first` is the place of each row's first number, so that row's number `k` is read.
        bytemuck::cast(unsafe { _mm256_i32gather_epi32::<4>(column, first) })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_come_out_as_columns() {
        let table: Vec<[u32; 3]> = (0..50).map(|i| [i, 100 + i, 200 + i]).collect();
        let index = [49, 0, 7, 7, 31, 2, 48, 1];
        let [a, b, c] = gather_rows(&table, Ux::new(index));
        assert_eq!(a.to_array(), index);
        assert_eq!(b.to_array(), index.map(|i| 100 + i));
        assert_eq!(c.to_array(), index.map(|i| 200 + i));
        let numbers: Vec<f32> = (0..50).map(|i| i as f32 - 20.0).collect();
        let found = gather(&numbers, Ux::new(index)).to_array();
        assert_eq!(found, index.map(|i| i as f32 - 20.0));
    }

    #[test]
    fn an_index_outside_is_refused_in_any_lane() {
        for lane in 0..LANES {
            for bad in [3, 1 << 31, u32::MAX] {
                let mut index = [2; LANES];
                index[lane] = bad;
                let table = [[0; 2]; 3];
                let look = || gather_rows(&table, Ux::new(index));
                assert!(
                    std::panic::catch_unwind(look).is_err(),
                    "{bad} in lane {lane}"
                );
            }
        }
        assert!(std::panic::catch_unwind(|| gather(&[], Ux::ZERO)).is_err());
    }
}
