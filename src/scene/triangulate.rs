//! Polygons to triangles.
//!
//! A fan is right for a convex polygon only. The others are cut by ear clipping (G. Meisters,
//! "Polygons have ears", 1975) in the plane that the polygon's normal is most aligned with: its
//! Newell normal (M. Newell), which is defined for any closed loop of edges, planar or not.

use glam::{DVec2, DVec3};

/// Cuts the polygon with the given corners into `corners.len() - 2` triangles of indices into
/// `corners`, in the polygon's winding.
///
/// Any input terminates: where a loop crosses itself or lies on a line, no ear may be left, and
/// the next corner is cut off as it is. Triangles of zero area may come out; fewer than three
/// corners give none.
pub(super) fn triangulate(corners: &[DVec3], out: &mut Vec<[u32; 3]>) {
    match corners.len() {
        0..3 => return,
        3 => return out.push([0, 1, 2]),
        _ => {}
    }
    let flat = project(corners);
    let mut left: Vec<u32> = (0..corners.len() as u32).collect();
    if (0..left.len()).all(|i| turn(&flat, around(&left, i)) >= 0.0) && winds_once(&flat) {
        out.extend((1..left.len() as u32 - 1).map(|i| [0, i, i + 1]));
        return;
    }
    let mut at = 0;
    let mut tried = 0;
    while left.len() > 3 {
        let n = left.len();
        let ear = around(&left, at % n);
        if tried >= n || is_ear(&flat, &left, ear) {
            out.push(ear);
            left.remove(at % n);
            tried = 0;
            // Steps over the next corner, so that a circle is not cut into a fan of slivers.
            at = (at % n + 1) % (n - 1);
        } else {
            tried += 1;
            at += 1;
        }
    }
    out.push([left[0], left[1], left[2]]);
}

/// The corner at `i` between its neighbours.
fn around(left: &[u32], i: usize) -> [u32; 3] {
    let n = left.len();
    [left[(i + n - 1) % n], left[i], left[(i + 1) % n]]
}

/// Along the largest component of the Newell normal, oriented so that the loop turns
/// counter-clockwise.
fn project(corners: &[DVec3]) -> Vec<DVec2> {
    // About the first corner: otherwise a small polygon far from the origin has only rounding left.
    let base = corners[0];
    let normal: DVec3 = (0..corners.len())
        .map(|i| (corners[i] - base).cross(corners[(i + 1) % corners.len()] - base))
        .sum();
    let size = normal.abs();
    let pick: fn(DVec3) -> DVec2 = if size.x >= size.y && size.x >= size.z {
        |v| DVec2::new(v.y, v.z)
    } else if size.y >= size.z {
        |v| DVec2::new(v.z, v.x)
    } else {
        |v| DVec2::new(v.x, v.y)
    };
    let along = if size.x >= size.y && size.x >= size.z {
        normal.x
    } else if size.y >= size.z {
        normal.y
    } else {
        normal.z
    };
    let mirror = if along < 0.0 { -1.0 } else { 1.0 };
    corners
        .iter()
        .map(|&v| pick(v - base) * DVec2::new(mirror, 1.0))
        .collect()
}

/// Twice the signed area of a triangle of the projection.
fn turn(flat: &[DVec2], t: [u32; 3]) -> f64 {
    let [a, b, c] = t.map(|i| flat[i as usize]);
    (b - a).perp_dot(c - b)
}

/// Whether a loop that turns left at every corner goes round once, not twice as a pentagram does:
/// then, and only then, its x coordinate changes direction twice.
fn winds_once(flat: &[DVec2]) -> bool {
    let steps: Vec<f64> = (0..flat.len())
        .map(|i| flat[(i + 1) % flat.len()].x - flat[i].x)
        .filter(|&dx| dx != 0.0)
        .collect();
    let turns = (0..steps.len())
        .filter(|&i| (steps[i] > 0.0) != (steps[(i + 1) % steps.len()] > 0.0))
        .count();
    turns <= 2
}

/// Whether no other corner lies in the triangle that would be cut off.
fn is_ear(flat: &[DVec2], left: &[u32], ear: [u32; 3]) -> bool {
    if turn(flat, ear) <= 0.0 {
        return false;
    }
    let [a, b, c] = ear.map(|i| flat[i as usize]);
    left.iter().all(|&i| {
        let p = flat[i as usize];
        let own = ear.contains(&i) || p == a || p == b || p == c;
        let inside = (b - a).perp_dot(p - a) >= 0.0
            && (c - b).perp_dot(p - b) >= 0.0
            && (a - c).perp_dot(p - c) >= 0.0;
        own || !inside
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn cut(corners: &[DVec3]) -> Vec<[u32; 3]> {
        let mut out = Vec::new();
        triangulate(corners, &mut out);
        out
    }

    fn area_vector(corners: &[DVec3], t: [u32; 3]) -> DVec3 {
        let [a, b, c] = t.map(|i| corners[i as usize]);
        (b - a).cross(c - a) * 0.5
    }

    fn flat(points: &[[f64; 2]]) -> Vec<DVec3> {
        points.iter().map(|p| DVec3::new(p[0], p[1], 0.0)).collect()
    }

    #[test]
    fn concave_quad_is_split_at_its_reflex_corner() {
        // An arrow head: the fan from corner 0 would cover the notch.
        let arrow = flat(&[[0.0, 0.0], [4.0, -2.0], [1.0, 0.0], [4.0, 2.0]]);
        for shift in 0..4 {
            let mut corners = arrow.clone();
            corners.rotate_left(shift);
            let triangles = cut(&corners);
            assert_eq!(triangles.len(), 2);
            for t in triangles {
                assert!(area_vector(&corners, t).z > 0.0, "shift {shift}");
            }
        }
    }

    #[test]
    fn letter_u_in_any_plane_keeps_its_area() {
        let u = [
            [0.0, 0.0],
            [3.0, 0.0],
            [3.0, 3.0],
            [2.0, 3.0],
            [2.0, 1.0],
            [1.0, 1.0],
            [1.0, 3.0],
            [0.0, 3.0],
        ];
        let axes = [DVec3::X, DVec3::Y, DVec3::Z];
        for (i, j) in [(0, 1), (1, 0), (1, 2), (2, 1), (2, 0), (0, 2)] {
            let corners: Vec<DVec3> = u.iter().map(|p| axes[i] * p[0] + axes[j] * p[1]).collect();
            let normal = axes[i].cross(axes[j]);
            let areas: Vec<f64> = cut(&corners)
                .into_iter()
                .map(|t| area_vector(&corners, t).dot(normal))
                .collect();
            assert!(areas.iter().all(|&a| a > 0.0), "{areas:?}");
            // All coordinates are small whole numbers: the sum is exact.
            assert_eq!(areas.iter().sum::<f64>(), 7.0);
        }
    }

    #[test]
    fn loops_without_ears_still_end() {
        let line = flat(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0, 0.0], [4.0, 0.0]]);
        assert_eq!(cut(&line).len(), 3);
        assert_eq!(cut(&[DVec3::ONE; 9]).len(), 7);
        let pentagram: Vec<DVec3> = (0..5)
            .map(|i| f64::from(i) * 2.0 * std::f64::consts::TAU / 5.0)
            .map(|a| DVec3::new(a.cos(), a.sin(), 0.0))
            .collect();
        assert_eq!(cut(&pentagram).len(), 3);
    }

    proptest! {
        /// A star-shaped polygon (radius a positive function of the angle) is simple: its cut has
        /// no triangle turned over, and the areas add up to the polygon's.
        #[test]
        fn star_shaped_polygons_keep_their_area(
            radii in prop::collection::vec(0.05f64..1.0, 4..40),
            tilt in -1.0f64..1.0,
        ) {
            let n = radii.len() as f64;
            let corners: Vec<DVec3> = radii.iter().enumerate().map(|(i, r)| {
                let a = i as f64 / n * std::f64::consts::TAU;
                let p = DVec2::new(a.cos(), a.sin()) * *r;
                DVec3::new(p.x, p.y, tilt * p.x)
            }).collect();
            let exact: f64 = (0..corners.len()).map(|i| {
                let (a, b) = (corners[i], corners[(i + 1) % corners.len()]);
                0.5 * (a.x * b.y - a.y * b.x)
            }).sum();
            let areas: Vec<f64> = cut(&corners)
                .into_iter().map(|t| area_vector(&corners, t).z).collect();
            // Each area is a difference of products below 4, with at most 6 roundings of them.
            let rounding = 24.0 * f64::EPSILON * areas.len() as f64;
            prop_assert!(areas.iter().all(|&a| a >= -rounding));
            prop_assert!((areas.iter().sum::<f64>() - exact).abs() <= 2.0 * rounding);
        }
    }
}
