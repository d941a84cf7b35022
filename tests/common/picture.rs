//! Pictures with error bars, where they come from, and how they are kept.

use huygens::estimate::Running;
use huygens::reference::Reference;
use huygens::scene::Scene;
use huygens::settings::Settings;
use rayon::prelude::*;
use std::fmt::Write;

/// Mean of every pixel and the variance of that mean, in scanline order.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Picture {
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) mean: Vec<[f64; 3]>,
    pub(crate) variance: Vec<[f64; 3]>,
}

impl Picture {
    /// Mean over all pixels of channel `c`, and the variance of that.
    pub(crate) fn overall(&self, c: usize) -> [f64; 2] {
        let n = self.mean.len() as f64;
        [
            self.mean.iter().map(|p| p[c]).sum::<f64>() / n,
            self.variance.iter().map(|p| p[c]).sum::<f64>() / (n * n),
        ]
    }

    /// The picture with every value, and so every error, `factor` times as large.
    pub(crate) fn scaled(&self, factor: f64) -> Self {
        let scale = |column: &[[f64; 3]], f: f64| column.iter().map(|p| p.map(|v| v * f)).collect();
        Self {
            mean: scale(&self.mean, factor),
            variance: scale(&self.variance, factor * factor),
            ..*self
        }
    }

    /// As text: a comment, the size, then a line a pixel: three means, three variances of them.
    pub(crate) fn to_text(&self, comment: &str) -> String {
        let mut text = String::new();
        for line in comment.lines() {
            writeln!(text, "# {line}").unwrap();
        }
        writeln!(text, "{} {}", self.width, self.height).unwrap();
        for (m, v) in self.mean.iter().zip(&self.variance) {
            let [m, v] = [m, v].map(|p| p.map(|x| format!("{x:.7e}")).join(" "));
            writeln!(text, "{m}  {v}").unwrap();
        }
        text
    }

    /// What [`Picture::to_text`] wrote.
    pub(crate) fn from_text(text: &str) -> Self {
        let mut lines = text.lines().filter(|l| !l.starts_with('#'));
        let numbers = |line: &str| -> Vec<f64> {
            line.split_whitespace()
                .map(|n| n.parse().expect("a number"))
                .collect()
        };
        let size = numbers(lines.next().expect("a size"));
        let rows: Vec<Vec<f64>> = lines.map(numbers).collect();
        let (width, height) = (size[0] as usize, size[1] as usize);
        assert_eq!(rows.len(), width * height, "a line a pixel");
        let columns = |from: usize| {
            let pixel = |row: &Vec<f64>| std::array::from_fn(|c| row[from + c]);
            rows.iter().map(pixel).collect()
        };
        Self {
            width,
            height,
            mean: columns(0),
            variance: columns(3),
        }
    }

    /// Leaves the picture behind for whoever looks into a failure; says where.
    pub(crate) fn leave_behind(&self, name: &str) -> String {
        let path = format!("{}/{name}.txt", env!("CARGO_TARGET_TMPDIR"));
        std::fs::write(&path, self.to_text(name)).expect("the build folder is writable");
        path
    }
}

/// Renders `settings.spp` samples a pixel with the reference, directly, each pixel's moments in
/// f64.
pub(crate) fn by_reference(scene: &Scene, settings: &Settings) -> Picture {
    let reference = Reference::new(scene, settings);
    let (width, height) = (scene.film.width, scene.film.height);
    let pixel = |i: u32| -> [Running; 3] {
        let mut moments = [Running::new(); 3];
        for sample in 0..settings.spp {
            let radiance = reference.render_sample(i % width, i / width, sample);
            for (running, value) in moments.iter_mut().zip(radiance) {
                running.push(value);
            }
        }
        moments
    };
    let pixels: Vec<_> = (0..width * height).into_par_iter().map(pixel).collect();
    let error = |r: Running| r.standard_error().expect("two samples at least").powi(2);
    Picture {
        width: width as usize,
        height: height as usize,
        mean: pixels.iter().map(|p| p.map(|r| r.mean())).collect(),
        variance: pixels.iter().map(|p| p.map(error)).collect(),
    }
}
