//! Pictures with error bars, where they come from, and how they are kept.

use huygens::estimate::Running;
use huygens::film::{Film, Image};
use huygens::geometry::Geometry;
use huygens::reference::Reference;
use huygens::scene::Scene;
use huygens::settings::{Sampler, Settings};
use huygens::wave::{self, Control, RenderStats};
use rayon::prelude::*;
use std::fmt::Write;

/// Mean of every pixel, and how it scatters, in scanline order.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Picture {
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) mean: Vec<[f64; 3]>,
    /// Variance of that mean.
    pub(crate) variance: Vec<[f64; 3]>,
    /// Skewness of that mean; 0 where nothing is known of it.
    pub(crate) skewness: Vec<[f64; 3]>,
}

impl Picture {
    /// Mean over all pixels of channel `c`, and the variance of that.
    pub(crate) fn overall(&self, c: usize) -> Mean {
        let n = self.mean.len() as f64;
        Mean {
            value: self.mean.iter().map(|p| p[c]).sum::<f64>() / n,
            variance: self.variance.iter().map(|p| p[c]).sum::<f64>() / (n * n),
        }
    }

    /// The picture with every value, and so every error, `factor` times as large.
    pub(crate) fn scaled(&self, factor: f64) -> Self {
        let scale = |column: &[[f64; 3]], f: f64| column.iter().map(|p| p.map(|v| v * f)).collect();
        Self {
            mean: scale(&self.mean, factor),
            variance: scale(&self.variance, factor * factor),
            ..self.clone()
        }
    }

    /// Leaves the picture behind for whoever looks into a failure; says where.
    pub(crate) fn leave_behind(&self, name: &str) -> String {
        let mut text = format!("# {name}: x, y, mean red green blue, variances of these means\n");
        for (i, (m, v)) in self.mean.iter().zip(&self.variance).enumerate() {
            let (x, y) = (i % self.width, i / self.width);
            writeln!(text, "{x} {y}  {m:?}  {v:?}").expect("a string takes all");
        }
        let path = format!("{}/{name}.txt", env!("CARGO_TARGET_TMPDIR"));
        std::fs::write(&path, text).expect("the build folder is writable");
        path
    }
}

/// Renders `settings.spp` samples a pixel with the reference, directly, in f64 throughout.
pub(crate) fn by_reference(scene: &Scene, settings: &Settings) -> Picture {
    let reference = Reference::new(scene, settings);
    let (width, height) = (scene.film.width, scene.film.height);
    let n = f64::from(settings.spp);
    // Mean, variance of the mean and skewness of the mean of each channel.
    let pixel = |i: u32| -> [[f64; 3]; 3] {
        let samples: Vec<[f64; 3]> = (0..settings.spp)
            .map(|sample| reference.render_sample(i % width, i / width, sample))
            .collect();
        let channel = |c: usize| {
            let moment = |power: i32, about: f64| {
                samples
                    .iter()
                    .map(|s| (s[c] - about).powi(power))
                    .sum::<f64>()
            };
            let mean = moment(1, 0.0) / n;
            let variance = moment(2, mean) / (n - 1.0);
            let skewness = if variance > 0.0 {
                moment(3, mean) / n / variance.powf(1.5)
            } else {
                0.0
            };
            [mean, variance / n, skewness / n.sqrt()]
        };
        [0, 1, 2].map(channel)
    };
    let pixels: Vec<_> = (0..width * height).into_par_iter().map(pixel).collect();
    let column = |k: usize| pixels.iter().map(|p| p.map(|channel| channel[k])).collect();
    Picture {
        width: width as usize,
        height: height as usize,
        mean: column(0),
        variance: column(1),
        skewness: column(2),
    }
}

/// Renders through the wave.
pub(crate) fn render(scene: &Scene, settings: &Settings) -> (Image, RenderStats) {
    let film = Film::new(scene.film.width, scene.film.height, settings.tile);
    let geometry = Geometry::of(scene, settings.bvh);
    let stats = wave::render(scene, &geometry, settings, &film, &Control::default());
    assert_eq!(
        stats.samples,
        u64::from(scene.film.width * scene.film.height) * u64::from(settings.spp),
        "every sample was rendered"
    );
    assert!(stats.dropped.is_empty(), "{:?}", stats.dropped);
    assert!(stats.untraceable.is_empty(), "{:?}", stats.untraceable);
    (film.develop(), stats)
}

/// The default settings, but with independent samples: the error bars of a film are those of
/// independent samples.
pub(crate) fn independent() -> Settings {
    Settings {
        sampler: Sampler::Independent,
        ..Settings::default()
    }
}

/// The mean of renders with the seeds `0 .. renders`, whatever their sampler: its error bars are from
/// how the renders scatter about their mean, which they do independently. Normal quantiles are used
/// with them, so they are wider by what Student's distribution exceeds a normal one by, to first
/// order, at `z` standard errors.
pub(crate) fn over_seeds(scene: &Scene, settings: &Settings, renders: u32, z: f64) -> Picture {
    let mut pixels = vec![[Running::new(); 3]; (scene.film.width * scene.film.height) as usize];
    for seed in 0..renders {
        let settings = Settings {
            seed,
            ..settings.clone()
        };
        let image = render(scene, &settings).0;
        for (pixel, mean) in pixels.iter_mut().zip(image.mean) {
            (0..3).for_each(|c| pixel[c].push(mean[c].into()));
        }
    }
    let student = 1.0 + (z * z + 1.0) / (4.0 * f64::from(renders - 1));
    let bars = |pixel: &Running| Mean::from(pixel).variance * student * student;
    Picture {
        width: scene.film.width as usize,
        height: scene.film.height as usize,
        mean: pixels.iter().map(|p| p.map(|c| c.mean())).collect(),
        variance: pixels.iter().map(|p| p.each_ref().map(bars)).collect(),
        skewness: vec![[0.0; 3]; pixels.len()],
    }
}

/// A picture through the wave, of independent samples.
pub(crate) fn by_wave(scene: &Scene, settings: &Settings) -> Picture {
    let image = render(scene, settings).0;
    Picture {
        width: image.width as usize,
        height: image.height as usize,
        mean: image.mean.iter().map(|p| p.map(f64::from)).collect(),
        variance: image.variance.iter().map(|p| p.map(f64::from)).collect(),
        skewness: vec![[0.0; 3]; image.mean.len()],
    }
}

/// Mean of channel 0 over a film whose pixels all mean the same, with its standard error.
pub(crate) fn mean_by_wave(scene: &Scene, settings: &Settings) -> Mean {
    by_wave(scene, settings).overall(0)
}

/// An estimate with its error.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Mean {
    pub(crate) value: f64,
    pub(crate) variance: f64,
}

impl From<&Running> for Mean {
    fn from(running: &Running) -> Self {
        Self {
            value: running.mean(),
            variance: running
                .standard_error()
                .expect("two values at least")
                .powi(2),
        }
    }
}

/// The image of `scene` has the same bits for any number of threads, wave capacity and tile size, with
/// branches and without.
#[track_caller]
pub(crate) fn same_bits_however_it_runs(scene: &Scene) {
    for split in [vec![], vec![3, 2]] {
        let base = Settings {
            spp: 30,
            split,
            threads: 1,
            wave: 4096,
            ..Settings::default()
        };
        let bits = |settings: &Settings| -> Vec<[u32; 3]> {
            let image = render(scene, settings).0;
            image.mean.iter().map(|p| p.map(f32::to_bits)).collect()
        };
        let whole = bits(&base);
        for (threads, wave, tile) in [(3, 64, 2), (2, 8, 3), (1, 500, 16)] {
            let settings = Settings {
                threads,
                wave,
                tile,
                ..base.clone()
            };
            assert!(bits(&settings) == whole, "{threads}, {wave}, {tile}");
        }
    }
}
