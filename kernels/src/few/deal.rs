//! Dealing rays into vectors whose lanes share their main axis.

use super::{Columns, Fx, Kept, LANES, MAX_VERTICES, Mask, Sheared, Ux, Visitor};
use super::{as_mask, first, iota, load_u32, normalize_exponent, store_u32};

/// Eight rays with the same main axis.
pub(super) struct Eight {
    /// Their places in the view; unused lanes repeat the first.
    pub(super) id: Ux,
    /// Lanes in use.
    pub(super) used: usize,
    /// First, second, main.
    pub(super) axes: [usize; 3],
    /// Along the axes first, second, main.
    pub(super) origin: [Fx; 3],
    /// The direction's first and second component over its main one.
    pub(super) slope: [Fx; 2],
    /// 1 over its main component.
    pub(super) inverse: Fx,
    /// Callers' distances over the kernel's: powers of two, whose reciprocals are numbers too.
    scale: Scale,
}

/// The power of two that took the largest component of each direction to [1, 2).
enum Scale {
    /// One that is a normal `f32`, as is its reciprocal: products with it round as those in f64 do.
    Lanes(Fx),
    /// Any, the same for all.
    Single(f64),
}

impl Eight {
    #[inline(always)]
    fn new(
        id: Ux,
        used: usize,
        axes: [usize; 3],
        origin: [Fx; 3],
        direction: [Fx; 3],
        scale: Scale,
    ) -> Self {
        Self {
            id,
            used,
            axes,
            origin,
            slope: [direction[0] / direction[2], direction[1] / direction[2]],
            inverse: Fx::ONE / direction[2],
            scale,
        }
    }

    /// Ray `i` in every lane, one of them in use; `None` if it can meet nothing.
    pub(super) fn of_one(origin: Columns, direction: Columns, i: usize) -> Option<Self> {
        let (d, scale) = normalize_exponent(direction.map(|column| column[i]))?;
        let main = crate::triangle::main_axis(d);
        let axes = [(main + 1) % 3, (main + 2) % 3, main];
        Some(Self::new(
            Ux::splat(i as u32),
            1,
            axes,
            axes.map(|a| Fx::splat(origin[a][i])),
            axes.map(|a| Fx::splat(d[a])),
            Scale::Single(scale),
        ))
    }

    /// Distances in callers' units, in the range of `f32`.
    #[inline(always)]
    pub(super) fn outward(&self, t: Fx) -> Fx {
        let t = match self.scale {
            Scale::Lanes(scale) => t * scale,
            Scale::Single(scale) => Fx::new(t.to_array().map(|t| (f64::from(t) * scale) as f32)),
        };
        t.fast_max(Fx::splat(f32::from_bits(1)))
            .fast_min(Fx::splat(f32::MAX))
    }

    /// Callers' distances in the kernel's unit.
    #[inline(always)]
    pub(super) fn inward(&self, t: Fx) -> Fx {
        match self.scale {
            Scale::Lanes(scale) => t / scale,
            Scale::Single(scale) => Fx::new(t.to_array().map(|t| (f64::from(t) / scale) as f32)),
        }
    }
}

/// Rays dealt before hands are played.
const HAND: usize = 128;
/// What a hand holds: a whole deal, what was left of the one before, and the slack of compaction.
const ROOM: usize = HAND + 2 * LANES;
/// Columns of a hand: place, origin, direction, scale, and the visitor's words.
const COLUMNS: usize = 8 + 3;

/// Rays of one main axis, compacted.
struct Hand {
    columns: [[u32; ROOM]; COLUMNS],
    len: usize,
}

impl Hand {
    #[inline(always)]
    fn take(&mut self, kept: Kept, columns: &[Ux]) {
        for (own, column) in self.columns.iter_mut().zip(columns) {
            kept.store_u32(own, self.len, *column);
        }
        self.len += kept.count;
    }

    /// Plays all full vectors, or everything if `all`; the rest moves to the front.
    #[inline(always)]
    fn play<V: Visitor>(&mut self, main: usize, all: bool, visitor: &mut V, sheared: &mut Sheared) {
        let axes = [(main + 1) % 3, (main + 2) % 3, main];
        let end = if all {
            self.len
        } else {
            self.len / LANES * LANES
        };
        for start in (0..end).step_by(LANES) {
            let used = (end - start).min(LANES);
            if used < LANES {
                // Unused lanes repeat the first: any ray will do that is one.
                for column in &mut self.columns {
                    let first = column[start];
                    column[start + used..start + LANES].fill(first);
                }
            }
            let word = |c: usize| load_u32(&self.columns[c], start);
            let number = |c: usize| -> Fx { bytemuck::cast(word(c)) };
            let eight = Eight::new(
                word(0),
                used,
                axes,
                axes.map(|a| number(1 + a)),
                axes.map(|a| number(4 + a)),
                Scale::Lanes(number(7)),
            );
            visitor.visit(&eight, [word(8), word(9), word(10)], sheared);
        }
        for column in &mut self.columns {
            let rest = load_u32(column, end);
            store_u32(column, 0, rest);
        }
        self.len -= end;
    }
}

/// Deals the rays that can meet anything into eights of one main axis.
pub(super) fn deal<V: Visitor>(len: usize, origin: Columns, direction: Columns, visitor: &mut V) {
    let mut hands: [Hand; 3] = std::array::from_fn(|_| Hand {
        columns: [[0; ROOM]; COLUMNS],
        len: 0,
    });
    let mut sheared = [[Fx::ZERO; 3]; MAX_VERTICES];
    for start in (0..len).step_by(HAND) {
        let end = len.min(start + HAND);
        for i in (start..end).step_by(LANES) {
            let o = origin.map(|column| Fx::new(load_part(column, i)));
            let d = direction.map(|column| Fx::new(load_part(column, i)));
            let [x, y, z] = d.map(Fx::abs);
            let largest = x.fast_max(y.fast_max(z));
            let exponent: Ux = bytemuck::cast::<Fx, Ux>(largest) >> 23_u32;
            let normal = exponent.simd_gt(Ux::splat(0)) & exponent.simd_lt(Ux::splat(254));
            // A finite number times 0 is 0, any other is NaN, and so is a sum with a NaN in it.
            let zero = o
                .iter()
                .chain(&d)
                .fold(Fx::ZERO, |s, c| c.mul_add(Fx::ZERO, s));
            let finite = first(end - i) & zero.simd_eq(Fx::ZERO);
            let usable = finite & as_mask(normal);
            let scale: Fx = bytemuck::cast((Ux::splat(254) - exponent) << 23_u32);
            let d_scaled = d.map(|d| d * scale);
            let word = |x: Fx| -> Ux { bytemuck::cast(x) };
            let words = visitor.words(i);
            let columns = [
                iota(i as u32),
                word(o[0]),
                word(o[1]),
                word(o[2]),
                word(d_scaled[0]),
                word(d_scaled[1]),
                word(d_scaled[2]),
                word(scale),
                words[0],
                words[1],
                words[2],
            ];
            // Of equally large components the last is the main one.
            let first_axis = x.simd_gt(y) & x.simd_gt(z);
            let second_axis = !first_axis & y.simd_gt(z);
            let third_axis = !(first_axis | second_axis);
            for (hand, mask) in hands.iter_mut().zip([first_axis, second_axis, third_axis]) {
                let mask: Mask = mask & usable;
                if mask.any() {
                    hand.take(Kept::new(mask), &columns[..8 + V::WORDS]);
                }
            }
            let mut odd = (finite & !as_mask(normal) & largest.simd_gt(Fx::ZERO)).to_bitmask();
            while odd != 0 {
                let lane = odd.trailing_zeros() as usize % LANES;
                odd &= odd - 1;
                odd_one(
                    i + lane,
                    lane,
                    origin,
                    direction,
                    words,
                    visitor,
                    &mut sheared,
                );
            }
        }
        for (main, hand) in hands.iter_mut().enumerate() {
            hand.play(main, end == len, visitor, &mut sheared);
        }
    }
}

/// The vector from element `i` on; 0 for elements that are not there.
#[inline(always)]
pub(crate) fn load_part<T: Copy + Default>(column: &[T], i: usize) -> [T; LANES] {
    match column.get(i..i + LANES) {
        Some(whole) => whole.try_into().expect("one vector"),
        None => std::array::from_fn(|lane| column.get(i + lane).copied().unwrap_or_default()),
    }
}

/// A ray whose direction is so short or so long that its scale is no normal `f32`.
#[cold]
#[inline(never)]
fn odd_one<V: Visitor>(
    i: usize,
    lane: usize,
    origin: Columns,
    direction: Columns,
    words: [Ux; 3],
    visitor: &mut V,
    sheared: &mut Sheared,
) {
    let Some(eight) = Eight::of_one(origin, direction, i) else {
        return;
    };
    let words = words.map(|w| Ux::splat(w.to_array()[lane]));
    visitor.visit(&eight, words, sheared);
}
