//! Procedural meshes: rooms, columns, beams, boxes and sticks. Deterministic.

use crate::random::Random;
use glam::{Quat, Vec3, vec3};
use huygens::scene::Mesh;
use std::f64::consts::TAU;

/// A mesh under construction.
#[derive(Debug, Default)]
pub(crate) struct Sculptor(pub(crate) Mesh);

impl Sculptor {
    fn triangle(&mut self, corners: [u32; 3]) {
        self.0.indices.push(corners);
        self.0.material.push(0);
    }

    /// A parallelogram of two triangles.
    pub(crate) fn quad(&mut self, corner: Vec3, a: Vec3, b: Vec3) {
        let n = self.0.vertices.len() as u32;
        for p in [corner, corner + a, corner + a + b, corner + b] {
            self.0.vertices.push(p.to_array());
        }
        self.triangle([n, n + 1, n + 2]);
        self.triangle([n, n + 2, n + 3]);
    }

    /// A box of twelve triangles with the given half sizes, turned and moved.
    pub(crate) fn cuboid(&mut self, half: Vec3, turn: Quat, centre: Vec3) {
        let n = self.0.vertices.len() as u32;
        for i in 0..8 {
            let sign = |axis: u32| if i >> axis & 1 == 0 { -1.0 } else { 1.0 };
            let corner = half * vec3(sign(0), sign(1), sign(2));
            self.0.vertices.push((turn * corner + centre).to_array());
        }
        let faces = [
            [0, 1, 3, 2],
            [4, 6, 7, 5],
            [0, 4, 5, 1],
            [2, 3, 7, 6],
            [0, 2, 6, 4],
            [1, 5, 7, 3],
        ];
        for [a, b, c, d] in faces {
            self.triangle([n + a, n + b, n + c]);
            self.triangle([n + a, n + c, n + d]);
        }
    }

    /// The axis-aligned box from `low` to `high`.
    pub(crate) fn room(&mut self, low: Vec3, high: Vec3) {
        self.cuboid(0.5 * (high - low), Quat::IDENTITY, 0.5 * (low + high));
    }

    /// A fluted column of `2 * around * up` triangles on `foot`, without ends.
    fn column(&mut self, foot: Vec3, height: f32, around: u32, up: u32) {
        let first = self.0.vertices.len() as u32;
        for h in 0..=up {
            let y = f64::from(h) / f64::from(up);
            let swell = 1.0 + 0.25 * (2.0 * y - 1.0).powi(6);
            for a in 0..around {
                let angle = f64::from(a) / f64::from(around) * TAU;
                let r = 0.45 * (1.0 + 0.12 * (16.0 * angle).cos()) * swell;
                let offset = vec3(
                    (r * angle.cos()) as f32,
                    y as f32 * height,
                    (r * angle.sin()) as f32,
                );
                self.0.vertices.push((foot + offset).to_array());
            }
        }
        for h in 0..up {
            for a in 0..around {
                let i = first + h * around + a;
                let j = first + h * around + (a + 1) % around;
                self.triangle([i, j, j + around]);
                self.triangle([i, j + around, i + around]);
            }
        }
    }

    /// A hall of 40 by 12 by 20 with four rows of nine columns under 24 beams.
    fn nave(&mut self, around: u32, up: u32) {
        self.room(vec3(-20.0, 0.0, -10.0), vec3(20.0, 12.0, 10.0));
        for i in 0..36 {
            let (x, z) = ((i % 9) as f32, (i / 9) as f32);
            let foot = vec3(4.0 * x - 16.0, 0.0, 5.0 * z - 7.5);
            self.column(foot, 9.0, around, up);
            let capital = foot + vec3(0.0, 9.3, 0.0);
            self.cuboid(vec3(0.7, 0.3, 0.7), Quat::IDENTITY, capital);
        }
        for i in 0..24 {
            let at = vec3(1.6 * i as f32 - 18.5, 9.85, 0.0);
            self.cuboid(vec3(0.15, 0.25, 9.5), Quat::IDENTITY, at);
        }
    }
}

/// A rotation, uniform over all (K. Shoemake, "Uniform Random Rotations", Graphics Gems III, by
/// rejection of four numbers outside the unit ball).
fn turn(random: &mut Random) -> Quat {
    loop {
        let q = glam::Vec4::from_array([(); 4].map(|()| random.between(-1.0, 1.0)));
        let length = q.length_squared();
        if length > 0.01 && length <= 1.0 {
            return Quat::from_vec4(q.normalize());
        }
    }
}

/// `hall`, 286 thousand triangles: an interior of finely modelled columns, and 700 boxes about them
/// whose sizes span a factor of forty.
pub(crate) fn hall() -> Mesh {
    let mut hall = Sculptor::default();
    let mut random = Random(1234);
    hall.nave(80, 48);
    for _ in 0..700 {
        let size = 0.03 * 40f32.powf(random.unit());
        let half = size * random.point(Vec3::splat(0.3), Vec3::splat(1.3));
        let at = standing(&mut random, half.y);
        let about = turn(&mut random);
        hall.cuboid(half, about, at);
    }
    hall.0
}

/// `clutter`, 287 thousand triangles: the hall with 4,250 such boxes, and as many beams, up to 12 long
/// and from 2 to 20 thin, at all angles through each other and through everything else.
pub(crate) fn clutter() -> Mesh {
    let mut hall = Sculptor::default();
    let mut random = Random(4321);
    hall.nave(64, 40);
    for _ in 0..4250 {
        let size = 0.03 * 40f32.powf(random.unit());
        let half = size * random.point(Vec3::splat(0.3), Vec3::splat(1.3));
        let at = standing(&mut random, half.y);
        let about = turn(&mut random);
        hall.cuboid(half, about, at);
    }
    for _ in 0..4250 {
        let length = 0.5 * 12f32.powf(random.unit());
        let thin = 0.01 * 10f32.powf(random.unit());
        let half = vec3(length, thin, thin * random.between(1.0, 3.0));
        let at = random.point(vec3(-19.0, 0.5, -9.5), vec3(19.0, 11.0, 9.5));
        let about = turn(&mut random);
        hall.cuboid(half, about, at);
    }
    hall.0
}

/// Where a box goes: mostly near the floor.
fn standing(random: &mut Random, half_height: f32) -> Vec3 {
    let at = random.point(vec3(-19.0, 0.0, -9.5), vec3(19.0, 1.0, 9.5));
    let y = if random.unit() < 0.7 {
        half_height + 2.0 * at.y * at.y
    } else {
        11.0 * at.y
    };
    vec3(at.x, y, at.z)
}

/// `sticks`, 300 thousand triangles: single ones, 0.2 long and 0.0015 wide, at all angles in a box.
pub(crate) fn sticks() -> Mesh {
    let mut sticks = Sculptor::default();
    let mut random = Random(99);
    for _ in 0..300_000 {
        let middle = random.point(Vec3::NEG_ONE, Vec3::ONE);
        let along = random.direction();
        let across = along.any_orthonormal_vector();
        let n = sticks.0.vertices.len() as u32;
        let (a, b) = (middle - 0.1 * along, middle + 0.1 * along);
        for p in [a, b, b + 0.0015 * across] {
            sticks.0.vertices.push(p.to_array());
        }
        sticks.triangle([n, n + 1, n + 2]);
    }
    sticks.room(Vec3::splat(-2.5), Vec3::splat(2.5));
    sticks.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn meshes_are_as_large_as_their_comments_say() {
        let nave = |around: usize, up: usize| 12 + 36 * (2 * around * up + 12) + 24 * 12;
        assert_eq!(hall().triangles(), nave(80, 48) + 700 * 12);
        assert_eq!(clutter().triangles(), nave(64, 40) + 8500 * 12);
        assert_eq!(sticks().triangles(), 300_012);
    }

    #[test]
    fn meshes_are_the_same_each_time() {
        assert_eq!(clutter().vertices, clutter().vertices);
        assert_eq!(sticks().vertices, sticks().vertices);
    }
}
