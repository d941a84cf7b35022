//! Meshes to trace: small, architectural, long and thin, and large.

use huygens::scene::Mesh;

/// A mesh by name.
pub(crate) type Maker = fn() -> Mesh;

/// Name and maker of each mesh.
pub(crate) const ALL: [(&str, Maker); 7] = [
    ("cornell", cornell),
    ("boxes8", || boxes(8)),
    ("boxes16", || boxes(16)),
    ("hall", || hall(700)),
    ("clutter", || hall(9000)),
    ("sticks", sticks),
    ("sphere", sphere),
];

/// Xorshift; any numbers will do.
pub(crate) struct Random(pub u64);

impl Random {
    /// In `[0, 1)`.
    pub(crate) fn unit(&mut self) -> f32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 40) as f32 / 16_777_216.0
    }
}

#[derive(Default)]
struct Builder(Mesh);

impl Builder {
    fn finish(mut self) -> Mesh {
        self.0.material = vec![0; self.0.indices.len()];
        self.0
    }

    fn quad(&mut self, corners: [[f32; 3]; 4]) {
        let n = self.0.vertices.len() as u32;
        self.0.vertices.extend(corners);
        self.0
            .indices
            .extend([[n, n + 1, n + 2], [n, n + 2, n + 3]]);
    }

    /// A box, turned about the vertical axis.
    fn block(&mut self, centre: [f32; 3], half: [f32; 3], angle: f32) {
        let (sin, cos) = angle.sin_cos();
        let p = |i: usize| {
            let [x, y, z] = [0, 1, 2].map(|a| if i >> a & 1 == 0 { -half[a] } else { half[a] });
            [
                centre[0] + cos * x - sin * z,
                centre[1] + y,
                centre[2] + sin * x + cos * z,
            ]
        };
        for q in [
            [0, 1, 3, 2],
            [4, 6, 7, 5],
            [0, 4, 5, 1],
            [2, 3, 7, 6],
            [0, 2, 6, 4],
            [1, 5, 7, 3],
        ] {
            self.quad(q.map(p));
        }
    }
}

/// The Cornell box: 36 triangles.
fn cornell() -> Mesh {
    let mut mesh = Builder::default();
    mesh.quad([
        [-1., -1., -1.],
        [1., -1., -1.],
        [1., -1., 1.],
        [-1., -1., 1.],
    ]);
    mesh.quad([[-1., 1., -1.], [1., 1., -1.], [1., 1., 1.], [-1., 1., 1.]]);
    mesh.quad([
        [-1., -1., -1.],
        [1., -1., -1.],
        [1., 1., -1.],
        [-1., 1., -1.],
    ]);
    mesh.quad([
        [-1., -1., -1.],
        [-1., 1., -1.],
        [-1., 1., 1.],
        [-1., -1., 1.],
    ]);
    mesh.quad([[1., -1., -1.], [1., 1., -1.], [1., 1., 1.], [1., -1., 1.]]);
    mesh.quad([
        [-0.25, 0.99, -0.2],
        [0.25, 0.99, -0.2],
        [0.25, 0.99, 0.2],
        [-0.25, 0.99, 0.2],
    ]);
    mesh.block([0.35, -0.7, 0.3], [0.3, 0.3, 0.3], 0.3);
    mesh.block([-0.35, -0.4, -0.3], [0.3, 0.6, 0.3], -0.3);
    mesh.finish()
}

/// A room with `n` boxes: 12 triangles each, and 12 for the room.
fn boxes(n: usize) -> Mesh {
    let mut mesh = Builder::default();
    let mut random = Random(5);
    mesh.block([0.; 3], [1.; 3], 0.);
    for _ in 0..n {
        let at = [(); 3].map(|()| 1.6 * random.unit() - 0.8);
        mesh.block(at, [0.15; 3], 6.0 * random.unit());
    }
    mesh.finish()
}

/// A columned hall with `boxes` boxes of all sizes in it.
fn hall(boxes: usize) -> Mesh {
    let mut mesh = Builder::default();
    let mut random = Random(1);
    mesh.block([0., 6., 0.], [20., 6., 10.], 0.);
    for column in 0..36 {
        let (x, z) = (
            -16. + 4. * (column / 4) as f32,
            -7.5 + 5. * (column % 4) as f32,
        );
        let (around, up) = (80u32, 48u32);
        let n = mesh.0.vertices.len() as u32;
        for h in 0..=up {
            for a in 0..around {
                let angle = a as f32 / around as f32 * std::f32::consts::TAU;
                let flutes = 1.0 + 0.12 * (16.0 * angle).cos();
                let swell = 1.0 + 0.25 * (h as f32 / 24.0 - 1.0).powi(6);
                let r = 0.45 * flutes * swell;
                let y = 9.0 * h as f32 / up as f32;
                mesh.0
                    .vertices
                    .push([x + r * angle.cos(), y, z + r * angle.sin()]);
            }
        }
        for h in 0..up {
            for a in 0..around {
                let (i, j) = (n + h * around + a, n + h * around + (a + 1) % around);
                mesh.0
                    .indices
                    .extend([[i, j, j + around], [i, j + around, i + around]]);
            }
        }
    }
    for beam in 0..24 {
        mesh.block([-18.5 + 1.6 * beam as f32, 9.8, 0.], [0.15, 0.25, 9.5], 0.);
    }
    for _ in 0..boxes {
        let size = 0.03 * 40f32.powf(random.unit());
        let half = [(); 3].map(|()| size * (0.3 + random.unit()));
        let high = random.unit() < 0.3;
        let y = if high {
            11. * random.unit()
        } else {
            half[1] + 2. * random.unit().powi(2)
        };
        let at = [38. * random.unit() - 19., y, 19. * random.unit() - 9.5];
        mesh.block(at, half, 6.0 * random.unit());
    }
    mesh.finish()
}

/// 300,000 needles, a hundred times as long as wide, in all directions.
fn sticks() -> Mesh {
    let mut mesh = Builder::default();
    let mut random = Random(2);
    mesh.block([0.; 3], [2.5; 3], 0.);
    for _ in 0..300_000 {
        let at = [(); 3].map(|()| 2.0 * random.unit() - 1.0);
        let d = [(); 3].map(|()| 2.0 * random.unit() - 1.0);
        let end = |s: f32, side: f32| {
            [
                at[0] + s * d[0] + side,
                at[1] + s * d[1],
                at[2] + s * d[2] - side,
            ]
        };
        let n = mesh.0.vertices.len() as u32;
        mesh.0
            .vertices
            .extend([end(-0.1, 0.0), end(0.1, 0.0), end(0.1, 0.001)]);
        mesh.0.indices.push([n, n + 1, n + 2]);
    }
    mesh.finish()
}

/// A rough sphere of 2.6 million triangles in a room.
fn sphere() -> Mesh {
    let mut mesh = Builder::default();
    let n = 466u32;
    // Six faces of a cube, each a grid, pushed out to a sphere and displaced.
    for face in 0..6u32 {
        let first = mesh.0.vertices.len() as u32;
        for y in 0..=n {
            for x in 0..=n {
                let (a, b) = (
                    2.0 * x as f32 / n as f32 - 1.0,
                    2.0 * y as f32 / n as f32 - 1.0,
                );
                let c = if face % 2 == 0 { 1.0 } else { -1.0 };
                let mut p = [a * c, b, c];
                p.rotate_right(face as usize / 2);
                let length = p.iter().map(|e| e * e).sum::<f32>().sqrt();
                let p = p.map(|e| e / length);
                let mut r = 1.0;
                for octave in 0..7 {
                    let f = 3.0 * 1.9f32.powi(octave);
                    let w = (f * p[0] + 1.3 * f * p[1]).sin() * (f * p[2] - 0.7 * f * p[0]).cos();
                    r += 0.35 * 0.5f32.powi(octave) * w;
                }
                mesh.0.vertices.push(p.map(|e| e * r));
            }
        }
        for y in 0..n {
            for x in 0..n {
                let i = first + y * (n + 1) + x;
                mesh.0
                    .indices
                    .extend([[i, i + 1, i + n + 2], [i, i + n + 2, i + n + 1]]);
            }
        }
    }
    mesh.block([0.; 3], [4., 3., 3.], 0.);
    mesh.finish()
}
