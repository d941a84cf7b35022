//! Structures of arrays: one declaration of a queue's columns, from which its views, its names
//! and its byte counts follow.
//!
//! ```
//! use huygens_kernels::soa;
//! soa! {
//!     /// Balls in the air.
//!     pub struct Balls, BallsMut {
//!         /// Where.
//!         position: Vec3,
//!         /// Which.
//!         id: U32,
//!     }
//! }
//! use huygens_kernels::soa::Layout;
//! assert_eq!(BallsMut::WORDS, 4);
//! assert_eq!(BallsMut::COLUMNS, &[("position", 3), ("id", 1)]);
//! ```
//!
//! Every column is made of 32-bit words. A *view* is a struct of slices; the words behind it
//! belong to whoever owns the queue (`huygens::wave::queue`), so this crate allocates nothing.

use crate::tables::SLOTS;

/// The kind of a column: how many words an item has in it, and what its slices look like.
pub trait Column {
    /// Shared view.
    type Ref<'a>: Copy;
    /// Exclusive view.
    type Mut<'a>;
    /// Words an item.
    const WORDS: usize;
    /// Takes `WORDS` columns of words off the front of `words`.
    fn view<'a>(words: &mut impl Iterator<Item = &'a [u32]>) -> Self::Ref<'a>;
    /// Takes `WORDS` columns of words off the front of `words`.
    fn view_mut<'a>(words: &mut impl Iterator<Item = &'a mut [u32]>) -> Self::Mut<'a>;
}

/// A column of `f32`.
#[derive(Clone, Copy, Debug)]
pub struct F32;
/// A column of `u32`.
#[derive(Clone, Copy, Debug)]
pub struct U32;
/// Three columns of `f32`: x, y, z or red, green, blue.
#[derive(Clone, Copy, Debug)]
pub struct Vec3;

/// As many columns of `f32` as a BSDF has parameters.
#[derive(Clone, Copy, Debug)]
pub struct Slots;

const ENOUGH: &str = "as many columns as the layout declares";

impl Column for F32 {
    type Ref<'a> = &'a [f32];
    type Mut<'a> = &'a mut [f32];
    const WORDS: usize = 1;
    #[inline(always)]
    fn view<'a>(words: &mut impl Iterator<Item = &'a [u32]>) -> Self::Ref<'a> {
        bytemuck::cast_slice(words.next().expect(ENOUGH))
    }
    #[inline(always)]
    fn view_mut<'a>(words: &mut impl Iterator<Item = &'a mut [u32]>) -> Self::Mut<'a> {
        bytemuck::cast_slice_mut(words.next().expect(ENOUGH))
    }
}

impl Column for U32 {
    type Ref<'a> = &'a [u32];
    type Mut<'a> = &'a mut [u32];
    const WORDS: usize = 1;
    #[inline(always)]
    fn view<'a>(words: &mut impl Iterator<Item = &'a [u32]>) -> Self::Ref<'a> {
        words.next().expect(ENOUGH)
    }
    #[inline(always)]
    fn view_mut<'a>(words: &mut impl Iterator<Item = &'a mut [u32]>) -> Self::Mut<'a> {
        words.next().expect(ENOUGH)
    }
}

impl Column for Vec3 {
    type Ref<'a> = [&'a [f32]; 3];
    type Mut<'a> = [&'a mut [f32]; 3];
    const WORDS: usize = 3;
    #[inline(always)]
    fn view<'a>(words: &mut impl Iterator<Item = &'a [u32]>) -> Self::Ref<'a> {
        [F32::view(words), F32::view(words), F32::view(words)]
    }
    #[inline(always)]
    fn view_mut<'a>(words: &mut impl Iterator<Item = &'a mut [u32]>) -> Self::Mut<'a> {
        [
            F32::view_mut(words),
            F32::view_mut(words),
            F32::view_mut(words),
        ]
    }
}

impl Column for Slots {
    type Ref<'a> = [&'a [f32]; SLOTS];
    type Mut<'a> = [&'a mut [f32]; SLOTS];
    const WORDS: usize = SLOTS;
    #[inline(always)]
    fn view<'a>(words: &mut impl Iterator<Item = &'a [u32]>) -> Self::Ref<'a> {
        std::array::from_fn(|_| F32::view(words))
    }
    #[inline(always)]
    fn view_mut<'a>(words: &mut impl Iterator<Item = &'a mut [u32]>) -> Self::Mut<'a> {
        std::array::from_fn(|_| F32::view_mut(words))
    }
}

/// A set of columns, as [`soa!`](macro@crate::soa) declares it.
pub trait Layout {
    /// Shared view of all columns.
    type View<'a>;
    /// Exclusive view of all columns.
    type ViewMut<'a>;
    /// Name and words of each column, in order.
    const COLUMNS: &'static [(&'static str, usize)];
    /// Words an item, all columns together; four bytes each.
    const WORDS: usize;
    /// A view over `WORDS` columns of words.
    fn view<'a>(words: impl Iterator<Item = &'a [u32]>) -> Self::View<'a>;
    /// A view over `WORDS` columns of words.
    fn view_mut<'a>(words: impl Iterator<Item = &'a mut [u32]>) -> Self::ViewMut<'a>;
}

/// Declares a queue's columns: `struct View, ViewMut { name: Kind, … }` with kinds
/// [`F32`](crate::soa::F32), [`U32`](crate::soa::U32), [`Vec3`](crate::soa::Vec3) and
/// [`Slots`](crate::soa::Slots). The second
/// struct is the [`Layout`](crate::soa::Layout) by which an owner names the queue.
#[macro_export]
macro_rules! soa {
    (
        $(#[$meta:meta])*
        pub struct $View:ident, $ViewMut:ident {
            $( $(#[$column_meta:meta])* $column:ident: $Kind:ident, )*
        }
    ) => {
        $(#[$meta])*
        ///
        /// Shared view: slices of one length.
        #[derive(Clone, Copy, Debug)]
        pub struct $View<'a> {
            $( $(#[$column_meta])* pub $column: <$crate::soa::$Kind as $crate::soa::Column>::Ref<'a>, )*
        }

        $(#[$meta])*
        ///
        /// Exclusive view: slices of one length.
        #[derive(Debug)]
        pub struct $ViewMut<'a> {
            $( $(#[$column_meta])* pub $column: <$crate::soa::$Kind as $crate::soa::Column>::Mut<'a>, )*
        }

        impl $crate::soa::Layout for $ViewMut<'static> {
            type View<'a> = $View<'a>;
            type ViewMut<'a> = $ViewMut<'a>;
            const COLUMNS: &'static [(&'static str, usize)] =
                &[$( (stringify!($column), <$crate::soa::$Kind as $crate::soa::Column>::WORDS), )*];
            const WORDS: usize = 0 $( + <$crate::soa::$Kind as $crate::soa::Column>::WORDS )*;
            #[inline(always)]
            fn view<'a>(mut words: impl Iterator<Item = &'a [u32]>) -> $View<'a> {
                $View { $( $column: <$crate::soa::$Kind as $crate::soa::Column>::view(&mut words), )* }
            }
            #[inline(always)]
            fn view_mut<'a>(mut words: impl Iterator<Item = &'a mut [u32]>) -> $ViewMut<'a> {
                $ViewMut { $( $column: <$crate::soa::$Kind as $crate::soa::Column>::view_mut(&mut words), )* }
            }
        }
    };
}
