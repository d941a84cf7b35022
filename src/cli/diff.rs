//! `huygens diff`.

mod json;

use crate::cli::failure::{Failure, warn};
use crate::cli::summary::plural;
use crate::cli::text::out;
use crate::cli::values;
use huygens::accuracy::{
    Difference, NoiseOf, Picture, TRIM, difference, false_colour, flip, pixel_errors,
};
use huygens::film::exr::{ExrImage, read_exr};
use huygens::film::output::{Format, ensure_writable};
use huygens::film::png::{Look, write_png};
use huygens::film::tone::ToneMap;
use miette::Report;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Measure how far an image is from a reference
#[derive(Debug, clap::Args)]
#[command(args_override_self = true)]
pub(crate) struct Args {
    /// Image (.exr)
    image: PathBuf,

    /// Reference (.exr), of the same size
    reference: PathBuf,

    /// Error image to write (.png): the mean over the channels of |image - reference|, from black to
    /// white; blue where either is not finite
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,

    /// Error that the error image shows as white, above 0 [default: the largest, but for one pixel in
    /// a hundred]
    #[arg(long, value_name = "ERROR", value_parser = values::positive)]
    #[arg(allow_negative_numbers = true)]
    scale: Option<f32>,

    /// Write the measures as JSON (see docs/accuracy.md)
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,

    /// Print nothing but warnings and errors
    #[arg(short, long)]
    quiet: bool,
}

/// Runs `huygens diff`.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    if let Some(path) = &args.output {
        ensure_png(path)?;
        ensure_writable(path)?;
    }
    if let Some(path) = &args.json {
        ensure_writable(path)?;
    }
    let read = |path| read_exr(path).map_err(|e| Failure::Input(Report::new(e)));
    let (image, reference) = (read(&args.image)?, read(&args.reference)?);
    let (a, b) = (Picture::from(&image), Picture::from(&reference));
    let wrong = |e: huygens::accuracy::DifferenceError| {
        let names = [&args.image, &args.reference].map(|p| p.display().to_string());
        Failure::input(format!(
            "cannot compare {} with {}: {e}",
            names[0], names[1]
        ))
    };
    let measures = difference(a, b).map_err(wrong)?;
    warn(&warnings(args, &measures, &image, &reference), false)?;
    let mut scale = None;
    if let Some(path) = &args.output {
        let errors = pixel_errors(a, b).map_err(wrong)?;
        let white = args
            .scale
            .map_or_else(|| all_but_the_largest(&errors), f64::from);
        write_error_image(path, &image, &errors, white)?;
        scale = Some(white);
    }
    let seen = flip(a, b);
    if let Some(path) = &args.json {
        json::Report::new(&args.image, &args.reference, a, &measures, seen, scale).write(path)?;
    }
    if !args.quiet {
        out(&text(args, a, &measures));
        if let Some(seen) = seen {
            out(&format!("  FLIP     {seen:.4}\n"));
        }
        if let (Some(path), Some(white)) = (&args.output, scale) {
            out(&format!(
                "  wrote    {}, white is {white:.3e}\n",
                path.display()
            ));
        }
    }
    Ok(())
}

fn ensure_png(path: &Path) -> Result<(), Failure> {
    match Format::of(path)? {
        Format::Png => Ok(()),
        Format::Exr => Err(Failure::input(format!(
            "cannot write {}: an error image is a .png",
            path.display()
        ))),
    }
}

fn warnings(
    args: &Args,
    measures: &Difference,
    image: &ExrImage,
    reference: &ExrImage,
) -> Vec<String> {
    let mut warnings = Vec::new();
    if args.scale.is_some() && args.output.is_none() {
        warnings.push("--scale does nothing: no error image is written".to_owned());
    }
    if measures.left_out > 0 {
        let count = plural(measures.left_out as u64, "pixel");
        warnings.push(format!("{count} left out, not finite in both images"));
    }
    let same = |name: &str| {
        let [a, b] = [image, reference].map(|i| i.attributes.get(name));
        a.is_some() && a == b
    };
    let random = same("huygens.seed") && same("huygens.sceneHash");
    if random && measures.noise_of == NoiseOf::Both {
        warnings.push(
            "both images are renders of one scene with one seed, so their noise may be the same; \
             the intervals take it as independent"
                .to_owned(),
        );
    }
    warnings
}

fn text(args: &Args, a: Picture, d: &Difference) -> String {
    let mut text = format!(
        "{} against {}, {} x {} pixels\n",
        args.image.display(),
        args.reference.display(),
        a.width,
        a.height
    );
    let mut line = |label: &str, what: String| {
        let _ = writeln!(text, "  {label:<8} {what}");
    };
    let of = match d.noise_of {
        NoiseOf::Both => "both images",
        NoiseOf::Image => "the image",
        NoiseOf::Reference => "the reference",
        NoiseOf::None => "",
    };
    let noise = d.noise.map_or_else(String::new, |noise| {
        format!("; the noise of {of} alone gives {noise:.3e}")
    });
    line("MSE", format!("{:.3e}{noise}", d.mse));
    line("RMSE", format!("{:.3e}", d.rmse));
    let number = |v: Option<f64>| v.map_or_else(|| "?".to_owned(), |v| format!("{v:.3e}"));
    let share = 100.0 / TRIM as f64;
    line(
        "relMSE",
        match d.rel_mse {
            None => "none: the reference is black".to_owned(),
            known => format!(
                "{} without the worst {share}% of the pixels, {} with them",
                number(known),
                number(d.rel_mse_all)
            ),
        },
    );
    line("MAE", format!("{:.3e}", d.mae));
    line(
        "max",
        format!("{:.3e} at ({}, {})", d.max.value, d.max.x, d.max.y),
    );
    let bias = |c: usize| {
        let interval = d.bias_interval.map_or_else(String::new, |i| {
            format!(", 95% interval {:+.3e} to {:+.3e}", i[c][0], i[c][1])
        });
        format!("{} {:+.3e}{interval}", ["R", "G", "B"][c], d.bias[c])
    };
    for (c, label) in ["bias", "", ""].into_iter().enumerate() {
        line(label, bias(c));
    }
    text
}

/// By default, one pixel in so many is as white as white or would be whiter. Most errors of a render
/// are small, and a few pixels on the edges of lights would leave the others black.
const WHITE: usize = 100;

/// The largest error but for those of one pixel in [`WHITE`], or the largest of all where that is 0;
/// 1 if there is none.
fn all_but_the_largest(errors: &[Option<f64>]) -> f64 {
    let mut known: Vec<f64> = errors.iter().filter_map(|e| *e).collect();
    known.sort_by(f64::total_cmp);
    let kept = known.len() - known.len() / WHITE;
    let largest = |n: usize| known[..n].last().copied().filter(|e| *e > 0.0);
    largest(kept)
        .or_else(|| largest(known.len()))
        .unwrap_or(1.0)
}

fn write_error_image(
    path: &Path,
    image: &ExrImage,
    errors: &[Option<f64>],
    white: f64,
) -> Result<(), Failure> {
    let colour = |e: &Option<f64>| false_colour(e.map_or(f64::NAN, |e| e / white));
    let pixels: Vec<[f32; 3]> = errors.iter().map(colour).collect();
    let look = Look {
        scale: 1.0,
        tone_map: ToneMap::None,
    };
    Ok(write_png(path, image.width, image.height, &pixels, look)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scale_leaves_out_one_pixel_in_a_hundred() {
        let mut errors: Vec<Option<f64>> = (1..=1000).map(|i| Some(f64::from(i))).collect();
        assert_eq!(all_but_the_largest(&errors), 990.0);
        errors.push(None);
        assert_eq!(all_but_the_largest(&errors), 990.0);
        assert_eq!(all_but_the_largest(&[Some(0.5), Some(2.0)]), 2.0);
        assert_eq!(all_but_the_largest(&[Some(0.0), None]), 1.0);
        // One wrong pixel in an image that is right elsewhere is still seen.
        let mut right = vec![Some(0.0); 2000];
        right[7] = Some(3.0);
        assert_eq!(all_but_the_largest(&right), 3.0);
    }
}
