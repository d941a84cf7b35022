//! The numbers of `huygens bench` for people.

use super::report::{Report, SceneReport};
use crate::cli::text::{bytes, si};
use huygens::throughput::compare::{Comparison, SIGNIFICANCE, Verdict};
use huygens::throughput::measure::Run;
use std::fmt::Write;

impl Report {
    /// Two tables: rates, and stages.
    pub(super) fn text(&self) -> String {
        let mut text = format!(
            "threads {}, waves of {}, medians of {} runs; samples and rays a processor second\n",
            self.threads, self.wave, self.runs
        );
        let _ = writeln!(
            text,
            "{:<10} {:>11} {:>13} {:>11} {:>11} {:>11} {:>11} {:>11} {:>10} {:>8}",
            "scene",
            "samples",
            "range",
            "by wall",
            "camera",
            "bounce",
            "shadow",
            "rays",
            "build tris",
            "memory"
        );
        for s in &self.scenes {
            let rate = |of: fn(&Run) -> u64| si(s.median(|r| of(r) as f64 / r.cpu_seconds));
            let [lo, hi] = s.spread();
            let _ = writeln!(
                text,
                "{:<10} {:>11} {:>13} {:>11} {:>11} {:>11} {:>11} {:>11} {:>10} {:>8}",
                s.name,
                si(s.rate()),
                format!("{:+.1} {:+.1}%", 100.0 * (lo - 1.0), 100.0 * (hi - 1.0)),
                si(s.median(|r| r.samples as f64 / r.seconds)),
                rate(|r| r.camera_rays),
                rate(|r| r.bounce_rays),
                rate(|r| r.shadow_rays),
                rate(|r| r.camera_rays + r.bounce_rays + r.shadow_rays),
                si(s.triangles as f64 / s.build_cpu_seconds),
                s.peak_memory.map_or_else(|| "-".to_owned(), bytes)
            );
        }
        text.push_str("\nprocessor ns an item by stage\n");
        for s in &self.scenes {
            let _ = writeln!(text, "{:<10} {}", s.name, stages(s));
        }
        let peak = self
            .peak_memory
            .map_or_else(String::new, |p| format!(", peak memory {}", bytes(p)));
        let _ = writeln!(
            text,
            "\nscore {:.3} Msamples/CPU s (geometric mean){peak}",
            self.score
        );
        text
    }
}

fn stages(scene: &SceneReport) -> String {
    let first = scene.runs.first().map_or(&[][..], |r| &r.stages);
    let stage = |i: usize| scene.median(|r| r.stages.get(i).map_or(0.0, |s| s.nanoseconds));
    let all = first.iter().enumerate();
    let all: Vec<String> = all
        .map(|(i, s)| format!("{} {:.1}", s.name, stage(i)))
        .collect();
    all.join(", ")
}

/// A sweep's scenes side by side: rates by the wall clock, and against the first column.
pub(super) fn sweep(reports: &[Report]) -> String {
    let mut text =
        "\nsweep: Msamples/s by the wall clock; parallel efficiency against the first\n".to_owned();
    let rate = |s: &SceneReport| s.median(|r| r.samples as f64 / r.seconds);
    let _ = write!(text, "{:<10}", "scene");
    for r in reports {
        let _ = write!(text, " {:>24}", format!("{} x {}", r.threads, r.wave));
    }
    text.push('\n');
    for (i, scene) in reports[0].scenes.iter().enumerate() {
        let _ = write!(text, "{:<10}", scene.name);
        for r in reports {
            let speedup = rate(&r.scenes[i]) / rate(scene);
            let workers = f64::from(r.threads.max(1)) / f64::from(reports[0].threads.max(1));
            let _ = write!(
                text,
                " {:>24}",
                format!(
                    "{:.2} ({:.2}x, {:.0}%)",
                    rate(&r.scenes[i]) * 1e-6,
                    speedup,
                    100.0 * speedup / workers
                )
            );
        }
        text.push('\n');
    }
    text.push_str(
        "\nthe same without what others take: the workers' share of the time, by processor time a \
         sample against the first\n",
    );
    for (i, scene) in reports[0].scenes.iter().enumerate() {
        let _ = write!(text, "{:<10}", scene.name);
        for r in reports {
            let (at_work, rate) = (r.scenes[i].at_work(), r.scenes[i].rate());
            let alone = at_work / scene.at_work() * rate / scene.rate();
            let _ = write!(
                text,
                " {:>24}",
                format!(
                    "{:.1}% / {:.3} = {:.1}%",
                    100.0 * at_work,
                    scene.rate() / rate,
                    100.0 * alone
                )
            );
        }
        text.push('\n');
    }
    text
}

/// A line a quantity, and the verdict.
pub(super) fn comparison(found: &[Comparison], floor: f64) -> String {
    let mut text = format!(
        "\ntime against the other, with intervals that all hold with probability {}; differences below \
         {}% are none\n",
        1.0 - SIGNIFICANCE,
        (1000.0 * floor).round() / 10.0
    );
    for c in found {
        let verdict = match c.verdict {
            Verdict::Faster => "faster",
            Verdict::Slower => "slower",
            Verdict::NoDifference => "no difference",
        };
        let _ = writeln!(
            text,
            "{:<28} {:.3} ({:.3} to {:.3})  {verdict}",
            c.name, c.ratio, c.interval[0], c.interval[1]
        );
    }
    let differ = found
        .iter()
        .filter(|c| c.verdict != Verdict::NoDifference)
        .count();
    let _ = match differ {
        0 => writeln!(text, "no difference"),
        n => writeln!(text, "{n} of {} differ", found.len()),
    };
    text
}
