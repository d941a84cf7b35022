//! A world of two levels: a tree an object, one over those of the world's own triangles that are not wholly
//! there, and the tree over all of that and the spheres (`top.rs`), in the tables that
//! `kernels/src/levels.rs` walks.

mod boxes;

use super::layout::Layout;
use super::motion::swept;
use super::top::{Item, Top};
use crate::scene::{Motion, Placement, Scene};
pub(super) use boxes::outwards;
use boxes::{around, parts, placed};
use huygens_kernels::bvh::{Bvh, LEAF, NOTHING, Node, index, leaf};
use huygens_kernels::instance::{Guide, Instance, OWN_MATERIAL};
use huygens_kernels::levels;
use huygens_kernels::motion::STILL;
use huygens_kernels::sphere::{Sphere, SphereBlock};
use obvhs::aabb::Aabb;

/// What a world has besides the tables of its trees' nodes and blocks.
#[derive(Debug, Default)]
pub(super) struct World {
    root: u32,
    own_root: u32,
    /// Most nodes on a way from the root through an object.
    depth: usize,
    /// Whether there is a tree of the world's own triangles besides.
    pub(super) has_own: bool,
    aabb: Option<Aabb>,
    blocks: Vec<SphereBlock>,
    /// By rising number of the first triangle.
    pub(super) instances: Vec<Instance>,
    /// How some of them move.
    pub(super) motions: Vec<Motion>,
    pub(super) guide: Guide,
    /// Spheres by their places, for shading.
    pub(super) spheres: Vec<Sphere>,
}

/// A tree among others: where its root is, its box, and the boxes two levels below.
struct Rooted {
    root: u32,
    aabb: Aabb,
    parts: Vec<Aabb>,
}

impl World {
    /// Puts the trees of a scene's objects, that of those of its own triangles that are not wholly there
    /// (`cut`), and the one over all that, behind `own`, the tree of its other triangles with its box. `tree`
    /// builds the tree of an object.
    ///
    /// # Panics
    /// If hits cannot be numbered with 32 bits: a compiled scene promises it. On more than 2^30 blocks.
    pub(super) fn new(
        scene: &Scene,
        own: &mut Layout,
        own_box: Option<Aabb>,
        cut: Option<(Layout, Aabb)>,
        tree: impl Fn(usize) -> Option<(Layout, Aabb)>,
    ) -> Self {
        let mut below = 0;
        let mut behind = |(layout, aabb): (Layout, Aabb)| {
            below = below.max(layout.depth);
            Rooted::behind(own, &layout, aabb)
        };
        let objects: Vec<Option<Rooted>> = (0..scene.objects.len())
            .map(|i| tree(i).map(&mut behind))
            .collect();
        let cut = cut.map(behind);
        assert!(
            own.blocks.len() <= levels::DOOR as usize,
            "at most 2^30 blocks"
        );
        let mut first = (scene.mesh.triangles() + scene.spheres.len()) as u64;
        let (mut instances, mut items) = (Vec::new(), Vec::new());
        let mut motions = Vec::new();
        for instance in &scene.instances {
            let object = instance.object as usize;
            let Some(Rooted { root, aabb, parts }) = &objects[object] else {
                continue;
            };
            let Placement {
                to_object,
                to_world,
                origin,
            } = instance.placement;
            let (motion, aabb) = match &instance.motion {
                None => (STILL, placed(parts, &instance.placement)),
                Some(motion) => {
                    motions.push(*motion);
                    let moves = swept(aabb, &instance.placement, motion);
                    (motions.len() as u32 - 1, moves)
                }
            };
            items.push(Item {
                aabb,
                is_sphere: false,
            });
            instances.push(Instance {
                to_object,
                to_world,
                origin,
                first: u32::try_from(first).expect("hits are numbered with 32 bits"),
                object: instance.object,
                material: instance.material.unwrap_or(OWN_MATERIAL),
                root: *root,
                motion,
                extent: own.nodes[*root as usize].extent(),
                spare: [0; 5],
            });
            first += scene.objects[object].mesh.triangles() as u64;
        }
        let end = u32::try_from(first).expect("hits are numbered with 32 bits");
        let guide = Guide::new(&instances, end);
        if let Some(cut) = &cut {
            items.push(Item {
                aabb: cut.aabb,
                is_sphere: false,
            });
        }
        let doors = items.len();
        let spheres: Vec<Sphere> = scene.spheres.iter().map(in_kernels).collect();
        items.extend(spheres.iter().map(|sphere| Item {
            aabb: around(sphere),
            is_sphere: true,
        }));
        let mut world = Self {
            root: NOTHING,
            own_root: cut.map_or(NOTHING, |cut| cut.root),
            depth: 0,
            has_own: own_box.is_some(),
            aabb: items
                .iter()
                .map(|item| item.aabb)
                .chain(own_box)
                .reduce(|a, b| a.union(&b)),
            blocks: Vec::new(),
            instances,
            motions,
            guide,
            spheres,
        };
        if items.is_empty() {
            return world;
        }
        // How many blocks of spheres there are, which doors are numbered after, is only known in the
        // end: until then doors are numbered from the last possible reference down.
        let blocks = &mut world.blocks;
        let base = scene.mesh.triangles();
        let door = |i: usize| NOTHING - 1 - i as u32;
        let (nodes, depth) = Top::build(&items, |run| match run {
            &[one] if (one as usize) < doors => door(one as usize),
            _ => {
                let row = |&i: &u32| {
                    let i = i as usize - doors;
                    ((base + i) as u32, world.spheres[i])
                };
                let rows: Vec<(u32, Sphere)> = run.iter().map(row).collect();
                blocks.push(SphereBlock::new(&rows));
                levels::World::sphere_leaf(blocks.len() - 1)
            }
        });
        own.depth += depth;
        world.depth = below + depth;
        let first = own.nodes.len() as u32;
        let blocks = world.blocks.len();
        own.nodes.extend(nodes.into_iter().map(|mut node| {
            for child in node.child.as_mut_array() {
                *child = match *child {
                    NOTHING => NOTHING,
                    c if c & LEAF == 0 => first + c,
                    c if doors > 0 && c >= door(doors - 1) => {
                        levels::World::instance_leaf(blocks, (NOTHING - 1 - c) as usize)
                    }
                    c => c,
                };
            }
            node
        }));
        world.root = first;
        world
    }

    pub(super) fn view<'a>(&'a self, bvh: Bvh<'a>) -> levels::World<'a> {
        levels::World {
            bvh,
            root: self.root,
            own_root: self.own_root,
            depth: self.depth,
            spheres: &self.blocks,
            instances: &self.instances,
            motions: &self.motions,
        }
    }

    pub(super) fn bounds(&self) -> Option<[[f32; 3]; 2]> {
        self.aabb.map(|b| [b.min.to_array(), b.max.to_array()])
    }

    pub(super) fn memory(&self) -> [(&'static str, usize); 2] {
        let spheres = size_of_val(self.blocks.as_slice()) + size_of_val(self.spheres.as_slice());
        let instances = size_of_val(self.instances.as_slice())
            + size_of_val(self.motions.as_slice())
            + self.guide.bytes();
        [("bvh spheres", spheres), ("bvh instances", instances)]
    }
}

impl Rooted {
    /// Puts a tree behind others.
    fn behind(all: &mut Layout, tree: &Layout, aabb: Aabb) -> Self {
        let (root, block) = (all.nodes.len() as u32, all.blocks.len());
        let moved = |mut node: Node| {
            for child in node.child.as_mut_array() {
                *child = match *child {
                    NOTHING => NOTHING,
                    c if c & LEAF != 0 => leaf(block + index(c)),
                    c => root + c,
                };
            }
            node
        };
        all.nodes.extend(tree.nodes.iter().copied().map(moved));
        all.blocks.extend(tree.blocks.iter().copied());
        all.triangles += tree.triangles;
        all.depth = all.depth.max(tree.depth);
        Self {
            root,
            aabb,
            parts: parts(&tree.nodes),
        }
    }
}

fn in_kernels(sphere: &crate::scene::Sphere) -> Sphere {
    Sphere {
        centre: sphere.centre,
        radius: sphere.radius,
    }
}
