//! What a render did, for people, on the standard output.

use crate::cli::stats::Stats;
use crate::cli::text::{bytes, seconds, si};
use huygens::wave::Dropped;
use std::fmt::Write;

/// The lines to print about a render of `scene` with `settings`.
pub(crate) fn summary(scene: &str, settings: &str, stats: &Stats) -> String {
    let mut text = format!("{scene}\n");
    let mut line = |label: &str, what: String| {
        let _ = writeln!(text, "  {label:<8} {what}");
    };
    let s = &stats.seconds;
    line("settings", settings.to_owned());
    line(
        "time",
        format!(
            "parse {}, compile {}, build {}, render {}, write {}",
            seconds(s.parse),
            seconds(s.compile),
            seconds(s.build),
            seconds(s.render),
            seconds(s.write)
        ),
    );
    line(
        "samples",
        format!(
            "{}, {}samples/s on {}",
            si(stats.samples.done as f64).trim_end(),
            si(stats.samples.per_second),
            plural(stats.threads as u64, "thread"),
        ),
    );
    if let Some(error) = stats.error {
        line("error", format!("{:.2}% by estimate", 100.0 * error));
    }
    let r = &stats.rays;
    line(
        "rays",
        format!(
            "camera {}, bounce {}, shadow {}; {}rays/s",
            si(r.camera as f64).trim_end(),
            si(r.bounce as f64).trim_end(),
            si(r.shadow as f64).trim_end(),
            si(r.per_second)
        ),
    );
    line("paths", format!("mean depth {:.2}", stats.mean_depth));
    line("dropped", dropped(stats));
    if stats.untraceable.total > 0 {
        line("lost", lost(stats));
    }
    if let Some(peak) = stats.peak_memory_bytes {
        line("memory", format!("peak {}", bytes(peak)));
    }
    if let Some(shares) = shares(stats) {
        line("stages", shares);
    }
    for output in &stats.outputs {
        line("wrote", output.clone());
    }
    text
}

fn dropped(stats: &Stats) -> String {
    match stats.dropped.total {
        0 => "none".to_owned(),
        n => {
            let what = plural(n, "value");
            format!("{what} not finite: {}", places(&stats.dropped.stages))
        }
    }
}

fn lost(stats: &Stats) -> String {
    let what = plural(stats.untraceable.total, "ray");
    let where_to = places(&stats.untraceable.stages);
    format!("{what} that could not be traced: {where_to}")
}

/// How many in which stages, with an example of each.
fn places(stages: &[Dropped]) -> String {
    let one = |s: &Dropped| {
        let first = s
            .examples
            .first()
            .map(|(x, y, sample)| format!(" (the first at pixel {x}, {y}, sample {sample})"));
        format!("{} in {}{}", s.count, s.stage, first.unwrap_or_default())
    };
    let stages: Vec<String> = stages.iter().filter(|s| s.count > 0).map(one).collect();
    stages.join(", ")
}

/// The share of each stage in the workers' time.
fn shares(stats: &Stats) -> Option<String> {
    let all: f64 = stats.stages.iter().map(|s| s.seconds).sum();
    let share =
        |s: &huygens::wave::StageStats| format!("{} {:.0}%", s.name, 100.0 * s.seconds / all);
    let shares: Vec<String> = stats.stages.iter().map(share).collect();
    (all > 0.0).then(|| shares.join(", "))
}

/// `1 thread`, `2 threads`.
pub(crate) fn plural(n: u64, noun: &str) -> String {
    format!("{n} {noun}{}", if n == 1 { "" } else { "s" })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::stats::{Stats, tests};
    use std::path::Path;

    #[test]
    fn a_summary_names_all_there_is_to_know() {
        let mut stats = Stats::new(&tests::scene(), Path::new("a"), tests::render(), &[]);
        stats.stages[0].seconds = 1.0;
        stats.peak_memory_bytes = Some(12_300_000);
        stats.outputs.push("a.exr".into());
        let expected = "\
test
  settings --spp 64
  time     parse 0.000 s, compile 0.000 s, build 0.000 s, render 2.000 s, write 0.000 s
  samples  12.8 k, 6.40 ksamples/s on 2 threads
  rays     camera 12.8 k, bounce 20.0 k, shadow 7.20 k; 20.0 krays/s
  paths    mean depth 1.56
  dropped  2 values not finite: 2 in film (the first at pixel 1, 2, sample 3)
  lost     1 ray that could not be traced: 1 in intersect (the first at pixel 4, 5, sample 6)
  memory   peak 12.3 MB
  stages   intersect 100%
  wrote    a.exr
";
        assert_eq!(summary("test", "--spp 64", &stats), expected);
    }
}
