//! Shading normals and texture coordinates of spheres and of copies of objects.
//!
//! A copy is interpolated as if it had been put into the world: its edges by `A`, its corners' normals
//! by the transpose of `B`, of unit length again (`instance.rs` for the letters).
//!
//! *Spheres* have longitude and latitude about their own +y: from the middle of the
//! image, which faces their own +z, `u = 1/2 + atan2(n.x, n.z) / (2 pi)` rises to the east, seen from outside
//! to the right, and `v = 1/2 + asin(n.y) / pi` from the south pole to the north.

use super::maps::{Maps, transform};
use super::{HOME, Others, Part, corners_of};
use crate::interpolate::{Attributes, CornerNormals, Interpolated};
use crate::lanes::{Fx, LANES, Ux, as_bits, as_mask};
use crate::math::INV_PI;
use crate::octahedral;
use crate::sphere;
use crate::surface::Corners;
use crate::tables::Triangles;
use crate::vec3::Vec3x;

impl Interpolated {
    /// The points with barycentric weights `u`, `v` of `primitive`, triangles or not, whose fronts have
    /// the unit normals `outside`; at their `times` if anything moves.
    #[inline(always)]
    #[must_use]
    pub fn met(
        triangles: &Triangles,
        attributes: &Attributes,
        primitive: Ux,
        outside: impl FnOnce() -> Vec3x,
        (u, v): (Fx, Fx),
        times: impl FnOnce() -> Option<Fx>,
    ) -> Self {
        let Some(others) = &triangles.others else {
            return Self::at(triangles, attributes, primitive, u, v);
        };
        if others.are_of_world(primitive) {
            return Self::at(triangles, attributes, primitive, u, v);
        }
        let other = others.interpolate(primitive, outside(), (u, v), times());
        let home = as_mask(primitive.simd_lt(Ux::splat(others.first)));
        if home.none() {
            return other;
        }
        // Lanes that hold none borrow a triangle.
        let own = as_bits(home).select(primitive, Ux::ZERO);
        Self::select(home, &Self::at(triangles, attributes, own, u, v), &other)
    }
}

impl Others<'_> {
    #[inline(never)]
    fn interpolate(
        &self,
        primitive: Ux,
        outside: Vec3x,
        weights: (Fx, Fx),
        times: Option<Fx>,
    ) -> Interpolated {
        let names = primitive.to_array();
        let mut maps = [&HOME; LANES];
        // What is no copy borrows a triangle.
        let mut corners = [[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]; LANES];
        let mut codes = [[octahedral::NONE; LANES]; 3];
        let mut uvs = [[[f32::NAN; LANES]; 2]; 3];
        let mut radius = [1.0; LANES];
        let mut turns = [[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]; LANES];
        for lane in 0..LANES {
            let (vertices, vertex, from) = match self.part(names[lane]) {
                Part::Triangle(_) => continue,
                Part::Copy(instance, i) => {
                    let object = &self.objects[instance.object as usize];
                    maps[lane] = instance;
                    (object.vertices, object.indices[i], &object.attributes)
                }
                Part::Sphere(i) => {
                    radius[lane] = self.spheres[i].radius;
                    if let Some(turn) = self.sphere_turns.get(i) {
                        turns[lane] = *turn;
                    }
                    continue;
                }
            };
            for (k, vertex) in vertex.map(|v| v as usize).into_iter().enumerate() {
                corners[lane][k] = vertices[vertex];
                if let Some(&code) = from.normals.get(vertex) {
                    codes[k][lane] = code;
                }
                if let Some(&uv) = from.uvs.get(vertex) {
                    uvs[k][0][lane] = uv[0];
                    uvs[k][1][lane] = uv[1];
                }
            }
        }
        let maps = match times {
            None => Maps::gather(&maps),
            Some(times) => Maps::gather(&self.moved(&maps, times).0.each_ref()),
        };
        let there = corners_of(&corners);
        let zero = Vec3x::splat([0.0; 3]);
        let there = Corners {
            v0: there.v0,
            e1: transform(maps.to_world, there.e1, zero),
            e2: transform(maps.to_world, there.e2, zero),
        };
        let normals = CornerNormals::decode(codes.map(Ux::new)).turned(|n| maps.normal(n));
        let uvs = uvs.map(|uv| uv.map(Fx::new));
        let all = uvs.as_flattened().iter().map(|x| x.is_finite());
        let all = all.reduce(|a, b| a & b).unwrap_or(Fx::ZERO);
        let on_triangle = Interpolated::of(&there, outside, Some(&normals), (uvs, all), weights);
        let spheres = self.are_spheres(primitive);
        if spheres.none() {
            return on_triangle;
        }
        let turn = (!self.sphere_turns.is_empty()).then(|| Turn::of(&turns));
        let on_sphere = on_sphere(outside, Fx::new(radius), turn);
        Interpolated::select(spheres, &on_sphere, &on_triangle)
    }
}

/// The texture coordinates of directions from the middle of a sphere, unit vectors.
#[inline(always)]
#[must_use]
pub(crate) fn coordinates_on_sphere(n: Vec3x) -> [Fx; 2] {
    let half = Fx::splat(0.5);
    let turn = n.x.atan2(n.z) * Fx::splat(0.5 * INV_PI);
    let height = n.y.fast_max(-Fx::ONE).fast_min(Fx::ONE).asin();
    [turn + half, height.mul_add(Fx::splat(INV_PI), half)]
}

impl Others<'_> {
    /// The texture coordinates of what `sphere.rs` says of a hit, for one point of sphere `i`.
    #[must_use]
    pub(crate) fn coordinates_on_sphere(&self, i: usize, u: f32, v: f32) -> [f32; 2] {
        let mut n = sphere::decode(Fx::splat(u), Fx::splat(v));
        if let Some(turn) = self.sphere_turns.get(i) {
            n = Turn::of(&[*turn; LANES]).to_own(n);
        }
        coordinates_on_sphere(n).map(|x| x.as_array()[0])
    }
}

/// How spheres are turned, one a lane.
#[derive(Clone, Copy)]
struct Turn {
    rows: [Vec3x; 3],
}

impl Turn {
    fn of(turns: &[[[f32; 3]; 3]; LANES]) -> Self {
        let entry = |r: usize, c: usize| Fx::new(turns.map(|turn| turn[r][c]));
        Self {
            rows: [0, 1, 2].map(|r| Vec3x::new(entry(r, 0), entry(r, 1), entry(r, 2))),
        }
    }

    /// A direction of the world as the sphere has it.
    fn to_own(self, v: Vec3x) -> Vec3x {
        let [x, y, z] = self.rows.map(|row| row.dot(v));
        Vec3x::new(x, y, z)
    }

    /// The way back.
    fn to_world(self, v: Vec3x) -> Vec3x {
        let [x, y, z] = self.rows;
        x.scale_add(v.x, y.scale_add(v.y, z * v.z))
    }
}

/// Points of spheres whose unit normals there are `normal`.
fn on_sphere(normal: Vec3x, radius: Fx, turn: Option<Turn>) -> Interpolated {
    let n = turn.map_or(normal, |turn| turn.to_own(normal));
    let uv = coordinates_on_sphere(n);
    let from_axis = (n.x * n.x + n.z * n.z).sqrt();
    let regular = from_axis.simd_gt(Fx::ZERO);
    let by = regular & (Fx::ONE / from_axis);
    let east = Vec3x::new(
        regular.select(n.z * by, Fx::ONE),
        Fx::ZERO,
        regular & -(n.x * by),
    );
    let north = n.cross(east);
    let by_v = Fx::splat(INV_PI) / radius;
    let by_u = by_v * Fx::splat(0.5) * by;
    let uv_per_length = (by_u * by_v).sqrt();
    let back = |v: Vec3x| turn.map_or(v, |turn| turn.to_world(v));
    let (east, north) = (back(east), back(north));
    Interpolated {
        normal,
        coherence: Fx::ONE,
        uv,
        tangent: east,
        bitangent: north,
        gradient_u: east * by_u,
        gradient_v: (north * by_v).keep(regular),
        uv_per_length,
    }
}

impl Interpolated {
    fn select(mask: Fx, a: &Self, b: &Self) -> Self {
        let vector = |of: fn(&Self) -> Vec3x| Vec3x::select(mask, of(a), of(b));
        let number = |of: fn(&Self) -> Fx| mask.select(of(a), of(b));
        Self {
            normal: vector(|p| p.normal),
            coherence: number(|p| p.coherence),
            uv: [number(|p| p.uv[0]), number(|p| p.uv[1])],
            tangent: vector(|p| p.tangent),
            bitangent: vector(|p| p.bitangent),
            gradient_u: vector(|p| p.gradient_u),
            gradient_v: vector(|p| p.gradient_v),
            uv_per_length: number(|p| p.uv_per_length),
        }
    }
}
