//! What rays meet. Everything above sees only [`Geometry`].
//!
//! Triangles -> boxes -> binary tree (`build`, `sbvh`, `ploc`) -> eight children a node (`collapse`) ->
//! tables (`layout`), which the kernels walk. A scene with spheres, instances or triangles that are not
//! wholly there has such a tree for each object and one for those triangles, and one over all that
//! (`world`, `top`). Its other triangles are traced as if there were nothing else, and first.

mod build;
mod collapse;
mod few;
mod layout;
mod motion;
mod part;
mod ploc;
mod reinsert;
mod sbvh;
#[cfg(test)]
mod tests_of_presets;
mod top;
mod world;

use crate::pages;
use crate::scene::{Mesh, Motion, Scene};
pub use crate::settings::Preset;
use build::Binary;
use collapse::Collapse;
use few::FewTables;
use huygens_kernels::bare::COMPLETE;
use huygens_kernels::bvh::{Block, Bvh, Node};
use huygens_kernels::instance::{Guide, Instance};
use huygens_kernels::levels::{self, Everything, Filter};
use huygens_kernels::rays::{Hits, NO_PRIMITIVE, Rays, Segments};
use huygens_kernels::sphere::Sphere;
use huygens_kernels::{many, packet};
use layout::Layout;
use obvhs::aabb::Aabb;
use part::Part;
use world::World;

/// The acceleration structure over a mesh.
#[derive(Debug, Default)]
pub struct Geometry {
    layout: Layout,
    bounds: Option<[[f32; 3]; 2]>,
    /// The triangles of the tree, by rising index, where they are few; else none.
    few: FewTables,
    /// Whether the triangles of the tree are known to be wholly there.
    whole: bool,
    /// What is not in the tree, where there is anything.
    world: Option<World>,
}

/// A tree and its box; none over nothing.
fn tree(mesh: &Mesh, preset: Preset) -> Option<(Layout, Aabb)> {
    let tree = Binary::build(mesh, preset)?;
    let collapse = Collapse::new(&tree);
    let root = *collapse.aabb(0);
    Some((Layout::new(mesh, &collapse), root))
}

/// Puts a mesh on large pages: the build reads it at random, and so does whoever shades what is hit.
fn onto_large_pages(mesh: &Mesh) {
    // Often all the first, zeros never written.
    pages::large_where_untouched(&mesh.material);
    pages::onto_large(&mesh.vertices);
    pages::onto_large(&mesh.indices);
    pages::onto_large(&mesh.normals);
    pages::onto_large(&mesh.uvs);
}

impl Geometry {
    /// Builds over all that `scene` holds: triangles as [`Geometry::build_with`], spheres, and the
    /// triangles of each object once, however often it is copied.
    ///
    /// # Panics
    /// As [`Geometry::build_with`].
    #[must_use]
    pub fn of(scene: &Scene, preset: Preset) -> Self {
        let is_cut = |&m: &u32| scene.materials[m as usize].alpha.is_some();
        // Materials first: mostly none is, and then a table as long as the mesh stays untouched.
        let any_cut = scene.materials.iter().any(|m| m.alpha.is_some())
            && scene.mesh.material.iter().any(is_cut);
        if scene.spheres.is_empty() && scene.instances.is_empty() && !any_cut {
            return Self {
                whole: true,
                ..Self::build_with(&scene.mesh, preset)
            };
        }
        let objects = scene.objects.iter().map(|object| &object.mesh);
        objects.chain([&scene.mesh]).for_each(onto_large_pages);
        let (few, own, cut) = if any_cut {
            let part = |wanted: bool| Part::new(&scene.mesh, |m| is_cut(m) == wanted);
            let (whole, cut) = (part(false), part(true));
            let few = FewTables::new(&whole.mesh, |i| whole.numbers[i]);
            (few, whole.tree(preset), cut.tree(preset))
        } else {
            let few = FewTables::new(&scene.mesh, |i| i as u32);
            (few, tree(&scene.mesh, preset), None)
        };
        let (mut layout, root) = match own {
            Some((layout, root)) => (layout, Some(root)),
            None => (Layout::default(), None),
        };
        let world = World::new(scene, &mut layout, root, cut, |object| {
            tree(&scene.objects[object].mesh, preset)
        });
        Self {
            layout,
            bounds: world.bounds(),
            few,
            whole: true,
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
        onto_large_pages(mesh);
        let Some((layout, root)) = tree(mesh, preset) else {
            return Self::default();
        };
        Self {
            layout,
            bounds: Some([root.min.to_array(), root.max.to_array()]),
            few: FewTables::new(mesh, |i| i as u32),
            whole: false,
            world: None,
        }
    }

    /// Closest hit of each ray.
    pub fn closest(&self, rays: Rays, hits: Hits) {
        if COMPLETE && self.world.is_some() {
            self.closest_among(&Everything, None, rays, hits);
        } else {
            self.closest_in_tree(rays, hits);
        }
    }

    /// For each segment: 1 if something lies on it, 0 if its ends see each other.
    pub fn occluded(&self, segments: Segments, occluded: &mut [u32]) {
        if COMPLETE && self.world.is_some() {
            self.occluded_among(&Everything, None, segments, occluded);
        } else {
            self.occluded_in_tree(segments, occluded);
        }
    }

    /// Closest hit of each ray among those that `filter` accepts: what it rejects is as if it were not
    /// there. Of a scene it is asked only about what wears a material with an opacity. Where instances
    /// move, ray `i` lives at `times[i]`.
    pub fn closest_among<F: Filter>(
        &self,
        filter: &F,
        times: Option<&[f32]>,
        rays: Rays,
        mut hits: Hits,
    ) {
        if self.is_certain::<F>() {
            self.closest_in_tree(rays, hits.part(0..rays.len));
        } else {
            hits.primitive[..rays.len].fill(NO_PRIMITIVE);
        }
        if let Some(levels) = self.levels::<F>() {
            levels::nearer(&levels, filter, times, rays, hits);
        }
    }

    /// For each segment: 1 if something lies on it that `filter` accepts, else 0; as
    /// [`Geometry::closest_among`].
    pub fn occluded_among<F: Filter>(
        &self,
        filter: &F,
        times: Option<&[f32]>,
        segments: Segments,
        occluded: &mut [u32],
    ) {
        if self.is_certain::<F>() {
            self.occluded_in_tree(segments, occluded);
        } else {
            occluded[..segments.len].fill(0);
        }
        if let Some(levels) = self.levels::<F>() {
            levels::obstructed(&levels, filter, times, segments, occluded);
        }
    }

    /// What is not in the tree, as kernels see it, where there is anything.
    #[must_use]
    pub fn beside(&self) -> Option<levels::World<'_>> {
        self.world.as_ref().map(|world| world.view(self.bvh()))
    }

    /// Whether the tree's triangles are met whatever a filter says, and there are some.
    fn is_certain<F: Filter>(&self) -> bool {
        let any = self.world.as_ref().is_none_or(|world| world.has_own);
        any && (self.whole || !F::ASKS)
    }

    /// What a filter must be asked about, and all that is not in the tree.
    fn levels<F: Filter>(&self) -> Option<levels::World<'_>> {
        let all = || levels::World::of_triangles(self.bvh());
        self.beside()
            .or_else(|| (!self.is_certain::<F>()).then(all))
    }

    /// Closest hit of each ray among the triangles of the tree.
    fn closest_in_tree(&self, rays: Rays, hits: Hits) {
        if self.few.is_empty() {
            packet::closest(self.bvh(), rays, hits);
        } else {
            many::closest_of_few(self.few.view(), rays, hits);
        }
    }

    /// Whether some triangle of the tree lies on each segment.
    fn occluded_in_tree(&self, segments: Segments, occluded: &mut [u32]) {
        if self.few.is_empty() {
            many::occluded(self.bvh(), segments, occluded);
        } else {
            many::occluded_by_few(self.few.view(), segments, occluded);
        }
    }

    /// How instances move, those that do.
    #[must_use]
    pub fn motions(&self) -> &[Motion] {
        self.world.as_ref().map_or(&[], |world| &world.motions)
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
