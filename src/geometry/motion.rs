//! Boxes around what moves.

use super::world::outwards;
use crate::scene::motion::at;
use crate::scene::{Motion, Placement};
use glam::{DMat3, DVec3};
use obvhs::aabb::Aabb;

/// Pieces that a turn is cut into.
const PIECES: u32 = 16;

/// What roundings of the kernel's map may move a point by, relative: see `kernels/src/motion.rs`.
const ROUNDINGS: f64 = 160.0 / 16_777_216.0;

/// A box around all places of a box of the object's, from when the shutter opens to when it closes.
///
/// In each of some pieces of time a corner's offset from the instance's origin stays within the box of
/// its two ends, but for how far its arc bulges over its chord, `r (1 - cos(delta / 2))`; the origin
/// goes along a line. What lies between the corners lies in the hull of where they are. To that comes
/// what the roundings of the kernel's matrices can be seen as.
pub(super) fn swept(aabb: &Aabb, placement: &Placement, motion: &Motion) -> Aabb {
    let map = placement.map();
    let (low, high) = (aabb.min.as_dvec3(), aabb.max.as_dvec3());
    let corners: [DVec3; 8] = std::array::from_fn(|bits| {
        let at = |axis: usize| bits >> axis & 1 == 1;
        map.matrix3 * DVec3::select(glam::BVec3::new(at(0), at(1), at(2)), high, low)
    });
    let farthest = corners.iter().map(|c| c.length()).fold(0.0, f64::max);
    let turn = std::f64::consts::TAU * f64::from(motion.turns);
    let pieces = if turn == 0.0 { 1 } else { PIECES };
    let bulge = farthest * (1.0 - (0.5 * turn / f64::from(pieces)).cos());
    let mut whole: Option<[DVec3; 2]> = None;
    for piece in 0..pieces {
        let ends = [piece, piece + 1].map(|k| at(motion, f64::from(k) / f64::from(pieces)));
        let offsets = ends.iter().flat_map(|(r, _)| corners.map(|c| *r * c));
        let [from, to] = bounds(offsets);
        let [start, end] = bounds(ends.iter().map(|(_, way)| map.translation + *way));
        let this = [from + start - bulge, to + end + bulge];
        whole = Some(match whole {
            None => this,
            Some([low, high]) => [low.min(this[0]), high.max(this[1])],
        });
    }
    let [low, high] = whole.unwrap_or_default();
    // Of the matrices, by how much either stretches; of the origin, by its own size.
    let stretch = largest(&map.matrix3) * largest(&map.matrix3.inverse());
    let far = map.translation.abs().max_element() + at(motion, 1.0).1.abs().max_element();
    let pad = ROUNDINGS * (9.0 * stretch * farthest + far);
    outwards(low - pad, high + pad)
}

fn bounds(points: impl Iterator<Item = DVec3>) -> [DVec3; 2] {
    let both = points.map(|p| [p, p]);
    both.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
        .unwrap_or_default()
}

fn largest(m: &DMat3) -> f64 {
    m.to_cols_array().iter().fold(0.0, |l, c| c.abs().max(l))
}

#[cfg(test)]
mod tests {
    use super::*;
    use bytemuck::Zeroable;
    use glam::{DAffine3, DQuat, Vec3A};
    use huygens_kernels::instance::Instance;
    use proptest::prelude::*;

    fn triple(size: f64) -> impl Strategy<Value = DVec3> {
        let one = -size..size;
        [one.clone(), one.clone(), one].prop_map(DVec3::from_array)
    }

    proptest! {
        /// Wherever the kernel's own map sees a point of the box, at whatever time, is in the box.
        #[test]
        fn nothing_leaves_its_box(
            corner in triple(2.0), size in triple(3.0), inside in triple(1.0),
            scale in triple(1.0), turned in triple(1.0), origin in triple(1e4), travel in triple(50.0),
            axis in triple(1.0), turns in prop_oneof![Just(0f32), 0f32..1.0, Just(1f32)],
            time in prop_oneof![Just(0f32), 0f32..1.0, Just(1f32)],
        ) {
            prop_assume!(axis.length() > 0.1 && turned.length() > 0.1);
            let scale = scale.abs() + 0.05;
            let rotation = DQuat::from_axis_angle(turned.normalize(), 3.0 * turned.x);
            let map = DAffine3::from_scale_rotation_translation(scale, rotation, origin);
            let placement = Placement::new(&map).unwrap();
            let motion = Motion {
                travel: travel.as_vec3().to_array(),
                axis: axis.normalize().as_vec3().to_array(),
                turns,
            };
            let (low, high) = (corner.as_vec3a(), (corner + size.abs()).as_vec3a());
            let around = swept(&Aabb::new(low, high), &placement, &motion);
            let point = low.as_dvec3() + (high - low).as_dvec3() * (0.5 + 0.5 * inside);
            let still = Instance {
                to_object: placement.to_object,
                to_world: placement.to_world,
                origin: placement.origin,
                ..Instance::zeroed()
            };
            let moved = motion.placed(&still, time);
            // The inverse of what rays are taken into the object by, in f64.
            let rows = moved.to_object.map(|row| row.map(f64::from));
            let back = DMat3::from_cols_array_2d(&rows).transpose().inverse();
            let at = back * point + DVec3::from_array(moved.origin.map(f64::from));
            let at = Vec3A::from_array(at.as_vec3().to_array());
            prop_assert!(at.cmpge(around.min).all() && at.cmple(around.max).all(), "{at} {around:?}");
            // And the box is no larger than a few times what it has to hold.
            let reach = 2.0 * (map.matrix3 * (low.as_dvec3().abs().max(high.as_dvec3().abs()))).length()
                + 2.0 * (map.matrix3 * size).length() + travel.length() + 10.0;
            let wide = (around.max - around.min).as_dvec3().max_element();
            prop_assert!(wide <= 8.0 * reach, "{wide} {reach}");
        }
    }
}
