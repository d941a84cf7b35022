//! Compaction: the chosen lanes of a vector moved to its front, in order.
//!
//! A queue is compacted by storing whole vectors at unaligned positions and advancing by the
//! number of lanes kept; what lies behind the last kept lane is overwritten by the next store, so
//! every column needs one vector of slack behind its capacity.
//!
//! AVX2 has no compress instruction; a table of the 256 permutations (8 KiB, in L1 while a stage
//! runs) feeds the variable lane permutation instead. With AVX-512 in the build target the
//! compiler already picks `vpermd` on 256-bit registers; `vpcompressd` was not measured yet.

use crate::lanes::{Fx, LANES, Mask, Ux, load_u32, store, store_u32};
use crate::vec3::{ColumnsMut, Vec3x};

const PERMUTATIONS: [[u32; LANES]; 1 << LANES] = {
    let mut table = [[0; LANES]; 1 << LANES];
    let mut mask = 0;
    while mask < table.len() {
        let (mut lane, mut front) = (0, 0);
        while lane < LANES {
            if mask >> lane & 1 == 1 {
                table[mask][front] = lane as u32;
                front += 1;
            }
            lane += 1;
        }
        mask += 1;
    }
    table
};

/// Which lanes are kept, ready to be applied to any number of columns.
#[derive(Clone, Copy, Debug)]
pub struct Kept {
    permutation: Ux,
    /// How many lanes are kept.
    pub count: usize,
}

impl Kept {
    /// Keeps the lanes where `mask` is true.
    #[inline(always)]
    #[must_use]
    pub fn new(mask: Mask) -> Self {
        let bits = mask.to_bitmask() as usize & (PERMUTATIONS.len() - 1);
        Self {
            permutation: Ux::new(PERMUTATIONS[bits]),
            count: bits.count_ones() as usize,
        }
    }

    /// Stores the kept lanes of `value` from element `at` on, and unspecified values behind them
    /// up to one whole vector.
    #[inline(always)]
    pub fn store(self, column: &mut [f32], at: usize, value: Fx) {
        let bits: Ux = bytemuck::cast(value);
        store(column, at, bytemuck::cast(bits.shuffle(self.permutation)));
    }

    /// [`Kept::store`] for three columns.
    #[inline(always)]
    pub fn store3(self, columns: &mut ColumnsMut, at: usize, value: Vec3x) {
        self.store(columns[0], at, value.x);
        self.store(columns[1], at, value.y);
        self.store(columns[2], at, value.z);
    }

    /// [`Kept::store`] for `u32`.
    #[inline(always)]
    pub fn store_u32(self, column: &mut [u32], at: usize, value: Ux) {
        store_u32(column, at, value.shuffle(self.permutation));
    }

    /// Moves the kept lanes of the vector at `from` in one column to `at` in another.
    #[inline(always)]
    pub fn move_words(self, source: &[u32], from: usize, target: &mut [u32], at: usize) {
        self.store_u32(target, at, load_u32(source, from));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::{as_mask, iota};

    #[test]
    fn every_mask_keeps_its_lanes_in_order() {
        for bits in 0..1u32 << LANES {
            let lanes: [u32; LANES] =
                std::array::from_fn(|l| if bits >> l & 1 == 1 { u32::MAX } else { 0 });
            let kept = Kept::new(as_mask(Ux::new(lanes)));
            let mut out = [99; LANES];
            kept.store_u32(&mut out, 0, iota(0));
            let expected: Vec<u32> = (0..LANES as u32).filter(|l| bits >> l & 1 == 1).collect();
            assert_eq!(kept.count, expected.len());
            assert_eq!(&out[..kept.count], &expected[..], "mask {bits:b}");
        }
    }
}
