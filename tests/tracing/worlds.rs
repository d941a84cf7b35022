//! Scenes of spheres and instances for tests of ray casting, and the truth about them in f64.

use super::{Random, bumpy_sphere};
use glam::{DAffine3, DMat3, DVec3};
use huygens::scene::{
    Camera, Extent, FilmSpec, Filter, Instance, Material, Mesh, Object, Placement, Projection,
    Scene, Sphere,
};
use huygens::settings::Settings;

/// A scene of nothing.
pub fn empty() -> Scene {
    let extent = Extent {
        half_width: 1.0,
        half_height: 1.0,
    };
    Scene {
        name: "world".into(),
        hash: [0; 32],
        camera: Camera {
            origin: [0.0; 3],
            forward: [0.0, 0.0, -1.0],
            right: [1.0, 0.0, 0.0],
            up: [0.0, 1.0, 0.0],
            projection: Projection::Perspective { extent, lens: None },
        },
        film: FilmSpec {
            width: 4,
            height: 4,
            filter: Filter::Box,
        },
        mesh: Mesh::default(),
        spheres: Vec::new(),
        objects: Vec::new(),
        instances: Vec::new(),
        lights: Vec::new(),
        media: Vec::new(),
        camera_motion: None,
        fog: None,
        materials: vec![Material::diffuse("grey", [0.5; 3], [0.0; 3])],
        textures: Vec::new(),
        sky: None,
        settings: Settings::default(),
        warnings: Vec::new(),
    }
}

/// An affine map of any kind: turned, sheared, mirrored every other time, unevenly scaled.
pub fn any_map(random: &mut Random, size: f64) -> DAffine3 {
    let axis = |random: &mut Random| DVec3::from_array(random.point().map(f64::from));
    loop {
        let linear = DMat3::from_cols(axis(random), axis(random), axis(random));
        let lengths: f64 = (0..3).map(|i| linear.col(i).length()).product();
        if linear.determinant().abs() > 0.2 * lengths {
            let at = axis(random);
            return DAffine3::from_mat3_translation(linear * size, at);
        }
    }
}

/// `copies` of two objects anywhere, `balls` spheres, and a bumpy sphere around it all.
pub fn mixed(copies: usize, balls: usize, seed: u64) -> Scene {
    let mut random = Random(seed);
    let mut scene = empty();
    let object = |name: &str, mesh: Mesh| Object {
        name: name.to_owned(),
        mesh,
    };
    scene.objects = vec![
        object("cube", super::cube()),
        object("ball", bumpy_sphere(2, 0.1)),
    ];
    for i in 0..copies {
        let map = any_map(&mut random, 0.15);
        scene.instances.push(Instance {
            object: (i % 2) as u32,
            placement: placement(&map),
            material: None,
            motion: None,
        });
    }
    for _ in 0..balls {
        scene.spheres.push(Sphere {
            centre: random.point(),
            radius: 0.2 * random.unit().powi(3) + 1e-4,
            material: 0,
            turn: Sphere::UPRIGHT,
        });
    }
    scene.mesh = super::moved(bumpy_sphere(3, 0.05), 2.5, [0.0; 3]);
    scene
}

/// The placement of a map, as a scene file would have it.
pub fn placement(map: &DAffine3) -> Placement {
    Placement::new(map).expect("a map of ordinary size")
}

/// The truth about one ray: what it meets, nearest first, at what distance, and how clearly: for
/// triangles the least barycentric weight, for spheres how far the line is from the edge of the disc,
/// over the radius.
#[derive(Clone, Copy, Debug)]
pub struct Truth {
    pub primitive: u32,
    pub t: f64,
    pub margin: f64,
    /// Scale of the rounding errors of the distance, in roundings of f32.
    pub error: f64,
}

/// Everything that the ray's line comes near to, hit or not (negative margins are misses).
pub fn truths(scene: &Scene, origin: [f32; 3], direction: [f32; 3]) -> Vec<Truth> {
    let v = |a: [f32; 3]| DVec3::from_array(a.map(f64::from));
    let (o, d) = (v(origin), v(direction));
    let mut all = Vec::new();
    let mut first = 0;
    let mut triangles = |mesh: &Mesh, map: &DAffine3, first: u32| {
        for i in 0..mesh.triangles() {
            let [a, b, c] = mesh.corners(i).map(|p| map.transform_point3(v(p)));
            let (e, f) = (b - a, c - a);
            let n = e.cross(f);
            let det = -d.dot(n);
            let s = o - a;
            let t = s.dot(n) / det;
            let q = s.cross(d);
            let (u, w) = (f.dot(q) / det, -e.dot(q) / det);
            // In the object's space and in the world's, lengths are of the size of what is
            // subtracted; seen at a flat angle a rounding aside becomes many along the ray.
            let sizes = map.matrix3.inverse().to_cols_array().map(f64::abs);
            let inverse = sizes.into_iter().fold(0.0, f64::max);
            let sizes = map.matrix3.to_cols_array().map(f64::abs);
            let forward = sizes.into_iter().fold(0.0, f64::max);
            let condition = 9.0 * inverse * forward;
            let reach = s.length() + (b - a).length() + (c - a).length();
            let slope = d.length() * n.length() / det.abs();
            all.push(Truth {
                primitive: first + i as u32,
                t,
                margin: u.min(w).min(1.0 - u - w),
                error: condition * reach * slope / d.length(),
            });
        }
    };
    triangles(&scene.mesh, &DAffine3::IDENTITY, first);
    first += (scene.mesh.triangles() + scene.spheres.len()) as u32;
    for instance in &scene.instances {
        let mesh = &scene.objects[instance.object as usize].mesh;
        triangles(mesh, &instance.placement.map(), first);
        first += mesh.triangles() as u32;
    }
    for (i, sphere) in scene.spheres.iter().enumerate() {
        let (f, r) = (o - v(sphere.centre), f64::from(sphere.radius));
        let b = -f.dot(d) / d.length_squared();
        let aside = (f + b * d).length();
        let half = (r * r - aside * aside).max(0.0).sqrt() / d.length();
        for t in [b - half, b + half] {
            all.push(Truth {
                primitive: (scene.mesh.triangles() + i) as u32,
                t,
                margin: 1.0 - aside / r,
                error: (f.length() + r) / d.length(),
            });
        }
    }
    all
}
