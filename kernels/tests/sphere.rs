//! Rays against spheres: tiny, huge, far away, from inside, and starting on them.

use huygens_kernels::lanes::{Fx, LANES};
use huygens_kernels::sphere::{Sphere, SphereBlock, decode, encode, meet, normal_at};

/// SplitMix64 (G. Steele et al., 2014), as numbers in [-1, 1).
struct Random(u64);

impl Random {
    fn signed(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    fn direction(&mut self) -> [f64; 3] {
        loop {
            let v: [f64; 3] = std::array::from_fn(|_| self.signed());
            let l2: f64 = v.iter().map(|c| c * c).sum();
            if l2 > 1e-3 && l2 <= 1.0 {
                return v.map(|c| c / l2.sqrt());
            }
        }
    }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|k| a[k] * b[k]).sum()
}

fn one(sphere: Sphere, o: [f32; 3], d: [f32; 3], leaves: u32) -> Option<f64> {
    let t = meet(&SphereBlock::new(&[(5, sphere)]), o, d, leaves).t[0];
    (t < f64::INFINITY).then_some(t)
}

#[test]
fn hits_lie_on_the_sphere_whatever_its_size_and_distance() {
    let mut random = Random(1);
    for exponent in -30..=30 {
        let radius = (2f64.powi(exponent)) as f32;
        for far in [0.5, 2.0, 100.0, 1e4, 1e6] {
            for _ in 0..20 {
                let centre = random.direction().map(|c| (0.3 * c) as f32 * radius);
                let sphere = Sphere { centre, radius };
                let from = random.direction();
                let o = std::array::from_fn(|k| centre[k] + (from[k] * far) as f32 * radius);
                // At a point well inside the disc that is seen.
                let aside = random.direction();
                let d: [f32; 3] = std::array::from_fn(|k| {
                    let to = f64::from(centre[k]) + 0.5 * aside[k] * f64::from(radius);
                    (to - f64::from(o[k])) as f32
                });
                let t = one(sphere, o, d, u32::MAX);
                let p = |t: f64| -> [f64; 3] {
                    std::array::from_fn(|k| {
                        f64::from(o[k]) + t * f64::from(d[k]) - f64::from(centre[k])
                    })
                };
                let r = f64::from(radius);
                let distance = dot(p(0.0), p(0.0)).sqrt();
                let t = t.expect("aimed at");
                // The line is off by 8 e D; seen under half the radius aside, the depth by no more
                // than twice that.
                let bound = 32.0 * 2f64.powi(-53) * (distance + r);
                let miss = (dot(p(t), p(t)).sqrt() - r).abs();
                assert!(miss <= bound, "r {r}, D {distance}: off by {miss}");
                // No nearer hit: half way there the ray is still on the side where it started.
                let outside = distance > r;
                assert_eq!(dot(p(0.5 * t), p(0.5 * t)).sqrt() > r, outside);
            }
        }
    }
}

#[test]
fn rays_that_pass_by_miss_and_those_from_behind_too() {
    let sphere = Sphere {
        centre: [0.0, 0.0, 5.0],
        radius: 1.0,
    };
    let miss = |o, d| assert_eq!(one(sphere, o, d, u32::MAX), None);
    miss([0.0; 3], [0.0, 0.0, -1.0]);
    miss([1.0f32.next_up(), 0.0, 0.0], [0.0, 0.0, 1.0]);
    miss([0.0, -3.0, 5.0], [0.0, -0.0, 1.0]);
    // Touching is hitting, and from inside the far side is hit.
    assert_eq!(one(sphere, [1.0, 0.0, 0.0], [0.0, 0.0, 2.0], 0), Some(2.5));
    assert_eq!(one(sphere, [0.0, 0.0, 5.5], [0.0, -0.0, 1.0], 0), Some(0.5));
}

#[test]
fn a_ray_that_leaves_a_sphere_meets_it_again_only_from_inside() {
    let mut random = Random(2);
    for scale in [1e-6f32, 1.0, 1e6] {
        let sphere = Sphere {
            centre: [0.25 * scale, -0.5 * scale, 0.125 * scale],
            radius: scale,
        };
        for _ in 0..2000 {
            let (n, d) = (random.direction(), random.direction());
            let o: [f32; 3] =
                std::array::from_fn(|k| sphere.centre[k] + n[k] as f32 * sphere.radius);
            let f: [f64; 3] =
                std::array::from_fn(|k| f64::from(o[k]) - f64::from(sphere.centre[k]));
            let d32 = d.map(|c| c as f32);
            let d64 = d32.map(f64::from);
            let again = one(sphere, o, d32, 5);
            if dot(f, d64) >= 0.0 {
                assert_eq!(again, None);
            } else {
                // A chord: with c = 2 off r, how far the rounded start's power is from 0, the far
                // root is off by c / b at most, half the chord being b; and a chord that is missed
                // altogether has b^2 < c.
                let chord = -2.0 * dot(f, d64) / dot(d64, d64);
                let off = (dot(f, f).sqrt() - f64::from(scale)).abs();
                let t = again.unwrap_or(0.0);
                let slack = 8.0 * off * f64::from(scale) / chord + off;
                assert!((t - chord).abs() <= slack, "{t} {chord} {slack}");
            }
        }
    }
}

#[test]
fn the_octahedral_map_gives_every_normal_back() {
    let mut random = Random(3);
    let mut normals: Vec<[f64; 3]> = (0..4000).map(|_| random.direction()).collect();
    for axis in 0..3 {
        for sign in [1.0, -1.0] {
            let mut n = [0.0, -0.0, 0.0];
            n[axis] = sign;
            normals.push(n);
        }
    }
    for n in normals {
        let [u, v] = encode(n);
        let back = decode(Fx::splat(u), Fx::splat(v)).lane(LANES - 1);
        for k in 0..3 {
            // Rounding of u and v, of z by two differences, and of the scaling by at most sqrt(3).
            let bound = 16.0 * f64::from(f32::EPSILON);
            assert!((f64::from(back[k]) - n[k]).abs() <= bound, "{n:?} {back:?}");
        }
    }
}

#[test]
fn the_normal_at_a_hit_is_right_where_the_distance_is_coarse() {
    // A sphere of radius 0.01 seen from a million away: a rounding of t is six times its radius.
    let sphere = Sphere {
        centre: [0.0; 3],
        radius: 0.01,
    };
    let block = SphereBlock::new(&[(0, sphere)]);
    let (o, d) = ([0.005, 0.0, -1e6], [0.0, 0.0, 1.0]);
    let t = meet(&block, o, d, u32::MAX).t[3];
    let [u, v] = normal_at(&block, 3, o, d, t);
    let n = decode(Fx::splat(u), Fx::splat(v)).lane(0);
    let x = f64::from(0.005f32) / f64::from(0.01f32);
    let expected = [x, 0.0, -(1.0 - x * x).sqrt()];
    for k in 0..3 {
        // The depth, not the offset aside, carries the error of the line: 8 e D / r.
        let bound = 16.0 * f64::from(f32::EPSILON) + 16.0 * 2f64.powi(-53) * 1e8;
        assert!((f64::from(n[k]) - expected[k]).abs() <= bound, "{n:?}");
    }
}
