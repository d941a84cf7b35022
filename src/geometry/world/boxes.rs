//! Boxes around spheres and copies of objects.

use crate::scene::Placement;
use glam::{DVec3, Vec3A};
use huygens_kernels::bvh::{LEAF, NOTHING, Node, WIDTH, index};
use huygens_kernels::sphere::Sphere;
use obvhs::aabb::Aabb;

/// The boxes two levels below the root of a tree, or of leaves that are nearer: an object fills those better
/// than its own box, and so does their image the box of a copy.
pub(super) fn parts(nodes: &[Node]) -> Vec<Aabb> {
    let of = |node: &Node| {
        let node = *node;
        let used = (0..WIDTH).filter(move |&i| node.child.as_array()[i] != NOTHING);
        used.map(move |i| {
            let side = |side: usize| {
                let planes = [0, 1, 2].map(|axis| node.planes[2 * axis + side].as_array()[i]);
                Vec3A::from_array(planes)
            };
            (node.child.as_array()[i], Aabb::new(side(0), side(1)))
        })
    };
    let children = nodes.first().into_iter().flat_map(of);
    let below = children.flat_map(|(child, aabb)| match child & LEAF {
        0 => of(&nodes[index(child)]).map(|(_, aabb)| aabb).collect(),
        _ => vec![aabb],
    });
    below.collect()
}

/// Rounded outwards from f64: to the next f32 of what the cast has rounded to the nearest, and that
/// of one more for the rounding of the f64.
pub(in crate::geometry) fn outwards(low: DVec3, high: DVec3) -> Aabb {
    let low = low.to_array().map(|c| (c as f32).next_down().next_down());
    let high = high.to_array().map(|c| (c as f32).next_up().next_up());
    Aabb::new(Vec3A::from_array(low), Vec3A::from_array(high))
}

pub(super) fn around(sphere: &Sphere) -> Aabb {
    let centre = DVec3::from_array(sphere.centre.map(f64::from));
    let radius = DVec3::splat(sphere.radius.into());
    outwards(centre - radius, centre + radius)
}

/// The box around the images of boxes: of each axis the sum of their edges' images (J. Arvo,
/// "Transforming Axis-Aligned Bounding Boxes", *Graphics Gems*, 1990).
pub(super) fn placed(boxes: &[Aabb], placement: &Placement) -> Aabb {
    let map = placement.map();
    let m = map.matrix3;
    let [x, y, z] = [m.x_axis.abs(), m.y_axis.abs(), m.z_axis.abs()];
    let one = |aabb: &Aabb| {
        let (low, high) = (aabb.min.as_dvec3(), aabb.max.as_dvec3());
        let centre = map.transform_point3(0.5 * (low + high));
        let half = 0.5 * (high - low);
        let reach = x * half.x + y * half.y + z * half.z;
        (centre - reach, centre + reach)
    };
    let all = boxes.iter().map(one);
    let (low, high) = all
        .reduce(|(a, b), (c, d)| (a.min(c), b.max(d)))
        .expect("an object has triangles");
    outwards(low, high)
}
