//! What the oracle sees at a hit: images, shading normals and what bends them, in f64 and by the
//! formulas of `huygens_kernels::{interpolate, texture}`, of which it shares no code. Images are read
//! without mip levels.

use super::carried::Carried;
use super::vector;
use crate::scene::material::{Channel, Material, Relief, TexelFilter, TextureUse, Textured, Wrap};
use crate::scene::texture::{TexelFormat, Texture};
use crate::scene::{Mesh, Scene};
use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// Share of the geometric cosine of omega_o that a mirror direction has at least.
const HORIZON: f64 = 1.0 / 64.0;

/// A point of a surface, as its front sees it.
pub(super) struct Point {
    pub(super) uv: DVec2,
    /// Unit shading normal on the front side.
    pub(super) normal: DVec3,
    /// Length of the mixture of the corners' normals.
    pub(super) coherence: f64,
    /// Where u rises, perpendicular to the normal before any map bends it; of any length.
    pub(super) along: Option<DVec3>,
}

impl Point {
    /// The point of a triangle, whose front has unit normal `flat`, with these barycentric weights of
    /// the second and third corner, as `material` shows it.
    #[inline(never)] // keeps what the recursion puts on the stack small
    pub(super) fn new(
        scene: &Scene,
        corners: &Carried,
        [u, v]: [f64; 2],
        flat: DVec3,
        material: &Material,
    ) -> Self {
        let weights = [1.0 - u - v, u, v];
        let (mut normal, mut coherence) = (flat, 1.0);
        if let Some(normals) = corners.normals {
            let mixed: DVec3 = normals.iter().zip(weights).map(|(&n, w)| n * w).sum();
            if let Some(unit) = mixed.try_normalize() {
                normal = if unit.dot(flat) < 0.0 { -unit } else { unit };
                coherence = mixed.length().min(1.0);
            }
        }
        let mut point = Self {
            uv: corners.uv([u, v]),
            normal,
            coherence,
            along: None,
        };
        if let Some(derivatives) = corners.derivatives() {
            point.along = Some(derivatives[0] - normal * normal.dot(derivatives[0]));
            point.bend(scene, material, derivatives, flat);
        }
        point
    }

    /// The point of a sphere of that radius with the unit normal `n`: longitude and latitude about +y,
    /// the middle of the image towards +z.
    pub(super) fn on_sphere(scene: &Scene, n: DVec3, radius: f64, material: &Material) -> Self {
        let uv = DVec2::new(
            0.5 + n.x.atan2(n.z) / TAU,
            0.5 + n.y.clamp(-1.0, 1.0).asin() / PI,
        );
        let mut point = Self {
            uv,
            normal: n,
            coherence: 1.0,
            along: None,
        };
        // Of the place, by longitude and latitude.
        let by_u = DVec3::new(n.z, 0.0, -n.x) * (TAU * radius);
        if let Some(east) = by_u.try_normalize() {
            point.along = Some(east);
            point.bend(scene, material, [by_u, n.cross(east) * (PI * radius)], n);
        }
        point
    }

    /// Applies a normal or bump map, where these are the place's derivatives by u and v.
    fn bend(&mut self, scene: &Scene, material: &Material, [by_u, by_v]: [DVec3; 2], flat: DVec3) {
        let Some(map) = material.normal_map else {
            return;
        };
        let strength = f64::from(map.strength);
        let bent = match map.kind {
            Relief::Normals => {
                let n = self.normal;
                let tangent = (by_u - n * n.dot(by_u)).normalize_or(n.any_orthonormal_vector());
                let bitangent = n.cross(tangent) * flat.dot(by_u.cross(by_v)).signum();
                let t = texture(scene, &map.texture, self.uv) * 2.0 - 1.0;
                (tangent * t.x + bitangent * t.y) * strength + n * t.z
            }
            Relief::Bump => {
                // Differences over a texel, in the mean over both axes, along the surface's own u
                // and v.
                let [w, h] = scene.textures[map.texture.texture as usize].size();
                let [[a, b, _], [c, d, _]] = map.texture.uv.map(|row| row.map(f64::from));
                let texels = f64::from(w) * f64::from(h) * (a * d - b * c).abs();
                let step = 1.0 / texels.sqrt();
                let height = |uv| strength * texture(scene, &map.texture, uv).x;
                let here = height(self.uv);
                let du = (height(self.uv + DVec2::X * step) - here) / step;
                let dv = (height(self.uv + DVec2::Y * step) - here) / step;
                let area = flat.dot(by_u.cross(by_v));
                let (gradient_u, gradient_v) = (by_v.cross(flat) / area, flat.cross(by_u) / area);
                self.normal - gradient_u * du - gradient_v * dv
            }
        };
        self.normal = bent.try_normalize().unwrap_or(self.normal);
    }

    /// The shading normal for light that leaves along `omega_o`, with the geometric normal on its
    /// side: bent to where the mirror direction leaves the surface.
    pub(super) fn towards(&self, front: bool, geometric: DVec3, omega_o: DVec3) -> DVec3 {
        let normal = if front { self.normal } else { -self.normal };
        let up = geometric.dot(omega_o);
        let least = HORIZON * up;
        let mirror = |n: DVec3, cos: f64| n * (2.0 * cos) - omega_o;
        let (cos, height) = (normal.dot(omega_o), normal.dot(geometric));
        if cos > 0.0 && height > 0.0 && mirror(normal, cos).dot(geometric) >= least {
            return normal;
        }
        let raised = normal - geometric * height.min(0.0);
        let raised = raised.normalize_or_zero();
        let mirrored = mirror(raised, raised.dot(omega_o).max(0.0));
        let along = mirrored - geometric * mirrored.dot(geometric);
        let lifted = along.normalize_or_zero() * (1.0 - least * least).sqrt() + geometric * least;
        (omega_o + lifted).normalize_or(geometric)
    }

    /// What diffuse reflection into `omega_i` is multiplied with at the edge of shadow.
    pub(super) fn terminator(&self, shading: DVec3, geometric: DVec3, omega_i: DVec3) -> f64 {
        let cos_alpha = (shading.dot(geometric) * self.coherence).min(1.0);
        let cos = shading.dot(omega_i).min(1.0);
        if cos <= 0.0 || cos_alpha <= 0.0 || geometric.dot(omega_i) <= 0.0 {
            return 0.0;
        }
        let tan = |cos: f64| (1.0 - cos * cos).max(0.0).sqrt() / cos;
        let g = (2.0 - 2.0 * tan(cos) * tan(cos_alpha)).clamp(0.0, 1.0);
        g * (g * (1.0 - g) + 1.0)
    }
}

/// An orthonormal frame.
pub(super) struct Frame {
    x: DVec3,
    y: DVec3,
    z: DVec3,
}

impl Frame {
    /// The frame about a unit normal in which brushed metals lie: along what lies `along` the normal's
    /// plane, if anything does; else that of T. Duff et al., "Building an
    /// Orthonormal Basis, Revisited", JCGT 6(1), 2017.
    pub(super) fn about(z: DVec3, along: Option<DVec3>) -> Self {
        let flat = along.and_then(|along| (along - z * z.dot(along)).try_normalize());
        match flat {
            Some(x) => Self {
                x,
                y: z.cross(x),
                z,
            },
            None => {
                let (x, y) = z.any_orthonormal_pair();
                Self { x, y, z }
            }
        }
    }

    pub(super) fn local(&self, world: DVec3) -> DVec3 {
        DVec3::new(self.x.dot(world), self.y.dot(world), self.z.dot(world))
    }

    pub(super) fn world(&self, local: DVec3) -> DVec3 {
        self.x * local.x + self.y * local.y + self.z * local.z
    }
}

/// How much of a material is there at (u, v): 0 or 1 of a mask.
pub(super) fn presence(scene: &Scene, material: &Material, uv: DVec2) -> f64 {
    let Some(alpha) = &material.alpha else {
        return 1.0;
    };
    let opacity = number(scene, &alpha.opacity, uv);
    match alpha.cutoff {
        Some(cutoff) => f64::from(u8::from(opacity >= f64::from(cutoff))),
        None => opacity,
    }
}

/// A colour at (u, v).
pub(super) fn colour(scene: &Scene, value: &Textured<[f32; 3]>, uv: DVec2) -> DVec3 {
    let texel = value.texture.map(|read| texture(scene, &read, uv));
    vector(value.factor) * texel.unwrap_or(DVec3::ONE)
}

/// A number at (u, v).
pub(super) fn number(scene: &Scene, value: &Textured<f32>, uv: DVec2) -> f64 {
    let texel = value.texture.map(|read| texture(scene, &read, uv).x);
    f64::from(value.factor) * texel.unwrap_or(1.0)
}

/// A vertex's normal, from the fold of the sphere onto a square.
pub(super) fn normal_of(mesh: &Mesh, vertex: usize) -> Option<DVec3> {
    let code = *mesh.normals.get(vertex)?;
    let [x, y] = [code as i16, (code >> 16) as i16].map(|c| f64::from(c) / 32767.0);
    let z = 1.0 - x.abs() - y.abs();
    let fold = |a: f64, b: f64| (1.0 - b.abs()).copysign(a);
    let (x, y) = if z < 0.0 {
        (fold(x, y), fold(y, x))
    } else {
        (x, y)
    };
    (code != Mesh::NO_NORMAL).then(|| DVec3::new(x, y, z).normalize())
}

/// A vertex's (u, v).
pub(super) fn uv_of(mesh: &Mesh, vertex: usize) -> Option<DVec2> {
    let uv = DVec2::from_array(mesh.uvs.get(vertex)?.map(f64::from));
    uv.is_finite().then_some(uv)
}

/// The whole image at the surface's (u, v), by its four nearest texels.
fn texture(scene: &Scene, read: &TextureUse, uv: DVec2) -> DVec3 {
    let texture = &scene.textures[read.texture as usize];
    let [across, up] = read.uv.map(|row| {
        let [a, b, c] = row.map(f64::from);
        a * uv.x + b * uv.y + c
    });
    let [width, height] = texture.size();
    let at = |x: i64, y: i64| {
        let x = wrapped(x, width, read.wrap[0]);
        let y = wrapped(y, height, read.wrap[1]);
        texel(texture, y * width as usize + x, read.channel)
    };
    let place = DVec2::new(across * f64::from(width), up * f64::from(height));
    if read.filter == TexelFilter::Nearest {
        return at(place.x.floor() as i64, place.y.floor() as i64);
    }
    let corner = (place - 0.5).floor();
    let share = place - 0.5 - corner;
    let (x, y) = (corner.x as i64, corner.y as i64);
    let low = at(x, y).lerp(at(x + 1, y), share.x);
    let high = at(x, y + 1).lerp(at(x + 1, y + 1), share.x);
    low.lerp(high, share.y)
}

fn wrapped(i: i64, size: u32, wrap: Wrap) -> usize {
    let n = i64::from(size);
    let i = match wrap {
        Wrap::Repeat => i.rem_euclid(n),
        Wrap::Clamp => i.clamp(0, n - 1),
        Wrap::Mirror => {
            let i = i.rem_euclid(2 * n);
            i.min(2 * n - 1 - i)
        }
    };
    i as usize
}

fn texel(texture: &Texture, index: usize, channel: Channel) -> DVec3 {
    let curve = |x: f64| match texture.srgb {
        true if x <= 0.04045 => x / 12.92,
        true => ((x + 0.055) / 1.055).powf(2.4),
        false => x,
    };
    let byte = |word: usize, i: usize| f64::from(texture.words[word] >> (8 * i) & 255) / 255.0;
    let float = |word: usize| f64::from(f32::from_bits(texture.words[word]));
    let (rgb, alpha) = match texture.format {
        TexelFormat::Rgba8 => ([0, 1, 2].map(|i| curve(byte(index, i))), byte(index, 3)),
        TexelFormat::Grey8 => ([curve(byte(index / 4, index % 4)); 3], 1.0),
        TexelFormat::Rgb32 => ([0, 1, 2].map(|i| float(3 * index + i)), 1.0),
        TexelFormat::Grey32 => ([float(index); 3], 1.0),
    };
    match channel {
        Channel::Colour => rgb.into(),
        Channel::Red => DVec3::splat(rgb[0]),
        Channel::Green => DVec3::splat(rgb[1]),
        Channel::Blue => DVec3::splat(rgb[2]),
        Channel::Alpha => DVec3::splat(alpha),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use huygens_kernels::interpolate;
    use huygens_kernels::lanes::Fx;
    use huygens_kernels::vec3::Vec3x;
    use proptest::prelude::*;

    fn lanes(v: DVec3) -> Vec3x {
        Vec3x::splat(v.as_vec3().to_array())
    }

    fn direction() -> impl Strategy<Value = DVec3> {
        let unit = (-1.0f64..1.0, -1.0f64..1.0, -1.0f64..1.0);
        unit.prop_filter_map("a direction", |(x, y, z)| {
            let v = DVec3::new(x, y, z);
            (v.length() > 0.1).then(|| v.normalize())
        })
    }

    proptest! {
        /// The oracle and the kernel bend normals and fade light alike, off the edges of their cases.
        #[test]
        fn normals_and_terminators_are_the_kernels(
            g in direction(), n in direction(), o in direction(), i in direction(),
            coherence in 0.7f64..1.0,
        ) {
            let n = (n + 1.2 * g).normalize();
            let o = o * o.dot(g).signum();
            prop_assume!(o.dot(g) > 0.01);
            let point = Point { uv: DVec2::ZERO, normal: n, coherence, along: None };
            let found = point.towards(true, g, o);
            let kernel = interpolate::towards(lanes(n), lanes(g), lanes(o));
            let kernel = DVec3::from_array(kernel.lane(0).map(f64::from));
            // Unit vectors are rounded to 2^-24 and meet in quotients of at least 0.01.
            prop_assert!((found - kernel).length() < 1e-4, "{found} {kernel}");
            prop_assume!(i.dot(g).abs() > 1e-3 && n.dot(i).abs() > 0.05 && n.dot(g) > 0.05);
            let factor = point.terminator(n, g, i);
            let kernel = interpolate::terminator(lanes(n), lanes(g), lanes(i), Fx::splat(coherence as f32));
            prop_assert!((factor - f64::from(kernel.as_array()[0])).abs() < 1e-3);
        }
    }
}
