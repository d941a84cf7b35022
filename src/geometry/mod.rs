//! What rays meet. Everything above sees only [`Geometry`].
//!
//! Triangles -> boxes -> binary tree (`build`, `sbvh`, `ploc`) -> eight children a node (`collapse`) ->
//! tables (`layout`), which the kernels walk. A scene with spheres or instances has such a tree for
//! each object, and one over it all (`world`, `top`).

mod build;
mod collapse;
mod layout;
mod motion;
mod pages;
mod ploc;
mod reinsert;
mod sbvh;
#[cfg(test)]
mod tests_of_presets;
mod top;
mod world;

use crate::scene::{Mesh, Motion, Scene};
pub use crate::settings::Preset;
use build::Binary;
use collapse::Collapse;
use huygens_kernels::bare::COMPLETE;
use huygens_kernels::bvh::{Block, Bvh, Node};
use huygens_kernels::few::Triangle;
use huygens_kernels::instance::{Guide, Instance};
use huygens_kernels::levels::{self, Everything, Filter};
use huygens_kernels::rays::{Hits, Rays, Segments};
use huygens_kernels::sphere::Sphere;
use huygens_kernels::{few, many, packet};
use layout::Layout;
use obvhs::aabb::Aabb;
use world::World;

/// Up to so many triangles are all tested rather than sought through the tree: see
/// `docs/performance/rays.md`.
const FEW: usize = 48;

/// The acceleration structure over a mesh.
#[derive(Debug, Default)]
pub struct Geometry {
    layout: Layout,
    bounds: Option<[[f32; 3]; 2]>,
    /// All triangles, by rising index, where they are few; else none.
    few: FewTables,
    /// What is no triangle of the world, where there is anything.
    world: Option<World>,
}

/// Rays under way together in worlds of two levels: see `docs/performance/rays.md`.
const IN_FLIGHT: usize = 32;

/// A tree and its box; none over nothing.
fn tree(mesh: &Mesh, preset: Preset) -> Option<(Layout, Aabb)> {
    // The build reads them at random, and so does whoever shades what is hit. Materials are often all
    // the first, zeros never written.
    pages::large_where_untouched(&mesh.material);
    pages::onto_large(&mesh.vertices);
    pages::onto_large(&mesh.indices);
    pages::onto_large(&mesh.normals);
    pages::onto_large(&mesh.uvs);
    let tree = Binary::build(mesh, preset)?;
    let collapse = Collapse::new(&tree);
    let root = *collapse.aabb(0);
    Some((Layout::new(mesh, &collapse), root))
}

impl Geometry {
    /// Builds over all that `scene` holds: triangles as [`Geometry::build_with`], spheres, and the
    /// triangles of each object once, however often it is copied.
    ///
    /// # Panics
    /// As [`Geometry::build_with`].
    #[must_use]
    pub fn of(scene: &Scene, preset: Preset) -> Self {
        if scene.spheres.is_empty() && scene.instances.is_empty() {
            return Self::build_with(&scene.mesh, preset);
        }
        let (mut layout, root) = match tree(&scene.mesh, preset) {
            Some((layout, root)) => (layout, Some(root)),
            None => (Layout::default(), None),
        };
        let world = World::new(scene, &mut layout, root, |object| {
            tree(&scene.objects[object].mesh, preset)
        });
        Self {
            layout,
            bounds: world.bounds(),
            few: FewTables::default(),
            world: Some(world),
        }
    }

    /// Builds over all triangles of `mesh` with the default preset: see [`Geometry::build_with`].
    ///
    /// # Panics
    /// As [`Geometry::build_with`].
    #[must_use]
    pub fn build(mesh: &Mesh) -> Self {
        Self::build_with(mesh, Preset::default())
    }

    /// Builds over all triangles of `mesh`, deterministically, on the current rayon pool: the
    /// tables are the same, byte for byte, for any number of threads. What rays meet does not
    /// depend on the preset.
    ///
    /// Triangles with a corner that is not finite are left out. Any other input builds in
    /// O(n log n), and [`Geometry::depth`] has a bound.
    ///
    /// # Panics
    /// On a vertex index outside the mesh, and on more than about 2^31 triangles.
    #[must_use]
    pub fn build_with(mesh: &Mesh, preset: Preset) -> Self {
        let Some((layout, root)) = tree(mesh, preset) else {
            return Self::default();
        };
        Self {
            layout,
            bounds: Some([root.min.to_array(), root.max.to_array()]),
            few: FewTables::new(mesh),
            world: None,
        }
    }

    /// Closest hit of each ray.
    pub fn closest(&self, rays: Rays, hits: Hits) {
        if COMPLETE && self.world.is_some() {
            self.closest_where(&Everything, rays, hits);
        } else if self.few.triangles.is_empty() {
            packet::closest(self.bvh(), rays, hits);
        } else {
            many::closest_of_few(self.few.view(), rays, hits);
        }
    }

    /// For each segment: 1 if something lies on it, 0 if its ends see each other.
    pub fn occluded(&self, segments: Segments, occluded: &mut [u32]) {
        if COMPLETE && self.world.is_some() {
            self.occluded_where(&Everything, segments, occluded);
        } else if self.few.triangles.is_empty() {
            many::occluded(self.bvh(), segments, occluded);
        } else {
            many::occluded_by_few(self.few.view(), segments, occluded);
        }
    }

    /// Closest hit of each ray among those that `filter` accepts: what it rejects is as if it were
    /// not there. The traversal is the one for worlds of two levels, whatever the scene.
    pub fn closest_where(&self, filter: &impl Filter, rays: Rays, hits: Hits) {
        levels::closest::<IN_FLIGHT>(&self.levels(), filter, rays, hits);
    }

    /// For each segment: 1 if something lies on it that `filter` accepts, else 0.
    pub fn occluded_where(&self, filter: &impl Filter, segments: Segments, occluded: &mut [u32]) {
        levels::occluded::<IN_FLIGHT>(&self.levels(), filter, segments, occluded);
    }

    /// [`Geometry::closest_where`] where instances move: ray `i` lives at `times[i]`.
    pub fn closest_at(&self, filter: &impl Filter, times: &[f32], rays: Rays, hits: Hits) {
        levels::closest_at::<IN_FLIGHT>(&self.levels(), filter, times, rays, hits);
    }

    /// [`Geometry::occluded_where`] where instances move: segment `i` lives at `times[i]`.
    pub fn occluded_at(
        &self,
        filter: &impl Filter,
        times: &[f32],
        segments: Segments,
        occluded: &mut [u32],
    ) {
        levels::occluded_at::<IN_FLIGHT>(&self.levels(), filter, times, segments, occluded);
    }

    /// How instances move, those that do.
    #[must_use]
    pub fn motions(&self) -> &[Motion] {
        self.world.as_ref().map_or(&[], |world| &world.motions)
    }

    fn levels(&self) -> levels::World<'_> {
        match &self.world {
            Some(world) => world.view(self.bvh()),
            None => levels::World::of_triangles(self.bvh()),
        }
    }

    /// Instances as kernels see them, and what finds the one that a hit belongs to.
    #[must_use]
    pub fn instances(&self) -> (&[Instance], Option<&Guide>) {
        match &self.world {
            Some(world) => (&world.instances, Some(&world.guide)),
            None => (&[], None),
        }
    }

    /// Spheres as kernels see them.
    #[must_use]
    pub fn spheres(&self) -> &[Sphere] {
        self.world.as_ref().map_or(&[], |world| &world.spheres)
    }

    /// The tree as kernels see it.
    #[must_use]
    pub fn bvh(&self) -> Bvh<'_> {
        Bvh {
            nodes: &self.layout.nodes,
            blocks: &self.layout.blocks,
        }
    }

    /// Lowest and highest corner of the box around everything, if there is anything.
    #[must_use]
    pub fn bounds(&self) -> Option<[[f32; 3]; 2]> {
        self.bounds
    }

    /// Nodes of the tree, eight children each.
    #[must_use]
    pub fn nodes(&self) -> usize {
        self.layout.nodes.len()
    }

    /// Blocks of four triangles.
    #[must_use]
    pub fn blocks(&self) -> usize {
        self.layout.blocks.len()
    }

    /// References to triangles in the tree's leaves: where [`Preset::Best`] has cut triangles, more
    /// than there are triangles.
    #[must_use]
    pub fn triangles(&self) -> usize {
        self.layout.triangles
    }

    /// Nodes on the longest path from the root to a leaf, at most
    /// [`huygens_kernels::bvh::MAX_DEPTH`].
    #[must_use]
    pub fn depth(&self) -> usize {
        self.layout.depth
    }

    /// Expected cost of a ray that meets the scene's box, by the surface area heuristic: nodes
    /// tested, plus 0.6 for each block.
    #[must_use]
    pub fn sah_cost(&self) -> f64 {
        self.layout.sah
    }

    /// Bytes held, by table.
    #[must_use]
    pub fn memory(&self) -> Vec<(&'static str, usize)> {
        let mut tables = vec![
            ("bvh nodes", self.nodes() * size_of::<Node>()),
            ("bvh triangles", self.blocks() * size_of::<Block>()),
            ("few triangles", self.few.bytes()),
        ];
        if let Some(world) = &self.world {
            tables.extend(world.memory());
        }
        tables
    }
}

/// The triangles of a mesh that has few.
#[derive(Debug, Default)]
struct FewTables {
    /// Different ones, those of finite triangles.
    vertices: Vec<[f32; 3]>,
    triangles: Vec<Triangle>,
}

impl FewTables {
    fn new(mesh: &Mesh) -> Self {
        let mut few = Self::default();
        if mesh.triangles() > FEW {
            return few;
        }
        for i in 0..mesh.triangles() {
            let corners = mesh.corners(i);
            if corners.as_flattened().iter().all(|c| c.is_finite()) {
                let corners = corners.map(|c| few.place(c));
                few.triangles.push(Triangle {
                    primitive: i as u32,
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

    fn view(&self) -> few::Few<'_> {
        few::Few {
            vertices: &self.vertices,
            triangles: &self.triangles,
        }
    }

    fn bytes(&self) -> usize {
        size_of_val(&self.vertices[..]) + size_of_val(&self.triangles[..])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A wavy sheet of `2 n^2` triangles with some very long ones among them.
    fn sheet(n: u32) -> Mesh {
        let height = |x: u32, y: u32| ((x * 31 + y * 17) % 23) as f32 * 0.1;
        let mut mesh = Mesh::default();
        for y in 0..=n {
            for x in 0..=n {
                mesh.vertices.push([x as f32, height(x, y), y as f32]);
            }
        }
        for y in 0..n {
            for x in 0..n {
                let i = y * (n + 1) + x;
                let far = if (x + y) % 97 == 0 { 0 } else { i + 1 };
                mesh.indices.push([i, i + n + 1, far]);
                mesh.indices.push([i + 1, i + n + 1, i + n + 2]);
            }
        }
        mesh.material = vec![0; mesh.indices.len()];
        mesh
    }

    #[test]
    fn tables_are_the_same_for_any_number_of_threads() {
        let mesh = sheet(150);
        let build = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            let geometry = pool.build().unwrap().install(|| Geometry::build(&mesh));
            let layout = geometry.layout;
            let nodes: &[u8] = bytemuck::cast_slice(&layout.nodes);
            let blocks: &[u8] = bytemuck::cast_slice(&layout.blocks);
            (blake3::hash(nodes), blake3::hash(blocks))
        };
        let one = build(1);
        for threads in [2, 3, 5] {
            assert_eq!(build(threads), one, "{threads} threads");
        }
    }

    #[test]
    fn every_triangle_is_in_a_leaf_once() {
        let mesh = sheet(40);
        let geometry = Geometry::build(&mesh);
        let mut seen = vec![0; mesh.triangles()];
        for block in &geometry.layout.blocks[..] {
            let mut lanes = block.primitive.to_array().to_vec();
            lanes.dedup();
            lanes.iter().for_each(|&i| seen[i as usize] += 1);
        }
        assert!(seen.iter().all(|&n| n == 1));
        assert_eq!(geometry.triangles(), mesh.triangles());
    }
}
