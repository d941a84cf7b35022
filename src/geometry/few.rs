//! The triangles of small meshes for the kernel that needs no tree.

use crate::scene::Mesh;
use huygens_kernels::few::{self, Triangle};

/// Up to so many triangles are all tested rather than sought through the tree: see
/// `docs/performance/rays.md`.
const FEW: usize = 48;

/// The triangles of a mesh that has few.
#[derive(Debug, Default)]
pub(super) struct FewTables {
    /// Different ones, those of finite triangles.
    vertices: Vec<[f32; 3]>,
    triangles: Vec<Triangle>,
}

impl FewTables {
    /// The triangles of `mesh`, if they are few, triangle `i` called `number(i)`, which rises.
    pub(super) fn new(mesh: &Mesh, number: impl Fn(usize) -> u32) -> Self {
        let mut few = Self::default();
        if mesh.triangles() > FEW {
            return few;
        }
        for i in 0..mesh.triangles() {
            let corners = mesh.corners(i);
            if corners.as_flattened().iter().all(|c| c.is_finite()) {
                let corners = corners.map(|c| few.place(c));
                few.triangles.push(Triangle {
                    primitive: number(i),
                    corners,
                });
            }
        }
        few
    }

    /// The place of a vertex. At most three for each of [`FEW`] triangles, so a byte holds it.
    fn place(&mut self, vertex: [f32; 3]) -> u8 {
        const { assert!(3 * FEW <= few::MAX_VERTICES) };
        let bits = |v: &[f32; 3]| v.map(f32::to_bits);
        let known = self.vertices.iter().position(|v| bits(v) == bits(&vertex));
        let place = known.unwrap_or_else(|| {
            self.vertices.push(vertex);
            self.vertices.len() - 1
        });
        place as u8
    }

    pub(super) fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }

    pub(super) fn view(&self) -> few::Few<'_> {
        few::Few {
            vertices: &self.vertices,
            triangles: &self.triangles,
        }
    }

    pub(super) fn bytes(&self) -> usize {
        size_of_val(&self.vertices[..]) + size_of_val(&self.triangles[..])
    }
}
