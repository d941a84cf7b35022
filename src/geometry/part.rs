//! Trees over some of a mesh's triangles.

use super::layout::Layout;
use crate::scene::Mesh;
use crate::settings::Preset;
use huygens_kernels::bvh::NOTHING;
use obvhs::aabb::Aabb;

/// Some triangles of a mesh, as a mesh.
pub(super) struct Part {
    pub(super) mesh: Mesh,
    /// What they are in the whole, rising.
    pub(super) numbers: Vec<u32>,
}

impl Part {
    /// The triangles that wear a material of the `kept`.
    pub(super) fn new(whole: &Mesh, kept: impl Fn(&u32) -> bool) -> Self {
        let worn = whole.material.iter().enumerate();
        let numbers: Vec<u32> = worn
            .filter(|(_, m)| kept(m))
            .map(|(i, _)| i as u32)
            .collect();
        let mut places = vec![NOTHING; whole.vertices.len()];
        let mut mesh = Mesh::default();
        for &i in &numbers {
            let place = |vertex: u32| {
                let place = &mut places[vertex as usize];
                if *place == NOTHING {
                    *place = mesh.vertices.len() as u32;
                    mesh.vertices.push(whole.vertices[vertex as usize]);
                }
                *place
            };
            let corners = whole.indices[i as usize].map(place);
            mesh.indices.push(corners);
            mesh.material.push(whole.material[i as usize]);
        }
        Self { mesh, numbers }
    }

    /// Their tree, with the whole's numbers, and its box; none over nothing.
    pub(super) fn tree(&self, preset: Preset) -> Option<(Layout, Aabb)> {
        let (mut layout, aabb) = super::tree(&self.mesh, preset)?;
        for block in &mut layout.blocks[..] {
            for name in block.primitive.as_mut_array() {
                *name = self.numbers[*name as usize];
            }
        }
        Some((layout, aabb))
    }
}
