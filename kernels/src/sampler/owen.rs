//! Owen scrambling by a hash, on numbers whose bits are reversed.
//!
//! Owen's nested scrambling flips each bit of a number by a coin that the bits *above* it choose: a
//! random automorphism of the binary tree of dyadic intervals. With the bits reversed that is "each
//! bit is flipped by a function of those below it", which is what additions and multiplications do
//! (S. Laine, T. Karras, "Stratified Sampling for Stochastic Transparency", EGSR 2011; B. Burley,
//! "Practical Hash-based Owen Scrambling", JCGT 9(4), 2020). The steps and constants are those that
//! N. Vegdahl found by optimising how well the coins avalanche ("Building a Better LK Hash", 2021).
//! Unlike there, the factor is a word of its own: for each `x` and factor, the result is then a
//! bijection of `seed`, so a scrambled number is exactly as uniform as its seed.

use crate::lanes::Ux;
use bytemuck::cast;
use wide::i8x32;

/// A random permutation of 32-bit words, chosen by `seed` and `factor`, in which bit `i` of the
/// result is bit `i` of `x` flipped by a function of the bits of `x` below it.
#[inline(always)]
pub(super) fn nested(x: Ux, seed: Ux, factor: Ux) -> Ux {
    let x = x ^ (x * Ux::splat(0x3d20_adea));
    let x = (x + seed) * (factor | Ux::ONE);
    let x = x ^ (x * Ux::splat(0x0552_6c56));
    x ^ (x * Ux::splat(0x53a2_2864))
}

/// The same, composed with the flips that take 0 back to 0. A number below 2^-k of the range stays
/// below it: read from the other end, the first 2^k indices are permuted among themselves.
///
/// Those flips are the same for all `x`, and a sequence of points that is scrambled afterwards does
/// not notice them: the exclusive-or of a Sobol sequence's index moves all its points by the same
/// exclusive-or, which Owen scrambling absorbs. So nothing is lost by them, and small indices stay
/// small, which the Sobol matrices are glad of.
#[inline(always)]
pub(super) fn nested_from_zero(x: Ux, seed: Ux, factor: Ux) -> Ux {
    nested(x, seed, factor) ^ nested(Ux::ZERO, seed, factor)
}

/// The bits in reverse order.
#[inline(always)]
pub(super) fn reverse(x: Ux) -> Ux {
    const NIBBLES: [i8; 16] = [0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3, 11, 7, 15];
    const LOW: [i8; 32] = {
        let mut table = [0; 32];
        let mut i = 0;
        while i < 32 {
            table[i] = NIBBLES[i % 16];
            i += 1;
        }
        table
    };
    const HIGH: [i8; 32] = {
        let mut table = [0; 32];
        let mut i = 0;
        while i < 32 {
            table[i] = NIBBLES[i % 16] << 4;
            i += 1;
        }
        table
    };
    const BYTES: [i8; 32] = {
        let mut table = [0; 32];
        let mut i = 0;
        while i < 32 {
            // Of each half of 16 bytes, as the instruction counts.
            table[i] = (i % 16) as i8 ^ 3;
            i += 1;
        }
        table
    };
    let nibbles = Ux::splat(0x0f0f_0f0f);
    let look_up = |table, at| i8x32::new(table).swizzle_half_relaxed(cast::<Ux, i8x32>(at));
    let bytes = look_up(HIGH, x & nibbles) | look_up(LOW, (x >> 4) & nibbles);
    cast(bytes.swizzle_half_relaxed(i8x32::new(BYTES)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::LANES;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn reverse_reverses(words: [u32; LANES]) {
            let expected = words.map(u32::reverse_bits);
            prop_assert_eq!(reverse(Ux::new(words)).to_array(), expected);
        }

        /// The definition: words that agree in their lowest k bits and differ in the next leave with
        /// agreeing lowest k bits, and differ in the next.
        #[test]
        fn bits_depend_on_those_below_them_only(x: u32, seed: u32, factor: u32, other: u32, k in 0..32u32) {
            let splat = Ux::splat;
            let y = x ^ (1 << k) ^ (other.unbounded_shl(k + 1));
            let at = |x| nested(splat(x), splat(seed), splat(factor)).to_array()[0];
            prop_assert_eq!((at(x) ^ at(y)).trailing_zeros(), k);
            let zero = |x| nested_from_zero(splat(x), splat(seed), splat(factor)).to_array()[0];
            prop_assert_eq!(zero(0), 0);
            prop_assert_eq!(zero(x).trailing_zeros(), x.trailing_zeros());
        }
    }
}
