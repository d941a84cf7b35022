//! Studies as pages: what `--html` and `--svg` write.

use super::scene::Done;
use super::scene_table::{cost, percent};
use crate::cli::failure::Failure;
use crate::cli::options::as_options;
use crate::cli::summary::plural;
use crate::cli::text::{duration, si};
use huygens::accuracy::report::{Cell, Fact, Line, Mark, Page, Picture, Plot, Table};
use huygens::accuracy::scene::SceneCurve;
use huygens::accuracy::{Curve, Ladder, Point, Problem, Study};
use huygens::film::png::{Look, png_bytes};

/// The page of a study of an integral.
pub(super) fn known(problem: &Problem, ladder: &Ladder, study: &Study) -> Page {
    let mut guides: Vec<f64> = study
        .curves
        .iter()
        .filter_map(|c| c.expected_slope)
        .collect();
    guides.sort_by(|a, b| b.total_cmp(a));
    guides.dedup();
    let plot = |name: &str, along: &str, x: fn(&Point) -> f64| Plot {
        name: name.into(),
        title: format!("Error against {along}"),
        axes: [along.into(), "error (root mean square)".into()],
        lines: study.curves.iter().map(|c| known_line(c, x)).collect(),
        guides: guides.clone(),
    };
    Page {
        title: format!("What accuracy costs: {}", problem.what),
        summary: vec![format!(
            "{} estimates at each rung, of {}, which is {}.",
            ladder.repetitions, problem.what, problem.exact
        )],
        facts: facts(&[("seed", ladder.seed.to_string())]),
        plots: vec![
            plot("error-samples", "samples", |p| p.samples as f64),
            plot("error-time", "seconds", |p| p.seconds),
        ],
        table: Table {
            columns: columns(&[
                ("estimator", "name"),
                ("what", "what it does"),
                ("samples", "on the last rung"),
                ("time", "of one estimate there"),
                ("error", "root mean square there"),
                ("slope", "power of the samples that the error goes with"),
                ("theory", "that power for many samples"),
            ]),
            rows: study.curves.iter().filter_map(known_row).collect(),
        },
        ..Page::default()
    }
}

fn known_line(curve: &Curve, x: fn(&Point) -> f64) -> Line {
    let mark = |p: &Point| Mark {
        at: [x(p), p.rmse],
        tip: format!(
            "{}\n{} samples, {}\nerror {:.3e}",
            curve.name,
            p.samples,
            duration(p.seconds),
            p.rmse
        ),
    };
    Line {
        name: curve.name.clone(),
        group: String::new(),
        marks: curve.points.iter().map(mark).collect(),
    }
}

fn known_row(curve: &Curve) -> Option<Vec<Cell>> {
    let last = curve.points.last()?;
    Some(vec![
        Cell::text(&curve.name),
        Cell::text(&curve.what),
        Cell::number(Some(last.samples as f64), last.samples.to_string()),
        Cell::number(Some(last.seconds), duration(last.seconds)),
        Cell::number(Some(last.rmse), format!("{:.2e}", last.rmse)),
        slope(curve.slope),
        slope(curve.expected_slope),
    ])
}

fn slope(slope: Option<f64>) -> Cell {
    Cell::number(slope, slope.map_or("?".into(), |s| format!("{s:.3}")))
}

/// The facts of every study, with some of its own.
fn facts(own: &[(&str, String)]) -> Vec<Fact> {
    let fact = |name: &str, value: String, code| Fact {
        name: name.into(),
        value,
        code,
    };
    let version = concat!("huygens ", env!("CARGO_PKG_VERSION")).to_owned();
    let mut facts = vec![fact("command", super::command(), true)];
    facts.extend(
        own.iter()
            .map(|(n, v)| fact(n, v.clone(), *n == "settings")),
    );
    facts.push(fact("machine", super::machine(), false));
    facts.push(fact("program", version, false));
    facts
}

fn columns(all: &[(&str, &str)]) -> Vec<(String, String)> {
    let own = |(name, meaning): &(&str, &str)| ((*name).to_owned(), (*meaning).to_owned());
    all.iter().map(own).collect()
}

/// The page of a study of a scene.
pub(super) fn scene(done: &Done) -> Result<Page, Failure> {
    let truth = done.truth;
    let film = &done.scene.film;
    let noise = if truth.noise > 0.0 {
        format!("; its own error is {}", percent(truth.error()))
    } else {
        String::new()
    };
    let plot =
        |name: &str, axes: [&str; 2], at: fn(&SceneCurve, usize) -> [f64; 2], guides: &[f64]| {
            Plot {
                name: name.into(),
                title: format!("{} against {}", axes[1], axes[0]),
                axes: axes.map(str::to_owned),
                lines: done.study.measured().map(|c| line(c, at)).collect(),
                guides: guides.to_vec(),
            }
        };
    let goal = percent(done.target_error);
    let mut page = Page {
        title: format!("What accuracy costs: {}", done.scene.name),
        summary: vec![done.advice.clone()],
        facts: facts(&[
            ("scene", done.file.display().to_string()),
            ("settings", as_options(done.scene)),
            ("image", format!("{} x {} pixels", film.width, film.height)),
            ("reference", format!("{}{noise}", truth.what)),
            (
                "measured",
                format!(
                    "{} at each rung on {}, in {}; ended: {}",
                    plural(done.ladder.repetitions.into(), "render"),
                    plural(done.threads as u64, "thread"),
                    duration(done.seconds),
                    done.ended
                ),
            ),
        ]),
        plots: vec![
            plot(
                "error-time",
                ["seconds of a render", "Relative error"],
                |c, i| [c.curve.points[i].point.seconds, c.curve.points[i].error],
                &[-0.5],
            ),
            plot(
                "error-samples",
                ["samples a pixel", "Relative error"],
                |c, i| {
                    [
                        c.curve.points[i].point.samples as f64,
                        c.curve.points[i].error,
                    ]
                },
                &[-0.5],
            ),
            plot(
                "rays-samples",
                ["samples a pixel", "Rays"],
                |c, i| {
                    [
                        c.curve.points[i].point.samples as f64,
                        c.curve.points[i].rays as f64,
                    ]
                },
                &[],
            ),
        ],
        table: Table {
            columns: columns(&[
                ("choice", "name; the scene's own settings are the base"),
                ("varies", "what it is about"),
                ("options", "what makes it"),
                ("spp", "samples a pixel on its last rung"),
                ("time", "of a render there"),
                ("rays", "of a render there"),
                ("error", "root of the mean squared relative error there"),
                (
                    "bias",
                    "the part of it that stays, where it is beyond doubt",
                ),
                ("slope", "power of the samples that the error goes with"),
                (
                    "efficiency",
                    "1 / (squared error x time) over that of the base",
                ),
                (
                    &format!("to {goal}"),
                    "time to that error; ~ off the ladder, > where more stays",
                ),
            ]),
            rows: done.study.measured().filter_map(|c| row(c, done)).collect(),
        },
        ..Page::default()
    };
    pictures(done, &mut page)?;
    Ok(page)
}

fn line(curve: &SceneCurve, at: fn(&SceneCurve, usize) -> [f64; 2]) -> Line {
    let points = curve.curve.points.iter().enumerate();
    let marks = points.map(|(i, p)| Mark {
        at: at(curve, i),
        tip: format!(
            "{}\n{}, {}\n{} rays\nerror {}",
            curve.curve.name,
            plural(p.point.samples, "sample"),
            duration(p.point.seconds),
            si(p.rays as f64).trim_end(),
            percent(p.error)
        ),
    });
    Line {
        name: curve.curve.name.clone(),
        group: curve.family_name(),
        marks: marks.collect(),
    }
}

fn row(curve: &SceneCurve, done: &Done) -> Option<Vec<Cell>> {
    let last = curve.curve.points.last()?;
    let known = |v: Option<f64>, text: fn(f64) -> String| {
        Cell::number(v, v.map_or_else(|| "?".into(), text))
    };
    let bias = curve.bias();
    let goal = curve.cost_of(done.target_error);
    Some(vec![
        Cell::text(&curve.curve.name),
        Cell::text(curve.family_name()),
        Cell::text(&curve.options),
        Cell::number(
            Some(last.point.samples as f64),
            last.point.samples.to_string(),
        ),
        Cell::number(Some(last.point.seconds), duration(last.point.seconds)),
        Cell::number(Some(last.rays as f64), si(last.rays as f64).trim_end()),
        Cell::number(Some(last.error), percent(last.error)),
        Cell::number(
            Some(bias),
            if bias > 0.0 {
                percent(bias)
            } else {
                "none seen".into()
            },
        ),
        slope(curve.curve.slope),
        known(curve.efficiency, |v| format!("{v:.2}")),
        Cell::number(goal.seconds(), cost(goal)),
    ])
}

fn pictures(done: &Done, page: &mut Page) -> Result<(), Failure> {
    let Some(strips) = done.strips.as_ref().filter(|s| !s.strips.is_empty()) else {
        return Ok(());
    };
    let (width, height) = (done.scene.film.width, done.scene.film.height);
    let picture = |name: &str, caption: String, pixels: &[[f32; 3]]| {
        let png = png_bytes(width, height, pixels, Look::default());
        let png = png.map_err(|e| Failure::Other(miette::miette!("cannot make a PNG: {e}")))?;
        Ok::<_, Failure>(Picture {
            name: name.into(),
            caption,
            png,
            width,
            height,
        })
    };
    page.pictures_title = format!("Images at equal time, {}", duration(strips.seconds));
    let reference = picture("reference", String::new(), &done.truth.image.mean)?;
    page.pictures.push(reference);
    for strip in &strips.strips {
        let caption = format!(
            "{}, {}, error {}",
            plural(strip.samples.into(), "sample"),
            duration(strip.seconds),
            percent(strip.error)
        );
        page.pictures
            .push(picture(&strip.name, caption, &strip.pixels)?);
    }
    Ok(())
}
