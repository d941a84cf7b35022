//! A study of a scene as a page.

use super::pages::{columns, facts, slope};
use super::scene::Done;
use super::scene_table::{cost, efficiency, percent, rays};
use crate::cli::failure::Failure;
use crate::cli::options::as_options;
use crate::cli::summary::plural;
use crate::cli::text::duration;
use huygens::accuracy::report::{Cell, Line, Mark, Page, Picture, Plot, Table};
use huygens::accuracy::scene::SceneCurve;
use huygens::film::png::{Look, png_bytes};

/// The page of a study of a scene.
pub(super) fn page(done: &Done) -> Result<Page, Failure> {
    let truth = done.truth;
    let film = &done.scene.film;
    let noise = if truth.noise > 0.0 {
        format!("; its own error is {}", percent(truth.error))
    } else {
        String::new()
    };
    let plot =
        |name: &str, axes: [&str; 2], at: fn(&SceneCurve, usize) -> [f64; 2], guides: &[f64]| {
            Plot {
                name: name.into(),
                title: format!("{} against {}", axes[1].trim_end_matches(" in %"), axes[0]),
                axes: axes.map(str::to_owned),
                lines: done.study.measured().map(|c| line(c, at)).collect(),
                guides: guides.to_vec(),
            }
        };
    let mut page = Page {
        title: format!("What accuracy costs: {}", done.scene.name),
        summary: done.advice.clone(),
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
                ["seconds of a render", "Relative error in %"],
                |c, i| {
                    [
                        c.curve.points[i].point.seconds,
                        100.0 * c.curve.points[i].error,
                    ]
                },
                &[-0.5],
            ),
            plot(
                "error-samples",
                ["samples a pixel", "Relative error in %"],
                |c, i| {
                    [
                        c.curve.points[i].point.samples as f64,
                        100.0 * c.curve.points[i].error,
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
                        c.curve.points[i].rays.map_or(f64::NAN, |n| n as f64),
                    ]
                },
                &[],
            ),
        ],
        table: table(done),
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
            rays(p.rays),
            percent(p.error)
        ),
    });
    Line {
        name: curve.curve.name.clone(),
        group: curve.family_name(),
        marks: marks.collect(),
    }
}

/// One row a choice. FLIP only where this build knows of it.
fn table(done: &Done) -> Table {
    let goal = format!("to {}", percent(done.target_error));
    let all = [
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
            "1 / (squared error x time) over that of the base: the middle of the last three rungs",
        ),
        (
            goal.as_str(),
            "time to that error; ~ off the ladder, > where more stays",
        ),
    ];
    let mut columns = columns(&all);
    let mut rows: Vec<Vec<Cell>> = done.study.measured().filter_map(|c| row(c, done)).collect();
    let flip = |c: &SceneCurve| c.curve.points.last().map(|p| p.flip);
    let seen: Vec<Option<f64>> = done.study.measured().filter_map(flip).collect();
    if seen.iter().any(Option::is_some) {
        columns.push((
            "FLIP".into(),
            "what an observer sees of the error, 0 to 1".into(),
        ));
        for (row, seen) in rows.iter_mut().zip(seen) {
            row.push(known(seen, |f| format!("{f:.4}")));
        }
    }
    Table { columns, rows }
}

fn known(v: Option<f64>, text: fn(f64) -> String) -> Cell {
    Cell::number(v, v.map_or_else(|| "?".into(), text))
}

fn row(curve: &SceneCurve, done: &Done) -> Option<Vec<Cell>> {
    let last = curve.curve.points.last()?;
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
        Cell::number(last.rays.map(|n| n as f64), rays(last.rays)),
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
        known(curve.efficiency, efficiency),
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
