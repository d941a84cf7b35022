//! Shading normals and texture coordinates at hits.
//!
//! *Interpolation*: a triangle whose three corners have a normal gets their mixture by barycentric
//! weights (B. T. Phong, CACM 18(6), 1975), of unit length and on the side of its front, whichever
//! way the file wound it; otherwise, or where they cancel, its geometric normal. (u, v) are mixed
//! alike; 0 where a corner has none.
//!
//! *Tangent frame*: the directions in which u and v rise, from the triangle's edges, made
//! perpendicular to the normal; where (u, v) are degenerate, any frame about it. It is constant
//! over a triangle (not MikkTSpace's, which mixes tangents of vertices).
//!
//! *Normal maps*: `x T + y B + z N`. *Bump maps*: the height `h` displaces the surface along its
//! normal, and to first order in it the normal becomes `N - dh/du grad u - dh/dv grad v` (J. Blinn,
//! "Simulation of Wrinkled Surfaces", SIGGRAPH 1978), with the gradients of u and v in the
//! triangle's plane.
//!
//! *No black edges in mirrors* ([`towards`]): near silhouettes, the direction that mirrors omega_o in
//! the shading normal can point into the surface. There the normal is bent to the one that mirrors
//! it to just above the horizon, in the same plane (A. Keller et al., "The Iray Light Transport
//! Simulation and Rendering System", 2017, A.3). The normal then always faces omega_o, and its
//! mirror direction lies outside of the surface.
//!
//! *No black edges at the terminator* ([`terminator`]): where the shading normal still sees a light
//! and the triangle does not, light would end at triangles' edges. Diffuse reflection is multiplied
//! by a factor that falls smoothly to 0 before the triangle's horizon: that of M. J.-Y. Chiang,
//! Y. K. Li, B. Burley ("Taming the Shadow Terminator", SIGGRAPH Talks 2019), `-G^3 + G^2 + G` with
//! `G = cos_g / (cos_n cos_gn)`, but where they take the triangle's normal, of which edges would still
//! show, here stands the least favourable one of all within the cone about the shading normal that
//! the corners' normals span (the idea of A. Reshetov, A. Soupikov, W. Mark, "Consistent Normal
//! Interpolation", SIGGRAPH Asia 2010), `1 - tan theta_i tan alpha`, and `G` is twice that, at most
//! 1: light near the normal is left alone. The cone's `cos alpha` is the height of the corners'
//! mixture above the triangle, before it is made of unit length; it is the same on both sides of an
//! edge where a mesh bends evenly. No ray's origin is moved, so light
//! cannot leak; and a direction below the triangle's plane carries no reflected light at all, which
//! is for the caller to see to.

use crate::hemisphere::to_world;
use crate::lanes::{Fx, Mask, Ux, gather_rows};
use crate::octahedral;
use crate::surface::Corners;
use crate::tables::Triangles;
use crate::vec3::Vec3x;

/// What vertices carry besides their position.
#[derive(Clone, Copy, Debug)]
pub struct Attributes<'a> {
    /// Codes ([`octahedral`]) of the normals of the first so many vertices; may be empty.
    pub normals: &'a [u32],
    /// (u, v) of the first so many vertices, NaN for none; may be empty.
    pub uvs: &'a [[f32; 2]],
}

/// `LANES` points of surfaces as their fronts see them.
#[derive(Clone, Copy, Debug)]
pub struct Interpolated {
    /// Unit shading normal on the front side.
    pub normal: Vec3x,
    /// Length of the mixture of the corners' normals, at most 1: how well they agree. 1 where the
    /// normal is the geometric one. For [`terminator`].
    pub coherence: Fx,
    /// Texture coordinates; 0 without any.
    pub uv: [Fx; 2],
    /// Unit vector in the triangle's plane, roughly, in which u rises at equal v; perpendicular to
    /// `normal`.
    pub tangent: Vec3x,
    /// The same for v, perpendicular to both.
    pub bitangent: Vec3x,
    /// Gradient of u over the triangle's plane, one over scene units; 0 where degenerate.
    pub gradient_u: Vec3x,
    /// The same for v.
    pub gradient_v: Vec3x,
    /// Lengths in (u, v) for a length on the surface, in the mean over directions (the root of the
    /// areas' ratio); 0 where degenerate.
    pub uv_per_length: Fx,
}

impl Interpolated {
    /// The points with barycentric weights `u`, `v` of triangles `primitive` of the world.
    #[inline]
    #[must_use]
    pub fn at(triangles: &Triangles, attributes: &Attributes, primitive: Ux, u: Fx, v: Fx) -> Self {
        let corners = Corners::gather(triangles, primitive);
        let flat = corners.unit_normal();
        let vertex = gather_rows(triangles.indices, primitive);
        let normals = CornerNormals::gather(attributes.normals, &vertex);
        let uvs = gather_uvs(attributes.uvs, &vertex);
        Self::of(&corners, flat, normals.as_ref(), uvs, (u, v))
    }

    /// The points with barycentric weights `u`, `v` of triangles with these corners, of which `flat` are
    /// the fronts' unit normals; (u, v) of corners count where all are there.
    #[inline(always)]
    #[must_use]
    pub(crate) fn of(
        corners: &Corners,
        flat: Vec3x,
        normals: Option<&CornerNormals>,
        (uvs, has): ([[Fx; 2]; 3], Mask),
        (u, v): (Fx, Fx),
    ) -> Self {
        let (normal, coherence) = mixed_normal(normals, u, v, flat);
        let along = |i: usize| (uvs[1][i] - uvs[0][i], uvs[2][i] - uvs[0][i]);
        let ((du1, du2), (dv1, dv2)) = (along(0), along(1));
        let uv = std::array::from_fn(|i| {
            let (d1, d2) = along(i);
            has & d2.mul_add(v, d1.mul_add(u, uvs[0][i]))
        });
        let scale = corners.scale();
        let (e1, e2) = (corners.e1 * scale, corners.e2 * scale);
        // Up to the determinant's sign, the derivatives of the position by u and v.
        let p_u = e1 * dv2 - e2 * dv1;
        let p_v = e2 * du1 - e1 * du2;
        let determinant = du1.mul_sub(dv2, du2 * dv1);
        let regular = has & determinant.abs().simd_gt(Fx::ZERO) & determinant.is_finite();
        // Below 0 where a copy is mirrored.
        let area = e1.cross(e2).dot(flat);
        let by_area = Fx::ONE / area;
        let frame = Frame::about(normal, p_u, determinant, area, regular);
        Self {
            normal,
            coherence,
            uv,
            tangent: frame.tangent,
            bitangent: frame.bitangent,
            gradient_u: (p_v.cross(flat) * (by_area * scale)).keep(regular),
            gradient_v: (flat.cross(p_u) * (by_area * scale)).keep(regular),
            uv_per_length: regular & ((determinant * by_area).abs().sqrt() * scale),
        }
    }

    /// The front's shading normal bent by a texel of a normal map, whose x and y are first multiplied
    /// by `strength`.
    #[inline]
    #[must_use]
    pub fn mapped(&self, texel: Vec3x, strength: Fx) -> Vec3x {
        let component = |c: Fx| c + c - Fx::ONE;
        let (x, y) = (component(texel.x) * strength, component(texel.y) * strength);
        let bent = self
            .bitangent
            .scale_add(y, self.normal * component(texel.z));
        unit_or(self.tangent.scale_add(x, bent), self.normal)
    }

    /// The front's shading normal bent by a height whose derivatives by u and v are given in scene
    /// units.
    #[inline]
    #[must_use]
    pub fn bumped(&self, by_u: Fx, by_v: Fx) -> Vec3x {
        let slope = self.gradient_v.scale_add(by_v, self.gradient_u * by_u);
        unit_or(self.normal - slope, self.normal)
    }
}

/// Unit vectors that go with a normal.
struct Frame {
    tangent: Vec3x,
    bitangent: Vec3x,
}

impl Frame {
    /// Along `p_u`, which the sign of `determinant` belongs to, where it is `regular`; turned as the
    /// signs of `determinant` and `area` say.
    #[inline(always)]
    fn about(normal: Vec3x, p_u: Vec3x, determinant: Fx, area: Fx, regular: Mask) -> Self {
        let sign_of = |x: Fx| (x & Fx::splat(-0.0)) | Fx::ONE;
        let sign = sign_of(determinant);
        let along = p_u * sign;
        let along = normal.scale_add(-normal.dot(along), along);
        let length2 = along.dot(along);
        let regular = regular & length2.simd_gt(Fx::ZERO) & length2.is_finite();
        let some = to_world(normal, Vec3x::splat([1.0, 0.0, 0.0]));
        let tangent = Vec3x::select(regular, along * (Fx::ONE / length2.sqrt()), some);
        let handed = regular.select(sign * sign_of(area), Fx::ONE);
        Self {
            tangent,
            bitangent: normal.cross(tangent) * handed,
        }
    }
}

/// Unit normals of three corners, where all three have one.
pub(crate) struct CornerNormals {
    at: [Vec3x; 3],
    some: Mask,
}

impl CornerNormals {
    /// Of codes.
    #[inline(always)]
    pub(crate) fn decode(code: [Ux; 3]) -> Self {
        let [a, b, c] = code.map(octahedral::is_some);
        Self {
            at: code.map(octahedral::decode),
            some: a & b & c,
        }
    }

    /// As `turn` leaves each of them.
    #[inline(always)]
    pub(crate) fn turned(self, turn: impl Fn(Vec3x) -> Vec3x) -> Self {
        Self {
            at: self.at.map(turn),
            ..self
        }
    }

    #[inline(always)]
    fn gather(normals: &[u32], vertex: &[Ux; 3]) -> Option<Self> {
        if normals.is_empty() {
            return None;
        }
        Some(Self::decode(vertex.map(|vertex| {
            let vertex = vertex.to_array();
            Ux::new(std::array::from_fn(|lane| {
                let stored = normals.get(vertex[lane] as usize);
                stored.copied().unwrap_or(octahedral::NONE)
            }))
        })))
    }
}

/// The mixture of three corners' normals on the side of `flat`, of unit length, and its length before
/// that; or `flat` itself and 1.
#[inline(always)]
fn mixed_normal(normals: Option<&CornerNormals>, u: Fx, v: Fx, flat: Vec3x) -> (Vec3x, Fx) {
    let Some(normals) = normals else {
        return (flat, Fx::ONE);
    };
    let [a, b, c] = normals.at;
    let mixed = c.scale_add(v, b.scale_add(u, a * (Fx::ONE - u - v)));
    let facing = Vec3x::select(mixed.dot(flat).simd_lt(Fx::ZERO), -mixed, mixed);
    let length = facing.dot(facing).sqrt();
    let sound = normals.some & length.simd_gt(Fx::ZERO);
    let normal = Vec3x::select(sound, facing * (Fx::ONE / length), flat);
    (normal, sound.select(length.fast_min(Fx::ONE), Fx::ONE))
}

/// The (u, v) of three corners, and where all of them are there.
#[inline(always)]
fn gather_uvs(uvs: &[[f32; 2]], vertex: &[Ux; 3]) -> ([[Fx; 2]; 3], Mask) {
    if uvs.is_empty() {
        return ([[Fx::ZERO; 2]; 3], Fx::ZERO);
    }
    let corner = |vertex: &Ux| {
        let vertex = vertex.to_array();
        let rows = vertex.map(|i| uvs.get(i as usize).copied().unwrap_or([f32::NAN; 2]));
        [0, 1].map(|i| Fx::new(rows.map(|row| row[i])))
    };
    let corners: [[Fx; 2]; 3] = std::array::from_fn(|k| corner(&vertex[k]));
    let all = corners.iter().flatten().map(|x| x.is_finite());
    let all = all.reduce(|a, b| a & b).unwrap_or(Fx::ZERO);
    (corners, all)
}

/// `v` of unit length; `otherwise` where it has no direction.
#[inline(always)]
fn unit_or(v: Vec3x, otherwise: Vec3x) -> Vec3x {
    let length2 = v.dot(v);
    let sound = length2.simd_gt(Fx::ZERO) & length2.is_finite();
    Vec3x::select(sound, v * (Fx::ONE / length2.sqrt()), otherwise)
}

/// Share of the cosine between omega_o and the geometric normal that a mirror direction has at
/// least, on the same normal: enough for rounding (2^-21 or so) where that cosine is above 2^-14,
/// and too little to see.
pub const HORIZON: f32 = 1.0 / 64.0;

/// The shading normal for light that leaves along the unit vector `omega_o`: `shading` (unit, on
/// `geometric`'s side, as interpolated and bent by maps), bent on where the direction that mirrors
/// omega_o in it would leave the unit geometric normal's hemisphere. `geometric` is on the side of
/// omega_o.
///
/// A unit vector with a positive cosine to omega_o; where that of omega_o to `geometric` is above
/// 2^-14, the mirror direction is on `geometric`'s side, and where it is above 2^-10, its cosine is at
/// least half of [`HORIZON`] times that.
#[inline]
#[must_use]
pub fn towards(shading: Vec3x, geometric: Vec3x, omega_o: Vec3x) -> Vec3x {
    let up = geometric.dot(omega_o);
    let least = up * Fx::splat(HORIZON);
    // Heights of the mirror direction above the horizon: as it is, and what it shall be at least.
    let mirror_up = |cos: Fx, shading_up: Fx| (cos + cos).mul_sub(shading_up, up);
    let (cos, shading_up) = (shading.dot(omega_o), shading.dot(geometric));
    let sound = cos.simd_gt(Fx::ZERO)
        & shading_up.simd_gt(Fx::ZERO)
        & mirror_up(cos, shading_up).simd_ge(least);
    if sound.all() {
        return shading;
    }
    // A normal below the horizon (only maps and broken files make one) is first raised to it.
    let shading_up = shading_up.fast_max(Fx::ZERO);
    let n_t = geometric.scale_add(-shading.dot(geometric), shading);
    let above = shading_up.simd_gt(Fx::ZERO);
    let level = unit_or(n_t, Vec3x::splat([0.0; 3]));
    // Once more, for what a short part has left of the normal.
    let level = geometric.scale_add(-level.dot(geometric), level);
    let n_t = Vec3x::select(above, n_t, level);
    let cos = above.select(cos, n_t.dot(omega_o)).fast_max(Fx::ZERO);
    let height = mirror_up(cos, shading_up);
    // The half vector of omega_o and the lifted direction, whose part along the horizon is that of
    // the mirror direction, `2 cos n_t - o_t`, shortened from m to q. As the sum of the two vectors
    // it would cancel near the horizon.
    let o_t = geometric.scale_add(-up, omega_o);
    let m_t = n_t * (cos + cos) - o_t;
    let m = m_t.dot(m_t).sqrt();
    let q = (Fx::ONE - least * least).sqrt();
    let back = (least * least - height * height) / (m * (m + q));
    let along = n_t.scale_add((cos + cos) * q / m, o_t * back);
    let bent = unit_or(geometric.scale_add(up + least, along), geometric);
    Vec3x::select(sound, shading, bent)
}

/// What diffuse reflection into the unit vector `omega_i` is multiplied with at a surface with these
/// unit normals, all on one side, and [`Interpolated::coherence`]. In 0..=1; 0 where `omega_i` lies
/// below the geometric surface; 1, but for rounding, where the corners' normals are the same.
#[inline]
#[must_use]
pub fn terminator(shading: Vec3x, geometric: Vec3x, omega_i: Vec3x, coherence: Fx) -> Fx {
    let cos_alpha = shading.dot(geometric) * coherence;
    let cos = shading.dot(omega_i);
    let square_of_sine = |cos: Fx| cos.mul_neg_add(cos, Fx::ONE).fast_max(Fx::ZERO);
    let product = cos * cos_alpha;
    let sines = (square_of_sine(cos) * square_of_sine(cos_alpha)).sqrt();
    let g = (product - sines) / product;
    let g = (g + g).fast_max(Fx::ZERO).fast_min(Fx::ONE);
    let factor = g * (g * (Fx::ONE - g) + Fx::ONE);
    let lit = product.simd_gt(Fx::ZERO)
        & cos.simd_gt(Fx::ZERO)
        & geometric.dot(omega_i).simd_gt(Fx::ZERO);
    lit & factor
}
