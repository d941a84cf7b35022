//! Meshes that tell trees apart, for tests and benches: long, thin and overlapping; all in one
//! direction; evenly small. Each is a function of its arguments alone.

use super::Random;
use huygens::scene::Mesh;

/// Half extents and centre of a box, turned by `angles` about x, then y.
fn push_box(mesh: &mut Mesh, centre: [f32; 3], half: [f32; 3], angles: [f32; 2]) {
    let n = mesh.vertices.len() as u32;
    let ([sx, cx], [sy, cy]) = (
        [angles[0].sin(), angles[0].cos()],
        [angles[1].sin(), angles[1].cos()],
    );
    for i in 0..8 {
        let [x, y, z] = [0, 1, 2].map(|a| if i >> a & 1 == 0 { -half[a] } else { half[a] });
        let [x, y, z] = [x, cx * y - sx * z, sx * y + cx * z];
        let [x, y, z] = [cy * x + sy * z, y, cy * z - sy * x];
        mesh.vertices
            .push([centre[0] + x, centre[1] + y, centre[2] + z]);
    }
    let quads: [[u32; 4]; 6] = [
        [0, 1, 3, 2],
        [4, 6, 7, 5],
        [0, 4, 5, 1],
        [2, 3, 7, 6],
        [0, 2, 6, 4],
        [1, 5, 7, 3],
    ];
    for q in quads {
        let q = q.map(|i| n + i);
        mesh.indices
            .extend([[q[0], q[1], q[2]], [q[0], q[2], q[3]]]);
    }
}

fn finish(mut mesh: Mesh) -> Mesh {
    mesh.material = vec![0; mesh.indices.len()];
    mesh
}

/// A closed hall, 40 by 12 by 20, with `n` beams up to 16 long and as thin as 0.02, lying every
/// way and through each other, and `n` boxes of sizes over two orders: 12 triangles each.
pub fn clutter(n: usize) -> Mesh {
    let mut random = Random(42);
    let mut mesh = Mesh::default();
    push_box(&mut mesh, [0.0, 6.0, 0.0], [20.0, 6.0, 10.0], [0.0; 2]);
    for _ in 0..n {
        let at = random.point();
        let at = [19.0 * at[0], 6.0 + 5.5 * at[1], 9.5 * at[2]];
        let length = 8.0 * random.unit().powi(2);
        let thin = 0.01 + 0.04 * random.unit();
        let turn = [3.0 * random.signed(), 3.0 * random.signed()];
        push_box(&mut mesh, at, [thin, thin, length], turn);
        let at = random.point();
        let size = 0.03 * 40f32.powf(random.unit());
        let half = [(); 3].map(|()| size * (0.3 + random.unit()));
        let at = [19.0 * at[0], 6.0 + 5.5 * at[1], 9.5 * at[2]];
        push_box(&mut mesh, at, half, turn);
    }
    finish(mesh)
}

/// `n` needles in every direction, 150 times as long as wide, in a cube.
pub fn sticks(n: usize) -> Mesh {
    let mut random = Random(7);
    let mut mesh = Mesh::default();
    push_box(&mut mesh, [0.0; 3], [2.5; 3], [0.0; 2]);
    for _ in 0..n {
        let (at, d, s) = (random.point(), random.point(), random.point());
        let end = |along: f32, aside: f32| {
            std::array::from_fn(|a| at[a] + 0.1 * along * d[a] + 0.0015 * aside * s[a])
        };
        let first = mesh.vertices.len() as u32;
        mesh.vertices
            .extend([end(-1.0, 0.0), end(1.0, 0.0), end(1.0, 1.0)]);
        mesh.indices.push([first, first + 1, first + 2]);
    }
    finish(mesh)
}
