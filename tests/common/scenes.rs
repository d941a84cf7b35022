//! Scenes with known answers, built in code so that no test here depends on a scene file.

use huygens::scene::{
    Bsdf, Camera, Extent, FilmSpec, Filter, Instance, Lens, Material, Mesh, Object, Placement,
    Projection, Scene, Sphere,
};
use huygens::settings::Settings;

/// A scene under construction.
pub(crate) struct Builder {
    mesh: Mesh,
    spheres: Vec<Sphere>,
    objects: Vec<Object>,
    instances: Vec<Instance>,
    materials: Vec<Material>,
}

impl Builder {
    pub(crate) fn new() -> Self {
        Self {
            mesh: Mesh::default(),
            spheres: Vec::new(),
            objects: Vec::new(),
            instances: Vec::new(),
            materials: Vec::new(),
        }
    }

    /// A wide floor of `material` at a height of -1, its front above.
    pub(crate) fn floor(&mut self, material: u32) {
        let at = |x: f32, z: f32| [x, -1.0, z];
        self.quad(
            material,
            [at(-9.0, 9.0), at(9.0, 9.0), at(9.0, -9.0), at(-9.0, -9.0)],
        );
    }

    /// A one-sided material; its index.
    pub(crate) fn material(&mut self, albedo: [f32; 3], emission: [f32; 3]) -> u32 {
        let name = format!("material {}", self.materials.len());
        self.materials
            .push(Material::diffuse(name, albedo, emission));
        self.materials.len() as u32 - 1
    }

    /// A surface that emits nothing; its index.
    pub(crate) fn surface(&mut self, bsdf: Bsdf) -> u32 {
        let plain = self.material([0.0; 3], [0.0; 3]);
        self.materials[plain as usize].bsdf = bsdf;
        plain
    }

    /// The material made last.
    pub(crate) fn last(&mut self) -> &mut Material {
        self.materials.last_mut().expect("a material")
    }

    /// Lets the material made last emit from both sides.
    pub(crate) fn two_sided(&mut self) {
        self.last().two_sided = true;
    }

    /// Two triangles; the front is where the corners run counter-clockwise.
    pub(crate) fn quad(&mut self, material: u32, corners: [[f32; 3]; 4]) {
        let first = self.mesh.vertices.len() as u32;
        self.mesh.vertices.extend(corners);
        self.mesh
            .indices
            .extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        self.mesh.material.extend([material; 2]);
    }

    /// One triangle, its front where the corners run counter-clockwise, or on the other side.
    pub(crate) fn triangle(&mut self, material: u32, corners: [[f32; 3]; 3], flipped: bool) {
        let first = self.mesh.vertices.len() as u32;
        self.mesh.vertices.extend(corners);
        let [second, third] = if flipped { [2, 1] } else { [1, 2] };
        self.mesh
            .indices
            .push([first, first + second, first + third]);
        self.mesh.material.push(material);
    }

    /// The axis-aligned box from `low` to `high`, its fronts inside.
    pub(crate) fn room(&mut self, material: u32, low: [f32; 3], high: [f32; 3]) {
        let corner =
            |bits: usize| std::array::from_fn(|axis| [low[axis], high[axis]][(bits >> axis) & 1]);
        for face in [
            [0, 2, 6, 4],
            [1, 5, 7, 3],
            [0, 4, 5, 1],
            [2, 3, 7, 6],
            [0, 1, 3, 2],
            [4, 6, 7, 5],
        ] {
            self.quad(material, face.map(corner));
        }
    }

    /// A sphere.
    pub(crate) fn sphere(&mut self, material: u32, centre: [f32; 3], radius: f32) {
        self.spheres.push(Sphere {
            centre,
            radius,
            material,
            turn: Sphere::UPRIGHT,
        });
    }

    /// Makes all triangles so far an object; its index.
    pub(crate) fn object(&mut self) -> u32 {
        self.objects.push(Object {
            name: format!("object {}", self.objects.len()),
            mesh: std::mem::take(&mut self.mesh),
        });
        self.objects.len() as u32 - 1
    }

    /// A copy of an object.
    pub(crate) fn instance(&mut self, object: u32, map: &glam::DAffine3, material: Option<u32>) {
        self.instances.push(Instance {
            object,
            placement: Placement::new(map).expect("a map of ordinary size"),
            material,
            motion: None,
        });
    }

    /// The finished scene.
    pub(crate) fn scene(self, camera: Camera, width: u32, height: u32) -> Scene {
        Scene {
            name: "test".into(),
            hash: [0; 32],
            camera,
            film: FilmSpec {
                width,
                height,
                filter: Filter::Box,
            },
            mesh: self.mesh,
            materials: self.materials,
            spheres: self.spheres,
            objects: self.objects,
            instances: self.instances,
            textures: Vec::new(),
            sky: None,
            lights: Vec::new(),
            media: Vec::new(),
            camera_motion: None,
            fog: None,
            settings: Settings::default(),
            warnings: Vec::new(),
        }
    }
}

/// A camera at `origin` that looks along the z axis, towards +z if `forward` is 1, with +y up.
pub(crate) fn camera_along_z(origin: [f32; 3], forward: f32, half_width: f32) -> Camera {
    Camera {
        origin,
        forward: [0.0, 0.0, forward],
        right: [-forward, 0.0, 0.0],
        up: [0.0, 1.0, 0.0],
        projection: pinhole(half_width, half_width),
    }
}

/// A pinhole of half the image at distance 1.
pub(crate) fn pinhole(half_width: f32, half_height: f32) -> Projection {
    let extent = Extent {
        half_width,
        half_height,
    };
    Projection::Perspective { extent, lens: None }
}

/// The same through a lens.
pub(crate) fn thin_lens(half: f32, radius: f32, focus: f32) -> Projection {
    let extent = Extent {
        half_width: half,
        half_height: half,
    };
    let lens = Some(Lens { radius, focus });
    Projection::Perspective { extent, lens }
}

/// The Cornell box, in millimetres, as measured at the Program of Computer Graphics of Cornell
/// University (its "Cornell Box Data" page): walls slightly out of square, open to the front.
///
/// The light lies in a hole of the ceiling, as the data has it. Reflectances and radiance are the
/// linear RGB values commonly used for it.
pub(crate) fn cornell_box(size: u32) -> Scene {
    let mut b = Builder::new();
    let white = b.material([0.725, 0.71, 0.68], [0.0; 3]);
    let red = b.material([0.63, 0.065, 0.05], [0.0; 3]);
    let green = b.material([0.14, 0.45, 0.091], [0.0; 3]);
    let light = b.material([0.0; 3], [17.0, 12.0, 4.0]);
    let top = 548.8;
    let mut ceiling = |material, [x0, x1]: [f32; 2], [z0, z1]: [f32; 2]| {
        b.quad(
            material,
            [[x1, top, z0], [x1, top, z1], [x0, top, z1], [x0, top, z0]],
        );
    };
    ceiling(light, [213.0, 343.0], [227.0, 332.0]);
    ceiling(white, [0.0, 556.0], [0.0, 227.0]);
    ceiling(white, [0.0, 556.0], [332.0, 559.2]);
    ceiling(white, [0.0, 213.0], [227.0, 332.0]);
    ceiling(white, [343.0, 556.0], [227.0, 332.0]);
    for (material, corners) in [
        // Floor, back wall, right wall, left wall.
        (
            white,
            [
                [552.8, 0.0, 0.0],
                [0.0, 0.0, 0.0],
                [0.0, 0.0, 559.2],
                [549.6, 0.0, 559.2],
            ],
        ),
        (
            white,
            [
                [549.6, 0.0, 559.2],
                [0.0, 0.0, 559.2],
                [0.0, top, 559.2],
                [556.0, top, 559.2],
            ],
        ),
        (
            green,
            [
                [0.0, 0.0, 559.2],
                [0.0, 0.0, 0.0],
                [0.0, top, 0.0],
                [0.0, top, 559.2],
            ],
        ),
        (
            red,
            [
                [552.8, 0.0, 0.0],
                [549.6, 0.0, 559.2],
                [556.0, top, 559.2],
                [556.0, top, 0.0],
            ],
        ),
    ] {
        b.quad(material, corners);
    }
    let short = [[130.0, 65.0], [82.0, 225.0], [240.0, 272.0], [290.0, 114.0]];
    let tall = [
        [423.0, 247.0],
        [265.0, 296.0],
        [314.0, 456.0],
        [472.0, 406.0],
    ];
    for (height, base) in [(165.0, short), (330.0, tall)] {
        let at = |i: usize, y: f32| [base[i % 4][0], y, base[i % 4][1]];
        b.quad(white, std::array::from_fn(|i| at(i, height)));
        for i in 0..4 {
            b.quad(
                white,
                [at(i, 0.0), at(i, height), at(i + 1, height), at(i + 1, 0.0)],
            );
        }
    }
    // A lens of 35 mm before a film 25 mm wide.
    let camera = camera_along_z([278.0, 273.0, -800.0], 1.0, 0.0125 / 0.035);
    b.scene(camera, size, size)
}

/// A closed box in which every surface has reflectance `albedo` and emits 1 inwards, and a camera
/// off its middle: with all scattering, the radiance is `1 / (1 - albedo)` everywhere.
pub(crate) fn furnace(albedo: f32) -> Scene {
    let mut b = Builder::new();
    let wall = b.material([albedo; 3], [1.0; 3]);
    b.room(wall, [-1.0, -0.5, -2.0], [1.5, 1.0, 1.0]);
    b.scene(camera_along_z([0.1, 0.2, 0.3], -1.0, 1.0), 4, 4)
}

/// The same inside a ball of 512 triangles, none of which meet in a sharp edge.
pub(crate) fn round_furnace(albedo: f32) -> Scene {
    let mut b = Builder::new();
    let wall = b.material([albedo; 3], [1.0; 3]);
    // An octahedron, each face cut in 64, its vertices lifted to the unit sphere.
    let steps = 8;
    for octant in 0..8 {
        let sign: [f32; 3] = std::array::from_fn(|axis| [1.0, -1.0][(octant >> axis) & 1]);
        let lift = |i: i32, j: i32| -> [f32; 3] {
            let p = [i, j, steps - i - j].map(|k| k as f32);
            let length = p.iter().map(|c| c * c).sum::<f32>().sqrt();
            std::array::from_fn(|axis| sign[axis] * p[axis] / length)
        };
        let outward = sign[0] * sign[1] * sign[2] > 0.0;
        for i in 0..steps {
            for j in 0..steps - i {
                let lower = [lift(i, j), lift(i + 1, j), lift(i, j + 1)];
                let upper = [lift(i + 1, j), lift(i + 1, j + 1), lift(i, j + 1)];
                b.triangle(wall, lower, outward);
                if i + j + 1 < steps {
                    b.triangle(wall, upper, outward);
                }
            }
        }
    }
    b.scene(camera_along_z([0.1, 0.2, 0.3], -1.0, 1.0), 4, 4)
}

/// A wide floor at y = 0 of the given reflectance, seen from above its origin so closely that the
/// whole film sees that point, to a part in a million.
pub(crate) fn floor_from_above(albedo: f32, mut b: Builder) -> Scene {
    let grey = b.material([albedo; 3], [0.0; 3]);
    b.quad(
        grey,
        [
            [-1e3, 0.0, 1e3],
            [1e3, 0.0, 1e3],
            [1e3, 0.0, -1e3],
            [-1e3, 0.0, -1e3],
        ],
    );
    let camera = Camera {
        origin: [0.0, 1.0, 0.0],
        forward: [0.0, -1.0, 0.0],
        right: [1.0, 0.0, 0.0],
        up: [0.0, 0.0, -1.0],
        projection: pinhole(1e-6, 1e-6),
    };
    b.scene(camera, 2, 2)
}

/// A floor, a tilted plate above it that casts shadows, and a small lamp that emits `emission`; an image of
/// `size` by `size`.
pub(crate) fn tilted_plate(emission: [f32; 3], size: u32) -> Scene {
    let mut b = Builder::new();
    let grey = b.material([0.7, 0.5, 0.3], [0.0; 3]);
    let lamp = b.material([0.2; 3], emission);
    let plate = [
        [-1.0, -0.5, -3.0],
        [0.5, -0.5, -3.0],
        [0.5, 0.5, -4.0],
        [-1.0, 0.5, -4.0],
    ];
    let panel = [
        [0.8, 1.0, -3.0],
        [0.8, 1.0, -4.0],
        [1.6, 1.0, -4.0],
        [1.6, 1.0, -3.0],
    ];
    b.floor(grey);
    b.quad(grey, plate);
    b.quad(lamp, panel);
    b.scene(camera_along_z([0.0; 3], -1.0, 0.7), size, size)
}
