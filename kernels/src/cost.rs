//! What kernels cost, as each kernel's file declares it for one item.
//!
//! Bytes are what a stage streams through its queues and looks up in tables; operations are those on
//! `f32` (a fused one is two, a comparison or selection one), counted from the source to about a
//! fifth: enough for a place on a roofline. What a traversal reads and computes in its tree depends
//! on the ray and is not in it; see `visits`.

use crate::soa::Layout;
use std::ops::{Add, Mul};

/// Bytes and operations.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cost {
    /// Bytes read.
    pub read: u64,
    /// Bytes written.
    pub written: u64,
    /// Operations on `f32`.
    pub operations: u64,
}

impl Cost {
    /// Bytes read and written.
    #[must_use]
    pub const fn new(read: usize, written: usize) -> Self {
        Self {
            read: read as u64,
            written: written as u64,
            operations: 0,
        }
    }

    /// The same with so many operations.
    #[must_use]
    pub const fn operations(self, operations: u64) -> Self {
        Self { operations, ..self }
    }
}

/// Both together.
impl Add for Cost {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self {
            read: self.read + other.read,
            written: self.written + other.written,
            operations: self.operations + other.operations,
        }
    }
}

/// That of so many items.
impl Mul<usize> for Cost {
    type Output = Self;
    fn mul(self, items: usize) -> Self {
        Self {
            read: self.read * items as u64,
            written: self.written * items as u64,
            operations: self.operations * items as u64,
        }
    }
}

/// Bytes of one item of a queue, all columns together.
#[must_use]
pub const fn item<L: Layout>() -> usize {
    L::WORDS * size_of::<u32>()
}

/// Bytes of the columns of `L` that `chosen` names.
///
/// # Panics
/// If a name is not that of a column: at compile time, where the result is a constant.
#[must_use]
pub const fn columns<L: Layout>(chosen: &[&str]) -> usize {
    let (mut i, mut words) = (0, 0);
    while i < chosen.len() {
        let mut j = 0;
        while !same(L::COLUMNS[j].0, chosen[i]) {
            j += 1;
        }
        words += L::COLUMNS[j].1;
        i += 1;
    }
    words * size_of::<u32>()
}

/// Whether two names are equal; `==` is not for constants.
const fn same(a: &str, b: &str) -> bool {
    let (a, b) = (a.as_bytes(), b.as_bytes());
    let mut i = 0;
    while i < a.len() && i < b.len() && a[i] == b[i] {
        i += 1;
    }
    i == a.len() && i == b.len()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::queues::{PathHitsMut, PathsMut};

    #[test]
    fn columns_are_found_by_name() {
        assert_eq!(columns::<PathsMut>(&["origin", "leaves"]), 16);
        assert_eq!(columns::<PathHitsMut>(&[]), 0);
        assert_eq!(item::<PathHitsMut>(), 16);
    }

    #[test]
    #[should_panic(expected = "index out of bounds")]
    fn a_column_that_is_not_there_is_noticed() {
        let _ = columns::<PathHitsMut>(&["origin"]);
    }

    #[test]
    fn traffic_adds_up() {
        let both = Cost::new(3, 4).operations(2) * 5 + Cost::new(1, 1);
        assert_eq!(both, Cost::new(16, 21).operations(10));
    }
}
