//! Copies of an object: an affine map each.
//!
//! A point `x` of the object lies in the world at `A x + c`. Rays are taken into the object,
//! `o' = B (o - c)`, `d' = B d` with `B` the inverse of `A`; `d'` is not normalised, so distances
//! along a ray are the same numbers on both sides. What lies where is defined by `B` as it is stored:
//! that is what rays meet. `A` is its inverse, rounded.
//!
//! **Bounds**, with `u = 2^-24` and `gamma(n) = n u / (1 - n u)`. A component of `o'` is off by at
//! most `gamma(4) |B| |o - c|` (one difference, three products, two sums of them), one of `d'` by
//! `gamma(3) |B| |d|`. All triangles of the object are tested against the same `o'` and `d'`, so a
//! closed object has no leaks, and whatever is next to whatever in the object decides alike; but
//! two instances that touch are like two meshes that touch without sharing vertices.
//!
//! A point of a triangle, known to `gamma(5) s` in the object (`surface.rs`), is known to
//! `gamma(10) (|A| s + |c|)` in the world: three fused operations, and the rounding of `A`.

/// An instance as kernels read it: two cache lines.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C, align(64))]
pub struct Instance {
    /// Rows of `B`: world to object.
    pub to_object: [[f32; 3]; 3],
    /// Rows of `A`: object to world.
    pub to_world: [[f32; 3]; 3],
    /// `c`: where the object's origin lies in the world.
    pub origin: [f32; 3],
    /// What its first triangle is called: the triangles of an instance are numbered in a row.
    pub first: u32,
    /// The object.
    pub object: u32,
    /// The material that all its triangles wear, or [`OWN_MATERIAL`].
    pub material: u32,
    /// Root of the object's tree.
    pub root: u32,
    /// Its motion among those of its world, or `motion::STILL`.
    pub motion: u32,
    /// The largest coordinate of the boxes of its object, in the object's space: see [`Node::extent`].
    ///
    /// [`Node::extent`]: crate::bvh::Node::extent
    pub extent: f32,
    /// Fills the second cache line.
    pub spare: [u32; 5],
}

/// The instance wears what its object wears.
pub const OWN_MATERIAL: u32 = u32::MAX;

impl Instance {
    /// A point of the world in the object.
    #[inline(always)]
    #[must_use]
    pub fn point_in(&self, p: [f32; 3]) -> [f32; 3] {
        let from: [f32; 3] = std::array::from_fn(|axis| p[axis] - self.origin[axis]);
        self.direction_in(from)
    }

    /// A direction of the world in the object.
    #[inline(always)]
    #[must_use]
    pub fn direction_in(&self, d: [f32; 3]) -> [f32; 3] {
        self.to_object
            .map(|row| row[0] * d[0] + row[1] * d[1] + row[2] * d[2])
    }
}

/// Finds the instance that a triangle's number belongs to: a table with an entry for every
/// `2^shift` numbers names the instance of the first of them.
#[derive(Clone, Debug, Default)]
pub struct Guide {
    base: u32,
    shift: u32,
    entries: Vec<u32>,
}

impl Guide {
    /// For instances whose first numbers rise, no two alike; `end` is the number behind the last
    /// triangle of the last one.
    #[must_use]
    pub fn new(instances: &[Instance], end: u32) -> Self {
        let Some(first) = instances.first() else {
            return Self::default();
        };
        let numbers = end - first.first;
        let most = 2 * instances.len() as u32;
        let shift = (0..31).find(|s| numbers >> s <= most).unwrap_or(31);
        let mut entries = vec![0; (numbers >> shift) as usize + 1];
        let mut instance = 0;
        for (i, entry) in entries.iter_mut().enumerate() {
            let number = u64::from(first.first) + ((i as u64) << shift);
            while instances
                .get(instance + 1)
                .is_some_and(|next| u64::from(next.first) <= number)
            {
                instance += 1;
            }
            *entry = instance as u32;
        }
        Self {
            base: first.first,
            shift,
            entries,
        }
    }

    /// The instance that the triangle called `number` belongs to.
    ///
    /// # Panics
    /// If it belongs to none.
    #[inline]
    #[must_use]
    pub fn find(&self, instances: &[Instance], number: u32) -> usize {
        let entry = ((number - self.base) >> self.shift) as usize;
        let from = self.entries[entry] as usize;
        let to = match self.entries.get(entry + 1) {
            Some(&next) => next as usize + 1,
            None => instances.len(),
        };
        from + instances[from..to].partition_point(|i| i.first <= number) - 1
    }

    /// Bytes held.
    #[must_use]
    pub fn bytes(&self) -> usize {
        size_of_val(self.entries.as_slice())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_finds_its_instance() {
        for sizes in [vec![1], vec![5, 1, 1, 1, 90_000, 3, 1, 2], vec![7; 300]] {
            let (mut instances, mut owner) = (Vec::new(), Vec::new());
            let mut first = 17;
            for (i, &size) in sizes.iter().enumerate() {
                instances.push(Instance {
                    first,
                    ..bytemuck::Zeroable::zeroed()
                });
                owner.extend(vec![i; size as usize]);
                first += size;
            }
            let guide = Guide::new(&instances, first);
            for (i, &owner) in owner.iter().enumerate() {
                assert_eq!(guide.find(&instances, 17 + i as u32), owner);
            }
            assert!(guide.bytes() <= 16 * sizes.len());
        }
    }
}
