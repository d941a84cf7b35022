//! Shading tables of what is no triangle of the world: spheres and copies of objects.
//!
//! Hits are numbered as `levels.rs` says: triangles of the world, spheres, triangles of instances.
//!
//! **A point on a copy** is `A p + c` for `p` of the object's triangle, and the normal there that of
//! the triangle times the transpose of `B`, since `n.x` must stay what it is (`instance.rs` for the
//! letters). A map that mirrors leaves the front of a triangle its front.
//!
//! **Spawning** (see `surface.rs` for the method). With `s` the scale of the error in the object
//! and `w = p_w - c`, the error of a point of the world, and of what a ray from there sees, is at
//! most `gamma(28)` times `|A| (s + |B| |w|) + |c|`: 10 for the point (`instance.rs`), 1 for the
//! rounding of the sum, 6 for the normal, its transformation and length, 4 for the ray's origin in
//! the object, 7 for the triangle test there. The direction adds `gamma(3) |B| |d|` over a length
//! that within the object's box is at most twice what `w` can be: 6 more. So rays start `gamma(40)`
//! times that along the normal.
//!
//! **A point on a sphere** is `c + r n`, off by at most `gamma(5) (|c| + r |n|)`: `n` comes with 4
//! roundings (`sphere.rs`).

mod interpolate;
mod maps;

use crate::instance::{Guide, Instance, OWN_MATERIAL};
use crate::interpolate::Attributes;
use crate::lanes::{Fx, LANES, Mask, Ux, as_bits, as_mask};
use crate::motion::{Motion, ROUNDINGS, STILL};
use crate::sphere::{self, Sphere};
use crate::surface::{Corners, Place, clearance, gamma};
use crate::tables::Triangles;
use crate::vec3::Vec3x;
use maps::{Maps, transform};

/// The triangles of an object, in its own space.
#[derive(Clone, Copy, Debug)]
pub struct Object<'a> {
    /// Vertex positions.
    pub vertices: &'a [[f32; 3]],
    /// Vertices of each triangle.
    pub indices: &'a [[u32; 3]],
    /// Material of each triangle.
    pub material: &'a [u32],
    /// What vertices carry besides.
    pub attributes: Attributes<'a>,
}

/// What a number behind those of the world's triangles means.
#[derive(Clone, Copy, Debug)]
pub enum Home<'a> {
    /// A sphere, by its index.
    Sphere(usize),
    /// A triangle of an object, by its index there.
    Object(&'a Object<'a>, usize),
}

/// All that is no triangle of the world.
#[derive(Clone, Copy, Debug)]
pub struct Others<'a> {
    /// What the first sphere is called: how many triangles the world has.
    pub first: u32,
    /// Spheres.
    pub spheres: &'a [Sphere],
    /// Material of each sphere.
    pub sphere_material: &'a [u32],
    /// Rows of the rotation from directions of the world to each sphere's own; empty where all are those of
    /// the world.
    pub sphere_turns: &'a [[[f32; 3]; 3]],
    /// Probability with which next-event estimation selects each sphere.
    pub sphere_selection: &'a [f32],
    /// Instances, by rising number of the first triangle.
    pub instances: &'a [Instance],
    /// How some of them move.
    pub motions: &'a [Motion],
    /// Finds them.
    pub guide: &'a Guide,
    /// Objects.
    pub objects: &'a [Object<'a>],
}

/// What a number means.
enum Part<'a> {
    Triangle(usize),
    Sphere(usize),
    Copy(&'a Instance, usize),
}

/// Where the triangles of the world are: where they are.
static HOME: Instance = {
    const IDENTITY: [[f32; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    Instance {
        to_object: IDENTITY,
        to_world: IDENTITY,
        origin: [0.0; 3],
        first: 0,
        object: 0,
        material: OWN_MATERIAL,
        root: 0,
        motion: STILL,
        extent: 0.0,
        spare: [0; 5],
    }
};

impl Others<'_> {
    #[inline(always)]
    fn part(&self, primitive: u32) -> Part<'_> {
        if primitive < self.first {
            return Part::Triangle(primitive as usize);
        }
        let i = (primitive - self.first) as usize;
        if i < self.spheres.len() {
            return Part::Sphere(i);
        }
        let instance = &self.instances[self.guide.find(self.instances, primitive)];
        Part::Copy(instance, (primitive - instance.first) as usize)
    }

    /// The material of what is called `primitive`, where it is no triangle of the world.
    ///
    /// # Panics
    /// If nothing is called so.
    #[must_use]
    pub fn material_of(&self, primitive: u32) -> u32 {
        match self.part(primitive) {
            Part::Triangle(_) => unreachable!("its material stands in the table"),
            Part::Sphere(i) => self.sphere_material[i],
            Part::Copy(instance, i) => match instance.material {
                OWN_MATERIAL => self.objects[instance.object as usize].material[i],
                worn => worn,
            },
        }
    }

    /// Where what is called `primitive`, and is no triangle of the world, has its tables.
    ///
    /// # Panics
    /// If nothing is called so.
    #[must_use]
    pub fn home(&self, primitive: u32) -> Home<'_> {
        match self.part(primitive) {
            Part::Triangle(_) => unreachable!("it is one of the world"),
            Part::Sphere(i) => Home::Sphere(i),
            Part::Copy(instance, i) => Home::Object(&self.objects[instance.object as usize], i),
        }
    }

    /// Where instances are at their moments, and what their points are off by.
    pub(crate) fn moved(&self, maps: &[&Instance; LANES], times: Fx) -> ([Instance; LANES], Fx) {
        let mut roundings = [gamma(40.0); LANES];
        let moved = std::array::from_fn(|lane| match maps[lane].motion {
            STILL => *maps[lane],
            motion => {
                roundings[lane] = gamma(ROUNDINGS);
                self.motions[motion as usize].placed(maps[lane], times.as_array()[lane])
            }
        });
        (moved, Fx::new(roundings))
    }

    /// Whether something is a sphere.
    #[inline]
    #[must_use]
    pub fn is_sphere(&self, primitive: u32) -> bool {
        let i = primitive.checked_sub(self.first);
        i.is_some_and(|i| (i as usize) < self.spheres.len())
    }

    /// Lanes that hold spheres.
    #[inline(always)]
    #[must_use]
    pub fn are_spheres(&self, primitive: Ux) -> Mask {
        let end = self.first + self.spheres.len() as u32;
        as_mask(!primitive.simd_lt(Ux::splat(self.first)) & primitive.simd_lt(Ux::splat(end)))
    }

    /// The octahedral maps of the directions in which points lie from the centres of spheres `primitive`;
    /// of lanes that hold none, of some direction.
    pub(crate) fn normal_towards(&self, primitive: Ux, point: Vec3x) -> [Fx; 2] {
        let names = primitive.to_array();
        let codes: [[f32; 2]; LANES] = std::array::from_fn(|lane| {
            let ball = names[lane].checked_sub(self.first);
            let ball = ball.and_then(|i| self.spheres.get(i as usize));
            let at = point.lane(lane);
            let from =
                |ball: &Sphere| [0, 1, 2].map(|k| f64::from(at[k]) - f64::from(ball.centre[k]));
            let from = ball.map(from).filter(|n| *n != [0.0; 3]);
            sphere::encode(from.unwrap_or([0.0, 0.0, 1.0]))
        });
        [0, 1].map(|k| Fx::new(codes.map(|code| code[k])))
    }

    /// Whether all lanes hold triangles of the world. Those are found here and there by one arithmetic, so
    /// that it does not show which lanes a hit shares a vector with.
    #[inline(always)]
    #[must_use]
    pub fn are_of_world(&self, primitive: Ux) -> bool {
        as_mask(primitive.simd_lt(Ux::splat(self.first))).all()
    }

    /// Where hits are, whatever was hit, at their `times` if anything moves.
    #[inline(never)]
    #[must_use]
    pub fn place(
        &self,
        triangles: &Triangles,
        primitive: Ux,
        u: Fx,
        v: Fx,
        times: Option<Fx>,
    ) -> Place {
        let names = primitive.to_array();
        let mut material = [0; LANES];
        let mut maps = [&HOME; LANES];
        // Spheres borrow a triangle, and others a sphere, so that all lanes are in range.
        let mut corners = [[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]; LANES];
        let mut balls = [Sphere {
            centre: [0.0; 3],
            radius: 1.0,
        }; LANES];
        for lane in 0..LANES {
            match self.part(names[lane]) {
                Part::Triangle(i) => {
                    corners[lane] = triangles.indices[i].map(|v| triangles.vertices[v as usize]);
                    material[lane] = triangles.material[i];
                }
                Part::Sphere(i) => {
                    balls[lane] = self.spheres[i];
                    material[lane] = self.sphere_material[i];
                }
                Part::Copy(instance, i) => {
                    let object = &self.objects[instance.object as usize];
                    corners[lane] = object.indices[i].map(|v| object.vertices[v as usize]);
                    maps[lane] = instance;
                    material[lane] = match instance.material {
                        OWN_MATERIAL => object.material[i],
                        worn => worn,
                    };
                }
            }
        }
        let first = names.map(|name| name < self.first);
        let home: Mask = as_mask(Ux::new(first.map(|home| if home { !0 } else { 0 })));
        let copies = self.first + self.spheres.len() as u32;
        let on_triangle = match times {
            _ if names.iter().all(|&name| name < copies) => corners_of(&corners).place(u, v),
            None => copied(&corners, &maps, home, u, v, Fx::splat(gamma(40.0))),
            Some(times) => {
                let (moved, roundings) = self.moved(&maps, times);
                let maps = moved.each_ref();
                copied(&corners, &maps, home, u, v, roundings)
            }
        };
        let spheres = self.are_spheres(primitive);
        let place = if spheres.to_bitmask() == 0 {
            on_triangle
        } else {
            Place::select(spheres, on_sphere(&balls, u, v), on_triangle)
        };
        Place {
            material: Ux::new(material),
            ..place
        }
    }
}

impl Place {
    fn select(mask: Mask, a: Self, b: Self) -> Self {
        Self {
            point: Vec3x::select(mask, a.point, b.point),
            outside: Vec3x::select(mask, a.outside, b.outside),
            clearance: mask.select(a.clearance, b.clearance),
            material: as_bits(mask).select(a.material, b.material),
        }
    }
}

/// Corners from places of lanes.
#[inline(always)]
fn corners_of(corners: &[[[f32; 3]; 3]; LANES]) -> Corners {
    let vertex = |k: usize| {
        let column = |axis: usize| Fx::new(std::array::from_fn(|lane| corners[lane][k][axis]));
        Vec3x::new(column(0), column(1), column(2))
    };
    let v0 = vertex(0);
    Corners {
        v0,
        e1: vertex(1) - v0,
        e2: vertex(2) - v0,
    }
}

/// Points on triangles of objects, off by `roundings` times the scale of their error; where `home`,
/// exactly what they are without others.
#[inline(always)]
fn copied(
    corners: &[[[f32; 3]; 3]; LANES],
    maps: &[&Instance; LANES],
    home: Mask,
    u: Fx,
    v: Fx,
    roundings: Fx,
) -> Place {
    let corners = corners_of(corners);
    let maps = Maps::gather(maps);
    let Maps {
        to_world,
        to_object,
        origin,
        ..
    } = maps;
    let whole = corners.place(u, v);
    let (p, s) = corners.point(u, v);
    let point = transform(to_world, p, origin);
    let outside = maps.normal(whole.outside);
    let seen = transform(to_object.map(Vec3x::abs), (point - origin).abs(), s);
    let error = transform(to_world.map(Vec3x::abs), seen, origin.abs());
    let clearance = outside.abs().dot(error) * roundings;
    let copy = Place {
        point,
        outside,
        clearance,
        material: Ux::ZERO,
    };
    Place::select(home, whole, copy)
}

/// Points on spheres.
#[inline(always)]
fn on_sphere(spheres: &[Sphere; LANES], u: Fx, v: Fx) -> Place {
    let (centre, radius) = sphere::gather(spheres, std::array::from_fn(|lane| lane));
    let outside = sphere::decode(u, v);
    let error = outside.abs().scale_add(radius, centre.abs());
    Place {
        point: outside.scale_add(radius, centre),
        outside,
        clearance: clearance(error, outside),
        material: Ux::ZERO,
    }
}
