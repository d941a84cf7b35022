//! What each effect costs where a scene calls for it: paired renders with and without, in one run.
//!
//!     cargo bench --bench effects [-- [--rounds N] [--seconds S] [FILTER]]
//!
//! A case is a shipped scene and the same with one thing changed (`cases.rs`). Both are rendered `N`
//! times (12) on one thread, about `S` processor seconds (0.25) each, who goes first alternating, and
//! compared by the logarithm of the ratio of their processor times a camera path: its mean, and
//! Student's interval of that mean, all rows together at 95% (Šidák). Ratios per ray tell how much of
//! it is that paths are longer, or cast more occlusion rays. What an effect costs where it is compiled
//! in and not called for is another experiment, of two builds: `benches/effects/run.sh`.

mod beside;
mod cases;
mod without;
mod worn;

use cases::{CASES, Case};
use huygens::estimate::{Running, sidak, student_quantile};
use huygens::film::Film;
use huygens::geometry::Geometry;
use huygens::scene::{self, Scene};
use huygens::settings::Settings;
use huygens::wave::{self, Control, Instruments};
use std::path::{Path, PathBuf};

/// Probability that any interval of the table does not hold its mean.
const SIGNIFICANCE: f64 = 0.05;

/// What the command line asks for.
struct Options {
    rounds: u64,
    seconds: f64,
    filter: String,
}

fn main() {
    let options = options().unwrap_or_else(|message| {
        eprintln!("{message}\nusage: effects [--rounds N] [--seconds S] [FILTER]");
        std::process::exit(2);
    });
    let chosen = |case: &&Case| case.name().contains(&options.filter);
    let chosen: Vec<&Case> = CASES.iter().filter(chosen).collect();
    let each = sidak(SIGNIFICANCE, chosen.len().max(1));
    println!("| scene | effect | ns a path without | with | times | interval | times, a ray |");
    println!("|---|---|---|---|---|---|---|");
    for case in chosen {
        let [without, with] = case.scenes(&shipped(case.scene));
        let mut pair = [Stand::new(without), Stand::new(with)];
        pair[0].settle(options.seconds);
        pair[1].settings.spp = pair[0].settings.spp;
        let found = compare(&mut pair, options.rounds);
        println!("{}", found.row(case, each));
    }
}

fn options() -> Result<Options, String> {
    let mut options = Options {
        rounds: 12,
        seconds: 0.25,
        filter: String::new(),
    };
    // Cargo says `--bench` to what it runs as one.
    let mut words = std::env::args().skip(1).filter(|word| word != "--bench");
    while let Some(word) = words.next() {
        let number = |text: Option<String>| {
            let number: Option<f64> = text.and_then(|text| text.parse().ok());
            let number = number.filter(|n| *n > 0.0 && n.is_finite());
            number.ok_or(format!("{word} needs a number above 0"))
        };
        match word.as_str() {
            "--rounds" => options.rounds = number(words.next())?.max(2.0) as u64,
            "--seconds" => options.seconds = number(words.next())?,
            other if other.starts_with('-') => return Err(format!("no option {other}")),
            _ => options.filter = word,
        }
    }
    Ok(options)
}

/// A shipped scene, a quarter of its size across and down.
fn shipped(name: &str) -> Scene {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let file: PathBuf = folder.join(name).with_extension("toml");
    let mut scene = scene::load(&file).expect("shipped scenes load");
    scene.film.width /= 4;
    scene.film.height /= 4;
    scene
}

/// A scene that is ready to be rendered.
struct Stand {
    scene: Scene,
    geometry: Geometry,
    settings: Settings,
}

/// What a render took.
#[derive(Clone, Copy)]
struct Cost {
    /// Processor nanoseconds a camera path.
    path: f64,
    /// The same a ray, occlusion rays among them.
    ray: f64,
}

impl Stand {
    fn new(scene: Scene) -> Self {
        let settings = Settings {
            threads: 1,
            spp: 1,
            ..scene.settings.clone()
        };
        Self {
            geometry: Geometry::of(&scene, settings.bvh),
            scene,
            settings,
        }
    }

    /// As many samples a pixel as take about `seconds`.
    fn settle(&mut self, seconds: f64) {
        let pixels = f64::from(self.scene.film.width * self.scene.film.height);
        // The first one warms up: tables of albedos are built at first use.
        self.run();
        let one = self.run().path * 1e-9 * pixels;
        self.settings.spp = ((seconds / one).ceil() as u32).clamp(1, 4096);
    }

    fn run(&self) -> Cost {
        let film = &self.scene.film;
        let film = Film::new(film.width, film.height, self.settings.tile);
        let stats = wave::render_with(
            &self.scene,
            &self.geometry,
            &self.settings,
            &film,
            &Control::default(),
            &Instruments::default(),
        );
        let nanoseconds = 1e9 * stats.cpu_seconds.unwrap_or(stats.seconds);
        let rays = stats.camera_rays + stats.bounce_rays + stats.shadow_rays;
        Cost {
            path: nanoseconds / stats.samples as f64,
            ray: nanoseconds / rays as f64,
        }
    }
}

/// A pair, compared.
struct Found {
    /// Mean nanoseconds a path, without and with.
    path: [f64; 2],
    /// Logarithms of the ratios of times a path.
    paths: Running,
    /// And of those a ray.
    rays: Running,
}

fn compare(pair: &mut [Stand; 2], rounds: u64) -> Found {
    let mut found = Found {
        path: [0.0; 2],
        paths: Running::new(),
        rays: Running::new(),
    };
    pair[1].run();
    for round in 0..rounds {
        let first = (round % 2) as usize;
        let mut costs = [Cost {
            path: 0.0,
            ray: 0.0,
        }; 2];
        for which in [first, 1 - first] {
            costs[which] = pair[which].run();
        }
        for (sum, cost) in found.path.iter_mut().zip(costs) {
            *sum += cost.path / rounds as f64;
        }
        found.paths.push((costs[1].path / costs[0].path).ln());
        found.rays.push((costs[1].ray / costs[0].ray).ln());
    }
    found
}

impl Found {
    fn row(&self, case: &Case, significance: f64) -> String {
        let freedom = self.paths.count() - 1;
        let quantile = student_quantile(1.0 - 0.5 * significance, freedom);
        let half = quantile * self.paths.standard_error().expect("two rounds or more");
        let mean = self.paths.mean();
        format!(
            "| {} | {} | {:.0} | {:.0} | {:.3} | {:.3} to {:.3} | {:.3} |",
            case.scene,
            case.effect,
            self.path[0],
            self.path[1],
            mean.exp(),
            (mean - half).exp(),
            (mean + half).exp(),
            self.rays.mean().exp()
        )
    }
}
