//! Nanoseconds a lane for drawing from and evaluating each family of BSDFs, parameters and directions
//! in cache, one thread. The middle of 15 runs.
//!
//! `cargo bench -p huygens-kernels --bench bsdf`

use huygens_kernels::bsdf::{
    AnisotropicEnergy, Bsdf, Lambert, Principled, ReflectionEnergy, RoughConductor,
    RoughDielectric, RoughDiffuse, SchlickEnergy, SheenEnergy, SmoothConductor, SmoothDielectric,
    TransmissionEnergy,
};
use huygens_kernels::hemisphere::sample_uniform;
use huygens_kernels::lanes::{Fx, LANES};
use huygens_kernels::vec3::Vec3x;
use std::hint::black_box;
use std::time::Instant;

/// Vectors of directions and numbers; 60 kB of them.
const VECTORS: usize = 256;
const RUNS: usize = 15;

struct Inputs {
    o: Vec<Vec3x>,
    i: Vec<Vec3x>,
    u: Vec<[Fx; 3]>,
}

fn inputs() -> Inputs {
    let mut state = 1u32;
    let mut number = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / 16_777_216.0
    };
    let mut lanes = || Fx::new(std::array::from_fn(|_| number()));
    let mut column = |_| sample_uniform(lanes(), lanes());
    let o = (0..VECTORS).map(&mut column).collect();
    let i = (0..VECTORS).map(&mut column).collect();
    let u = (0..VECTORS)
        .map(|_| std::array::from_fn(|_| lanes()))
        .collect();
    Inputs { o, i, u }
}

/// The middle of the runs, in nanoseconds a lane.
fn middle(mut work: impl FnMut()) -> f64 {
    let mut times: Vec<f64> = (0..RUNS)
        .map(|_| {
            let start = Instant::now();
            for _ in 0..8 {
                work();
            }
            start.elapsed().as_secs_f64() * 1e9 / (8 * VECTORS * LANES) as f64
        })
        .collect();
    times.sort_by(f64::total_cmp);
    times[RUNS / 2]
}

#[inline(never)]
fn measure<B: Bsdf>(name: &str, bsdf: &B, inputs: &Inputs) {
    let drawing = middle(|| {
        for v in 0..VECTORS {
            black_box(black_box(bsdf).sample(inputs.o[v], inputs.u[v]));
        }
    });
    let evaluating = middle(|| {
        for v in 0..VECTORS {
            black_box(black_box(bsdf).evaluate(inputs.o[v], inputs.i[v]));
        }
    });
    println!("{name:<28} {drawing:7.2} {evaluating:7.2}");
}

fn built<T: 'static>(name: &str, table: impl Fn() -> &'static T) {
    let start = Instant::now();
    table();
    let millis = start.elapsed().as_secs_f64() * 1e3;
    let bytes = size_of::<T>();
    println!("{name:<28} {millis:7.1} ms {bytes:7} bytes");
}

fn main() {
    let inputs = inputs();
    println!("table, built at first use");
    built("reflection", ReflectionEnergy::table);
    built("transmission", TransmissionEnergy::table);
    built("anisotropic", AnisotropicEnergy::table);
    built("Schlick", SchlickEnergy::table);
    built("sheen", SheenEnergy::table);
    println!(
        "\n{:<28} {:>7} {:>7}",
        "nanoseconds a lane", "draw", "value"
    );
    let one = Fx::ONE;
    let white = Vec3x::splat([0.8; 3]);
    let alpha = Fx::splat(0.2);
    let diffuse = RoughDiffuse {
        albedo: white,
        roughness: Fx::splat(0.5),
    };
    measure("Lambert", &Lambert { albedo: white }, &inputs);
    measure("rough diffuse", &diffuse, &inputs);
    let (eta, k) = (Vec3x::splat([0.2, 0.9, 1.1]), Vec3x::splat([3.9, 2.5, 2.1]));
    measure("smooth conductor", &SmoothConductor { eta, k }, &inputs);
    let metal = |alpha| RoughConductor {
        eta,
        k,
        mean: white,
        alpha,
        energy: ReflectionEnergy::table(),
    };
    measure("rough conductor", &metal([alpha, alpha]), &inputs);
    let brushed = metal([alpha, Fx::splat(0.6)]);
    measure("rough conductor, anisotropic", &brushed, &inputs);
    let surface = SmoothDielectric {
        eta: Fx::splat(1.5),
        thin: Fx::ZERO,
        reflection: white,
        transmission: white,
    };
    measure("smooth dielectric", &surface, &inputs);
    let frosted = RoughDielectric {
        surface,
        alpha,
        energy: TransmissionEnergy::table(),
        compensated: one.simd_eq(one),
    };
    measure("rough dielectric", &frosted, &inputs);
    let plain = Principled {
        base: white,
        metallic: Fx::ZERO,
        alpha,
        eta: Fx::splat(1.5),
        specular: one,
        specular_color: Vec3x::splat([1.0; 3]),
        transmission: Fx::ZERO,
        thin: Fx::ZERO,
        coat: Fx::ZERO,
        coat_alpha: alpha,
        sheen: Vec3x::splat([0.0; 3]),
        sheen_roughness: Fx::splat(0.5),
        compensated: one.simd_eq(one),
    };
    measure("principled", &plain, &inputs);
    let coated = Principled { coat: one, ..plain };
    measure("principled, coat", &coated, &inputs);
    let cloth = Principled {
        sheen: white,
        ..plain
    };
    measure("principled, sheen", &cloth, &inputs);
    let glass = Principled {
        transmission: Fx::splat(0.5),
        ..plain
    };
    measure("principled, half glass", &glass, &inputs);
}
