//! The numbers behind docs/performance/samplers.md: error and time of each sampler over a ladder
//! of samples a pixel.
//!
//! ```text
//! cargo run --release --example samplers -- SCENE WIDTHxHEIGHT SPP[,SPP...] REFERENCE_SPP [SEEDS]
//! ```
//!
//! A row is a number of samples a pixel. For each sampler:
//!
//! * the root mean square error over pixels, channels and seeds, relative to the image's mean;
//! * the median over the same of relative errors, `|value - reference| / (reference + mean / 100)`,
//!   which the brightest pixels do not outweigh;
//! * the median after the relative errors, with their signs, went through a Gaussian blur of one
//!   pixel's standard deviation, where blue noise shows;
//! * processor time relative to independent numbers, the smallest over the seeds, the runs of all
//!   samplers taking turns on one thread.
//!
//! The reference has seeds of its own; its error remains in what is printed, and is estimated at the
//! end.

use huygens::film::Film;
use huygens::geometry::Geometry;
use huygens::scene::{self, Scene};
use huygens::settings::{Sampler, Settings};
use huygens::wave::{Control, render};

const SAMPLERS: [Sampler; 4] = [
    Sampler::Independent,
    Sampler::Stratified,
    Sampler::Sobol,
    Sampler::BlueNoise,
];

type Pixels = Vec<[f32; 3]>;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if let Err(message) = run(&arguments) {
        eprintln!("error: {message}");
        std::process::exit(2);
    }
}

fn run(arguments: &[String]) -> Result<(), String> {
    let ([path, size, ladder, reference_spp], seeds) = arguments
        .split_first_chunk::<4>()
        .ok_or("usage: samplers SCENE WIDTHxHEIGHT SPP[,SPP...] REFERENCE_SPP [SEEDS]")?;
    let number = |text: &str| text.parse::<u32>().map_err(|e| format!("{text}: {e}"));
    let mut scene = scene::load(path.as_ref()).map_err(|e| e.to_string())?;
    let (width, height) = size.split_once('x').ok_or("the size is WIDTHxHEIGHT")?;
    (scene.film.width, scene.film.height) = (number(width)?, number(height)?);
    if let Some(extent) = scene.camera.projection.extent_mut() {
        extent.half_width = extent.half_height * scene.film.width as f32 / scene.film.height as f32;
    }
    let reference_spp = number(reference_spp)?;
    let ladder: Vec<u32> = ladder.split(',').map(number).collect::<Result<_, _>>()?;
    let seeds = seeds.first().map_or(Ok(4), |s| number(s))?;
    let geometry = Geometry::build(&scene.mesh);
    let scene = &scene;
    let shoot = |sampler, spp, seed, threads| {
        let settings = Settings {
            sampler,
            spp,
            seed,
            threads,
            ..scene.settings.clone()
        };
        picture(scene, &geometry, &settings)
    };

    let halves =
        [1_000_001, 1_000_002].map(|seed| shoot(Sampler::Sobol, reference_spp / 2, seed, 0).0);
    let reference: Pixels = halves[0]
        .iter()
        .zip(&halves[1])
        .map(|(a, b)| std::array::from_fn(|c| 0.5 * (a[c] + b[c])))
        .collect();
    let mean = reference
        .as_flattened()
        .iter()
        .map(|&v| f64::from(v))
        .sum::<f64>()
        / (3 * reference.len()) as f64;
    // Of two halves a and b, (a - b) / 2 has the variance of (a + b) / 2.
    let half: Pixels = difference(&halves[0], &halves[1])
        .iter()
        .map(|d| d.map(|v| 0.5 * v))
        .collect();

    let columns = scene.film.width as usize;
    // The square error, and relative errors without and with blur.
    let errors = |error: &Pixels| -> (f64, [Pixels; 2]) {
        let relative: Pixels = error
            .iter()
            .zip(&reference)
            .map(|(e, r)| std::array::from_fn(|c| e[c] / (r[c] + 0.01 * mean as f32)))
            .collect();
        let blurred = blurred(&relative, columns);
        (mean_square(error), [relative, blurred])
    };
    let print = |square: f64, relative: [Pixels; 2]| {
        let [plain, blurred] = relative.map(|p| median(&p));
        format!("{:.2e} {plain:.2e} {blurred:.2e}", square.sqrt() / mean)
    };

    println!("{path}, {width} x {height}, {seeds} seeds: rmse, median, median blurred, time");
    let names = SAMPLERS.map(|s| format!("{:<33}", format!("{s:?}")));
    println!("{:>5}  {}", "spp", names.join("  "));
    for spp in ladder {
        let mut squares = [0.0; 4];
        let mut relative: [[Pixels; 2]; 4] = Default::default();
        let mut seconds = [f64::INFINITY; 4];
        for seed in 0..seeds {
            for (k, sampler) in SAMPLERS.into_iter().enumerate() {
                let (pixels, time) = shoot(sampler, spp, seed, 1);
                let (square, found) = errors(&difference(&pixels, &reference));
                squares[k] += square / f64::from(seeds);
                for (all, found) in relative[k].iter_mut().zip(found) {
                    all.extend(found);
                }
                seconds[k] = seconds[k].min(time);
            }
        }
        print!("{spp:>5}");
        for (k, relative) in relative.into_iter().enumerate() {
            let time = seconds[k] / seconds[0];
            print!("  {} {time:5.3}", print(squares[k], relative));
        }
        println!();
    }
    let (square, relative) = errors(&half);
    println!("  ref  {}", print(square, relative));
    Ok(())
}

/// The image, and the processor time that it took.
fn picture(scene: &Scene, geometry: &Geometry, settings: &Settings) -> (Pixels, f64) {
    let film = Film::new(scene.film.width, scene.film.height, settings.tile);
    let start = processor_seconds();
    render(scene, geometry, settings, &film, &Control::default());
    let seconds = processor_seconds() - start;
    (film.develop().mean, seconds)
}

fn difference(a: &Pixels, b: &Pixels) -> Pixels {
    a.iter()
        .zip(b)
        .map(|(a, b)| std::array::from_fn(|c| a[c] - b[c]))
        .collect()
}

fn mean_square(pixels: &Pixels) -> f64 {
    let squares = pixels.as_flattened().iter().map(|&v| f64::from(v).powi(2));
    squares.sum::<f64>() / (3 * pixels.len()) as f64
}

/// The median of all magnitudes.
fn median(pixels: &Pixels) -> f32 {
    let mut all: Vec<f32> = pixels.as_flattened().iter().map(|v| v.abs()).collect();
    let middle = all.len() / 2;
    *all.select_nth_unstable_by(middle, f32::total_cmp).1
}

/// Convolved with a Gaussian of standard deviation 1, cut at 3 and at the borders.
fn blurred(pixels: &Pixels, width: usize) -> Pixels {
    let height = pixels.len() / width;
    let pass = |from: &Pixels, horizontal: bool| -> Pixels {
        let at = |i: usize| {
            let (x, y) = ((i % width) as isize, (i / width) as isize);
            let (mut sum, mut weights) = ([0.0f32; 3], 0.0);
            for offset in -3isize..=3 {
                let (x, y) = if horizontal {
                    (x + offset, y)
                } else {
                    (x, y + offset)
                };
                if (0..width as isize).contains(&x) && (0..height as isize).contains(&y) {
                    let weight = (-0.5 * (offset * offset) as f32).exp();
                    let pixel = from[y as usize * width + x as usize];
                    (0..3).for_each(|c| sum[c] += weight * pixel[c]);
                    weights += weight;
                }
            }
            sum.map(|s| s / weights)
        };
        (0..from.len()).map(at).collect()
    };
    pass(&pass(pixels, true), false)
}

/// Processor time of this process.
fn processor_seconds() -> f64 {
    // SAFETY: all zeros is a valid `rusage`, a struct of integers.
    let mut usage: libc::rusage = unsafe { std::mem::zeroed() };
    // SAFETY: the pointer is to a local of the right type.
    unsafe { libc::getrusage(libc::RUSAGE_SELF, &raw mut usage) };
    let seconds = |t: libc::timeval| t.tv_sec as f64 + 1e-6 * t.tv_usec as f64;
    seconds(usage.ru_utime) + seconds(usage.ru_stime)
}
