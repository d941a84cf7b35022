//! The maps of instances, one a lane.

use crate::instance::Instance;
use crate::lanes::{Fx, LANES};
use crate::vec3::Vec3x;
use std::mem::offset_of;

/// The product of a matrix, one a lane, with a vector, plus another.
#[inline(always)]
pub(super) fn transform(rows: [Vec3x; 3], p: Vec3x, plus: Vec3x) -> Vec3x {
    let [x, y, z] = rows;
    let row = |r: Vec3x, plus: Fx| r.x.mul_add(p.x, r.y.mul_add(p.y, r.z.mul_add(p.z, plus)));
    Vec3x::new(row(x, plus.x), row(y, plus.y), row(z, plus.z))
}

/// The rows of the instances' maps, a lane each.
pub(super) struct Maps {
    pub(super) to_world: [Vec3x; 3],
    pub(super) to_object: [Vec3x; 3],
    pub(super) transposed: [Vec3x; 3],
    pub(super) origin: Vec3x,
}

impl Maps {
    #[inline(always)]
    pub(super) fn gather(maps: &[&Instance; LANES]) -> Self {
        const { assert!(offset_of!(Instance, to_object) == 0 && offset_of!(Instance, to_world) == 36) }
        const { assert!(offset_of!(Instance, origin) == 72) }
        let mut entries = [[0.0; LANES]; 21];
        for (lane, map) in maps.iter().enumerate() {
            let numbers: &[f32; 32] = bytemuck::cast_ref(*map);
            for (entry, number) in entries.iter_mut().zip(numbers) {
                entry[lane] = *number;
            }
        }
        let vector = |at: [usize; 3]| {
            let [x, y, z] = at.map(|i| Fx::new(entries[i]));
            Vec3x::new(x, y, z)
        };
        Self {
            to_object: [0, 3, 6].map(|i| vector([i, i + 1, i + 2])),
            transposed: [0, 1, 2].map(|i| vector([i, i + 3, i + 6])),
            to_world: [9, 12, 15].map(|i| vector([i, i + 1, i + 2])),
            origin: vector([18, 19, 20]),
        }
    }

    /// A normal of the object in the world, of unit length.
    #[inline(always)]
    pub(super) fn normal(&self, normal: Vec3x) -> Vec3x {
        let largest = self
            .to_object
            .iter()
            .fold(Fx::ZERO, |m, row| m.fast_max(row.abs().max_component()));
        // First to entries of about 1, so that no square overflows.
        let scaled = normal * (Fx::ONE / largest);
        transform(self.transposed, scaled, Vec3x::splat([0.0; 3])).normalized()
    }
}
