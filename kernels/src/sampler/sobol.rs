//! Owen-scrambled Sobol points, four dimensions at a time.
//!
//! I. M. Sobol, "On the distribution of points in a cube and the approximate evaluation of
//! integrals", 1967, with the direction numbers of S. Joe and F. Kuo ("Constructing Sobol Sequences
//! with Better Two-Dimensional Projections", SIAM J. Sci. Comput. 30(5), 2008), dimensions 1 to 4 of
//! their list. A block is those four dimensions with scramblings of its own and in an order of its
//! own (a nested uniform shuffle of the sample index), so that blocks are independent of each other:
//! *padding*, as in B. Burley, "Practical Hash-based Owen Scrambling", JCGT 9(4), 2020.
//!
//! Of any 2^m samples whose indices start at a multiple of 2^m, each block's points are a
//! (t, m, 4)-net in base 2: dimensions 0 and 1 have t = 0 (every dyadic rectangle of area 2^-m
//! holds one point), 0 and 2 or 1 and 2 have t = 1, 0 and 3 or 1 and 3 have t = 2, and 2 and 3 have
//! t = 3 at most. So the pair that matters most belongs to dimensions 0 and 1. Any number of samples
//! will do, up to 2^32; powers of two are best.

use super::owen::{nested, nested_from_zero, reverse};
use super::{Sampler, pixel_name};
use crate::lanes::{Fx, Ux};
use crate::rng::{scatter, seeds, unit};

/// Owen-scrambled, padded Sobol points; pixels are independent of each other.
#[derive(Clone, Copy, Debug)]
pub struct Sobol {
    /// Two renders with different seeds are independent of each other.
    pub seed: u32,
}

impl Sampler for Sobol {
    #[inline(always)]
    fn pixel(&self, x: Ux, y: Ux) -> Ux {
        pixel_name(x, y)
    }

    #[inline(always)]
    fn draw4(&self, pixel: Ux, sample: Ux, block: Ux) -> [Fx; 4] {
        Seeds::new(pixel, Ux::ZERO, block, self.seed).point(reverse(sample))
    }
}

/// What makes a sequence of scrambled points a random one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seeds {
    dimensions: [Ux; 4],
    /// Of the order of the points.
    pub(super) order: Ux,
}

impl Seeds {
    /// The seeds that belong to three words and the render's seed.
    #[inline(always)]
    pub(super) fn new(a: Ux, b: Ux, block: Ux, seed: u32) -> Self {
        let dimensions = seeds([a, b, block, scatter(Ux::splat(seed))]);
        let [p, q, r, s] = dimensions;
        // Five scramblings need five words and the hash gives four: the fifth is a hash of those.
        let order = scatter((p ^ (r >> 3)) + (q ^ (s << 5)));
        Self { dimensions, order }
    }

    /// The point of an index, whose bits are reversed: number `index` of the shuffled sequence.
    #[inline(always)]
    pub(super) fn point(&self, reversed_index: Ux) -> [Fx; 4] {
        let [p, q, r, s] = self.dimensions;
        let index = reverse(nested_from_zero(reversed_index, self.order, p));
        let [x, y, z, w] = reversed_sobol(index);
        let number = |bits, seed, factor| unit(reverse(nested(bits, seed, factor)));
        [
            number(x, p, q),
            number(y, q, r),
            number(z, r, s),
            number(w, s, self.order),
        ]
    }
}

/// Dimensions 0 to 3 of the Sobol point number `index`, unscrambled, as 32-bit fractions.
#[inline(always)]
#[must_use]
pub fn sobol(index: Ux) -> [Ux; 4] {
    reversed_sobol(index).map(reverse)
}

/// The same with each fraction's bits reversed.
#[inline(always)]
fn reversed_sobol(index: Ux) -> [Ux; 4] {
    // The matrix of dimension 0 reverses the index. That of dimension 1 is Pascal's triangle modulo
    // 2: the fivefold Kronecker power of a 2 x 2 triangle, so five steps multiply with it.
    let mut y = index;
    y ^= y >> 16;
    y ^= (y & Ux::splat(0xff00_ff00)) >> 8;
    y ^= (y & Ux::splat(0xf0f0_f0f0)) >> 4;
    y ^= (y & Ux::splat(0xcccc_cccc)) >> 2;
    y ^= (y & Ux::splat(0xaaaa_aaaa)) >> 1;
    // The others, column by column, as far as any lane's index goes. The bound of the loop lets the
    // compiler drop it where a caller leaves dimensions 2 and 3 unused.
    let (mut z, mut w) = (Ux::ZERO, Ux::ZERO);
    let mut left = index;
    for eight in 0..4 {
        for bit in 8 * eight..8 * eight + 8 {
            let column = Ux::ZERO - (left & Ux::ONE);
            z ^= column & Ux::splat(COLUMNS[0][bit]);
            w ^= column & Ux::splat(COLUMNS[1][bit]);
            left >>= 1;
        }
        if left.simd_eq(Ux::ZERO).all() {
            break;
        }
    }
    [index, y, z, w]
}

/// The generator matrices of dimensions 2 and 3 by columns, lowest bit of the index first, bits
/// reversed. Their polynomials are x^2 + x + 1 and x^3 + x + 1.
const COLUMNS: [[u32; 32]; 2] = [columns(2, 0b1, [1, 3, 0]), columns(3, 0b01, [1, 3, 1])];

/// Columns of a primitive polynomial of `degree` whose inner coefficients are the bits of `inner`,
/// and that many first direction integers (P. Bratley, B. Fox, "Algorithm 659", ACM TOMS 14(1),
/// 1988).
const fn columns(degree: usize, inner: u32, first: [u32; 3]) -> [u32; 32] {
    let mut m = [0u32; 32];
    let mut k = 0;
    while k < 32 {
        m[k] = if k < degree {
            first[k]
        } else {
            let mut sum = m[k - degree] ^ (m[k - degree] << degree);
            let mut j = 1;
            while j < degree {
                if (inner >> (degree - 1 - j)) & 1 == 1 {
                    sum ^= m[k - j] << j;
                }
                j += 1;
            }
            sum
        };
        k += 1;
    }
    let mut k = 0;
    while k < 32 {
        m[k] = (m[k] << (31 - k)).reverse_bits();
        k += 1;
    }
    m
}
