//! The reference image: given, cached, or made to a stated error.

use super::weight::{over, weight};
use super::{Stage, seed_of};
use crate::accuracy::Picture;
use crate::accuracy::difference::floor;
use crate::estimate::Running;
use crate::film::exr::{ExrImage, ExrOptions, Metadata, ReadError, read_exr, write_exr};
use crate::film::output::OutputError;
use crate::film::{Image, output};
use crate::scene::Scene;
use crate::settings::{Integrator, Sampler, Settings, Strategy};
use std::path::Path;
use std::time::Instant;

/// Names the seeds of reference images among all seeds.
const TAG: u64 = 0x7275_7468;

/// Passes before the noise of a reference is believed: its variance is then known to a third in a
/// pixel, and over an image to a small part of that.
const FEWEST_PASSES: u32 = 16;

/// Camera samples of a pass, about: enough for the passes to be few, not so many that a study of a
/// small image could not stop in time.
const PASS: usize = 1 << 20;

/// The reference image of a study.
#[derive(Clone, Debug, PartialEq)]
pub struct Truth {
    /// Colours, and the variance of each; variance 0 where nothing is known of it.
    pub image: Image,
    /// Where it comes from.
    pub what: String,
    /// Mean absolute radiance over pixels and channels, positive.
    pub brightness: f64,
    /// What squared errors of each colour are multiplied with to be relative: `1 / (b^2 + m^2 / 100)`
    /// with `b` the colour and `m` the brightness, as relMSE has it, less what the colour's own noise adds
    /// to that.
    pub weight: Vec<[f64; 3]>,
    /// Mean variance over pixels and channels; 0 if nothing is known.
    pub noise: f64,
    /// The same of relative errors, by these weights: what the reference adds to squares of errors.
    pub relative_noise: f64,
    /// Its own relative error: the root mean square of its standard errors, each over what it measured;
    /// 0 if unknown.
    pub error: f64,
    /// Wall-clock seconds that it took, if it was made here.
    pub seconds: Option<f64>,
}

/// Why an image is no reference.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum TruthError {
    /// It cannot be read.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Read(#[from] ReadError),
    /// It is of another size.
    #[error("the reference has {0} x {1} pixels, the study {2} x {3}; expected one size")]
    Size(u32, u32, u32, u32),
    /// It has pixels that are not finite.
    #[error("the reference has {0} pixels that are not finite")]
    NotFinite(usize),
    /// It is black.
    #[error("the reference is black: there is nothing to compare")]
    Black,
    /// It was stopped before its noise was known.
    #[error("there was no time for a reference image")]
    Stopped,
}

impl Truth {
    fn new(image: Image, what: String, seconds: Option<f64>) -> Result<Self, TruthError> {
        let finite = |p: &&[f32; 3]| !p.iter().all(|v| v.is_finite());
        let wrong = image.mean.iter().filter(finite).count();
        if wrong > 0 {
            return Err(TruthError::NotFinite(wrong));
        }
        let brightness = mean(image.mean.as_flattened().iter().map(|v| f64::from(v.abs())));
        if brightness <= 0.0 {
            return Err(TruthError::Black);
        }
        let floor = floor(brightness);
        let colours = image.mean.iter().zip(&image.variance);
        let of = |(b, v): (&[f32; 3], &[f32; 3])| {
            [0, 1, 2].map(|c| weight(b[c].into(), v[c].into(), floor))
        };
        let weight: Vec<[f64; 3]> = colours.map(of).collect();
        let values = || image.mean.as_flattened().iter().map(|&b| f64::from(b));
        let noise = || image.variance.as_flattened().iter().map(|&v| f64::from(v));
        let relative = noise().zip(weight.as_flattened()).map(|(v, w)| v * w);
        let own = noise().zip(values()).map(|(v, b)| v * over(b, floor));
        Ok(Self {
            noise: mean(noise()),
            relative_noise: mean(relative),
            error: mean(own).sqrt(),
            image,
            what,
            brightness,
            weight,
            seconds,
        })
    }

    /// A reference from an EXR file. Its noise counts as 0 where the file has no variance of it.
    ///
    /// # Errors
    /// If it cannot be read, is not of the scene's size, not finite, or black.
    pub fn given(path: &Path, scene: &Scene) -> Result<Self, TruthError> {
        Self::from_exr(read_exr(path)?, path.display().to_string(), scene)
    }

    fn from_exr(exr: ExrImage, what: String, scene: &Scene) -> Result<Self, TruthError> {
        let film = &scene.film;
        if (exr.width, exr.height) != (film.width, film.height) {
            let (width, height) = (film.width, film.height);
            return Err(TruthError::Size(exr.width, exr.height, width, height));
        }
        let pixels = exr.rgb.len();
        let known = |v: &Vec<[f32; 3]>| v.as_flattened().iter().all(|v| v.is_finite());
        let image = Image {
            width: exr.width,
            height: exr.height,
            mean: exr.rgb,
            variance: exr.variance.filter(known).unwrap_or(vec![[0.0; 3]; pixels]),
            samples: exr.samples.unwrap_or(vec![0; pixels]),
        };
        Self::new(image, what, None)
    }

    /// The reference at `path`, if it was stored there for this scene, size and integrator, with an
    /// error of at most `error`.
    #[must_use]
    pub fn cached(path: &Path, scene: &Scene, error: f64) -> Option<Self> {
        let exr = read_exr(path).ok()?;
        let said = |name: &str| exr.attributes.get(name);
        let hash = blake3::Hash::from_bytes(scene.hash).to_hex();
        let same = said("huygens.sceneHash").is_some_and(|h| h.as_str() == hash.as_str())
            && said("huygens.settings") == Some(&key(scene));
        let truth = Self::from_exr(exr, path.display().to_string(), scene).ok()?;
        (same && truth.noise > 0.0 && truth.error <= error).then_some(truth)
    }

    /// Stores it for [`Truth::cached`].
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn store(&self, path: &Path, scene: &Scene) -> Result<(), OutputError> {
        output::ensure_writable(path)?;
        let metadata = Metadata {
            scene: scene.name.clone(),
            scene_hash: scene.hash,
            spp: self.image.samples.first().copied().unwrap_or(0),
            seed: scene.settings.seed,
            settings: key(scene),
            seconds: self.seconds.unwrap_or(0.0),
        };
        let options = ExrOptions {
            half: false,
            variance: true,
        };
        write_exr(path, &self.image, &metadata, options).map(drop)
    }

    /// Makes a reference: passes with seeds of their own, until the root mean square of their relative
    /// standard errors is `error`, or `deadline` is over. The variance is that of the passes about
    /// their mean, so it is right whatever the sampler.
    ///
    /// # Errors
    /// If it is stopped before its noise is known, or the image is black or not finite.
    pub fn make(stage: &Stage, error: f64, deadline: Option<Instant>) -> Result<Self, TruthError> {
        let start = Instant::now();
        let settings = settings(stage);
        let mut sums = vec![[Running::new(); 3]; stage.pixels()];
        let mut passes = 0;
        let over = || deadline.is_some_and(|d| Instant::now() >= d);
        let mut far = f64::INFINITY;
        while far > error && !(passes >= FEWEST_PASSES && over()) {
            let share = (error / far).powi(2);
            (stage.progress)(&format!("reference, pass {}", passes + 1), share);
            let seed = seed_of(&[u64::from(settings.seed), TAG, u64::from(passes)]);
            let pass = Settings {
                seed,
                ..settings.clone()
            };
            let Some((image, _)) = stage.render(&pass) else {
                break;
            };
            for (sum, value) in sums.iter_mut().zip(&image.mean) {
                (0..3).for_each(|c| sum[c].push(value[c].into()));
            }
            passes += 1;
            if passes >= FEWEST_PASSES {
                far = relative_error(&sums);
            }
        }
        if passes < FEWEST_PASSES {
            return Err(TruthError::Stopped);
        }
        let samples = settings.spp.saturating_mul(passes);
        let image = Image {
            width: stage.scene.film.width,
            height: stage.scene.film.height,
            mean: sums.iter().map(|p| p.map(|c| c.mean() as f32)).collect(),
            variance: sums
                .iter()
                .map(|p| p.map(|c| variance(&c) as f32))
                .collect(),
            samples: vec![samples; stage.pixels()],
        };
        let what = format!("made here, {samples} samples a pixel");
        Self::new(image, what, Some(start.elapsed().as_secs_f64()))
    }

    /// Mean squared relative error of an image of its size, its own noise included.
    #[must_use]
    pub fn relative_mse(&self, rgb: &[[f32; 3]]) -> f64 {
        mean(self.relative_squares(rgb))
    }

    /// Squared relative errors of each value, its own noise included.
    pub(super) fn relative_squares(&self, rgb: &[[f32; 3]]) -> impl ExactSizeIterator<Item = f64> {
        let pairs = rgb
            .as_flattened()
            .iter()
            .zip(self.image.mean.as_flattened());
        let errors = pairs.map(|(a, b)| f64::from(*a) - f64::from(*b));
        errors
            .zip(self.weight.as_flattened())
            .map(|(e, w)| e * e * w)
    }

    /// As a picture to compare with.
    #[must_use]
    pub fn picture(&self) -> Picture<'_> {
        Picture::from(&self.image)
    }
}

/// Variance of the mean.
fn variance(running: &Running) -> f64 {
    running.standard_error().map_or(f64::INFINITY, |e| e * e)
}

fn relative_error(sums: &[[Running; 3]]) -> f64 {
    let all = sums.as_flattened();
    let floor = floor(mean(all.iter().map(|r| r.mean().abs())));
    mean(all.iter().map(|r| variance(r) * over(r.mean(), floor))).sqrt()
}

fn mean(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let n = values.len() as f64;
    values.sum::<f64>() / n
}

/// What the passes of a reference are rendered with: the best that there is for most scenes, to the
/// same limit of the integrator and the same depth.
fn settings(stage: &Stage) -> Settings {
    let usual = Settings::default();
    let spp = (PASS / stage.pixels()).clamp(4, 64) as u32;
    Settings {
        strategy: Strategy::Mis,
        sampler: Sampler::Sobol,
        // A power of two, which suits the sampler.
        spp: 1 << spp.ilog2(),
        roulette: true,
        survival: usual.survival,
        wave: usual.wave,
        integrator: match stage.scene.settings.integrator {
            Integrator::Reference => Integrator::Path,
            other => other,
        },
        ..stage.scene.settings.clone()
    }
}

/// All that a reference depends on besides the scene's hash.
fn key(scene: &Scene) -> String {
    let (film, s) = (&scene.film, &scene.settings);
    format!(
        "reference of {}x{}, filter {:?}, integrator {:?}, depth {}, images {:?}",
        film.width,
        film.height,
        film.filter,
        s.integrator,
        s.max_depth.map_or("none".to_owned(), |d| d.to_string()),
        s.texture_lod,
    )
}
