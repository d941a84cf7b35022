//! Spheres: a ray against a block of four, and where on a sphere it hit.
//!
//! With `f = o - c`, `a = d.d` and `b = -f.d`, the hits are the roots of
//! `a t^2 - 2 b t + (f.f - r^2) = 0`. As school writes them they lose all digits for a sphere that is
//! small and far away, and the nearer root loses them where the ray starts near the surface. So
//! (E. Haines, J. Guenther, T. Akenine-Moeller, "Precision Improvements for Ray/Sphere
//! Intersection", *Ray Tracing Gems*, 2019) the discriminant comes from the distance of the centre
//! from the line, `r^2 - |f + (b / a) d|^2`, and the roots are `q / a` and `(f.f - r^2) / q` with
//! `q = b +- sqrt(a disc)` of one sign; and all of it is done in f64, where what comes in, being f32,
//! leaves 29 bits to spare: four spheres in f64 are one vector, as eight floats are.
//!
//! **Bound.** Let `e = 2^-53`, `D = |f|`. The vector from the centre to the line is off by at most
//! `8 e D`, so spheres down to `r = 2^-40 D` are hit to 13 bits of their radius, more than an f32
//! direction can aim. A distance is rounded to f32 once.
//!
//! **What a hit says.** Not the distance, which far away is coarser than the sphere, but the unit
//! normal at the hit gives the point: `u` and `v` of a hit are its octahedral map (Q. Meyer et al.,
//! "On Floating-Point Normal Vectors", 2010), and the point is `c + r n`.
//!
//! **Leaving a sphere.** A ray that starts on a sphere meets that sphere again only from inside, at
//! the farther root, and then only if it goes inwards, `b > 0`. That is decided without the nearer
//! root, which should be 0 and is not; so a sphere needs no exclusion by index.
//!
//! Input: finite centres and origins, positive finite radii, directions that are not zero. Reads 80
//! bytes a block.

use crate::lanes::{Fx, LANES};
use crate::vec3::Vec3x;
use wide::{f32x4, f64x4, u32x4};

/// Spheres in a block.
pub const BLOCK: usize = 4;

/// A sphere.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Sphere {
    /// Centre.
    pub centre: [f32; 3],
    /// Radius, positive.
    pub radius: f32,
}

/// Four spheres. Unused lanes repeat a used one.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(16))]
pub struct SphereBlock {
    centre: [f32x4; 3],
    radius: f32x4,
    /// What hits are to be called.
    pub primitive: u32x4,
}

impl SphereBlock {
    /// A block of one to [`BLOCK`] spheres: what hits are to be called, and the sphere.
    ///
    /// # Panics
    /// On an empty slice.
    #[must_use]
    pub fn new(spheres: &[(u32, Sphere)]) -> Self {
        let lane = |lane: usize| spheres[lane.min(spheres.len() - 1)];
        let column =
            |of: &dyn Fn(&Sphere) -> f32| f32x4::new(std::array::from_fn(|l| of(&lane(l).1)));
        Self {
            centre: std::array::from_fn(|axis| column(&|s| s.centre[axis])),
            radius: column(&|s| s.radius),
            primitive: u32x4::new(std::array::from_fn(|l| lane(l).0)),
        }
    }
}

/// Distances to four spheres along a ray.
#[derive(Clone, Copy, Debug)]
pub struct Met {
    /// The first hit at `t > 0`; infinite where there is none.
    pub t: [f64; BLOCK],
    /// The hit behind that one, where the first was on the near side; infinite elsewhere.
    pub behind: [f64; BLOCK],
}

fn in_f64(x: f32x4) -> f64x4 {
    f64x4::new(x.to_array().map(f64::from))
}

/// A ray against four spheres. Of those that it `leaves` it meets the far side, if it goes inwards.
#[inline(always)]
#[must_use]
pub fn meet(block: &SphereBlock, origin: [f32; 3], direction: [f32; 3], leaves: u32) -> Met {
    let d = direction.map(|d| f64x4::splat(f64::from(d)));
    let f: [f64x4; 3] = std::array::from_fn(|axis| {
        f64x4::splat(f64::from(origin[axis])) - in_f64(block.centre[axis])
    });
    let dot = |p: &[f64x4; 3], q: &[f64x4; 3]| p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
    let r = in_f64(block.radius);
    let a = dot(&d, &d);
    let b = -dot(&f, &d);
    let along = b / a;
    let aside: [f64x4; 3] = std::array::from_fn(|axis| f[axis] + along * d[axis]);
    let discriminant = r * r - dot(&aside, &aside);
    let root = (a * discriminant.max(f64x4::ZERO)).sqrt();
    let inwards = b.simd_gt(f64x4::ZERO);
    let q = b + inwards.select(root, -root);
    // What is 0 / 0 here starts on the sphere in its tangent plane, and no comparison holds of it.
    let (one, other) = (q / a, (dot(&f, &f) - r * r) / q);
    let (near, far) = (one.fast_min(other), one.fast_max(other));
    let infinite = f64x4::splat(f64::INFINITY);
    let first = near
        .simd_gt(f64x4::ZERO)
        .select(near, far.simd_gt(f64x4::ZERO).select(far, infinite));
    let own = block.primitive.to_array().map(|p| p == leaves);
    let own: f64x4 = bytemuck::cast(own.map(|own| if own { !0u64 } else { 0 }));
    let again = inwards.select(one, infinite);
    let met = discriminant.simd_ge(f64x4::ZERO);
    let two = near.simd_gt(f64x4::ZERO).select(far, infinite);
    Met {
        t: met.select(own.select(again, first), infinite).to_array(),
        behind: met.select(own.select(infinite, two), infinite).to_array(),
    }
}

/// The unit normal of a sphere of a block, outwards, at the hit `t` along a ray: its octahedral map.
#[must_use]
pub fn normal_at(
    block: &SphereBlock,
    lane: usize,
    origin: [f32; 3],
    direction: [f32; 3],
    t: f64,
) -> [f32; 2] {
    let n: [f64; 3] = std::array::from_fn(|axis| {
        let from = f64::from(origin[axis]) - f64::from(block.centre[axis].to_array()[lane]);
        from + t * f64::from(direction[axis])
    });
    encode(n)
}

/// The octahedral map of the direction of `n`, which is not zero.
#[must_use]
pub fn encode(n: [f64; 3]) -> [f32; 2] {
    let sum = n[0].abs() + n[1].abs() + n[2].abs();
    let [x, y] = [n[0] / sum, n[1] / sum];
    if n[2] >= 0.0 {
        [x as f32, y as f32]
    } else {
        let fold = |p: f64, other: f64| ((1.0 - other.abs()).copysign(p)) as f32;
        [fold(x, y), fold(y, x)]
    }
}

/// The unit vectors of octahedral maps, to a few roundings.
#[inline(always)]
#[must_use]
pub fn decode(u: Fx, v: Fx) -> Vec3x {
    let z = Fx::ONE - u.abs() - v.abs();
    let below = z.simd_lt(Fx::ZERO);
    let sign = |p: Fx| p.simd_lt(Fx::ZERO).select(Fx::splat(-1.0), Fx::ONE);
    let fold = |p: Fx, other: Fx| below.select((Fx::ONE - other.abs()) * sign(p), p);
    Vec3x::new(fold(u, v), fold(v, u), z).normalized()
}

/// `LANES` spheres from a table.
#[inline(always)]
#[must_use]
pub fn gather(spheres: &[Sphere], index: [usize; LANES]) -> (Vec3x, Fx) {
    let s = index.map(|i| spheres[i]);
    let column = |axis: usize| Fx::new(s.map(|s| s.centre[axis]));
    (
        Vec3x::new(column(0), column(1), column(2)),
        Fx::new(s.map(|s| s.radius)),
    )
}
