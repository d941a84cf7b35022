//! `huygens accuracy`.

mod chart;
mod json;
mod known;
mod pages;
mod scene;
mod scene_json;
mod scene_page;
mod scene_table;
mod table;

use crate::cli::failure::Failure;
use crate::cli::options::{self, ImageOptions, WorkOptions};
use crate::cli::values;
use crate::cli::{memory, system};
use clap::ValueEnum;
use huygens::accuracy::Target;
use huygens::accuracy::report::{Page, Plot};
use huygens::accuracy::scene::Family;
use huygens::film::output::{OutputError, ensure_writable, write_atomically};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Show what accuracy costs in time: error against samples and seconds
#[derive(Debug, clap::Args)]
#[command(args_override_self = true)]
pub(crate) struct Args {
    /// What to study: a scene file, or an integral whose value is known: pi, integral, product, peak,
    /// box or hemisphere
    #[arg(value_parser = what)]
    target: What,

    /// Write the study as JSON (see docs/accuracy.md)
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,

    /// Write the study as a page for a browser, which needs no other file
    #[arg(long, value_name = "FILE")]
    html: Option<PathBuf>,

    /// Write the plots as .svg files into this folder
    #[arg(long, value_name = "FOLDER")]
    svg: Option<PathBuf>,

    /// Longest time for the whole study, such as 90s, 500ms or 2m; what is done by then is shown
    /// [default: none]
    #[arg(long, value_name = "TIME", value_parser = values::time)]
    budget: Option<Duration>,

    /// Independent estimates or renders at each rung of the ladder, 2 to 1048576 [default: 64 of an
    /// integral, 4 of a scene]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    #[arg(value_parser = clap::value_parser!(u32).range(2..=1 << 20))]
    repetitions: Option<u32>,

    /// Print nothing but warnings and errors
    #[arg(short, long)]
    quiet: bool,

    /// Most samples of an estimate, 64 to 67108864: the end of the ladder, which starts at 64 and
    /// doubles [default: 262144]
    #[arg(long, value_name = "N", help_heading = "Integrals")]
    #[arg(allow_negative_numbers = true)]
    #[arg(value_parser = clap::value_parser!(u32).range(64..=1 << 26))]
    samples: Option<u32>,

    #[command(flatten)]
    scene: SceneArgs,

    #[command(flatten)]
    image: ImageOptions,

    #[command(flatten)]
    work: WorkOptions,
}

/// What only studies of scenes have.
#[derive(Debug, Default, clap::Args)]
#[command(next_help_heading = "Scenes")]
pub(crate) struct SceneArgs {
    /// What to vary, several with commas [default: everything]
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    vary: Option<Vec<Family>>,

    /// Relative error whose cost decides, such as 1% or 0.01 [default: 2%]
    #[arg(long, value_name = "ERROR", value_parser = values::share)]
    target_error: Option<f64>,

    /// Reference image (.exr) [default: one made by the study and kept beside the scene]
    #[arg(long, value_name = "FILE")]
    reference: Option<PathBuf>,

    /// Relative error of the reference that the study makes [default: half of the target error]
    #[arg(long, value_name = "ERROR", value_parser = values::share)]
    reference_error: Option<f64>,

    /// Neither look for a reference beside the scene nor keep one there
    #[arg(long)]
    no_cache: bool,

    /// Treat every warning about the scene or the options as an error (exit code 2)
    #[arg(long)]
    strict: bool,

    /// Refuse a scene that would need more memory than this, before reading it; such as 800M or 4G
    #[arg(long, value_name = "SIZE", value_parser = memory::parse, allow_negative_numbers = true)]
    max_memory: Option<u64>,
}

/// What is studied.
#[derive(Clone, Debug, PartialEq)]
enum What {
    Known(Target),
    Scene(PathBuf),
}

fn what(text: &str) -> Result<What, String> {
    if let Ok(target) = Target::from_str(text, false) {
        return Ok(What::Known(target));
    }
    let path = Path::new(text);
    let scene = path.extension().is_some() || path.exists();
    scene.then(|| What::Scene(path.to_owned())).ok_or_else(|| {
        let names: Vec<&str> = Target::ALL.iter().map(|t| t.name()).collect();
        format!("expected a scene file, or one of {}", names.join(", "))
    })
}

/// Runs `huygens accuracy`.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    for path in args.json.iter().chain(&args.html) {
        ensure_writable(path)?;
    }
    if let Some(folder) = &args.svg {
        ensure_writable(&folder.join("plot.svg"))?;
    }
    match &args.target {
        What::Known(target) => {
            let scene_only = [args.scene.given(), args.image.given(), args.work.given()];
            // A seed is for every study.
            let mut given = scene_only.into_iter().flatten().filter(|o| *o != "--seed");
            if let Some(option) = given.next() {
                let name = target.name();
                return Err(Failure::input(format!(
                    "{option} is for scenes, and {name} is an integral"
                )));
            }
            known::run(args, *target)
        }
        What::Scene(_) if args.samples.is_some() => Err(Failure::input(
            "--samples is for integrals; the ladder of a scene ends at --spp",
        )),
        What::Scene(path) => scene::run(args, path),
    }
}

impl SceneArgs {
    /// The options that were given, by name.
    fn given(&self) -> Vec<&'static str> {
        let all = [
            ("--vary", self.vary.is_some()),
            ("--target-error", self.target_error.is_some()),
            ("--reference", self.reference.is_some()),
            ("--reference-error", self.reference_error.is_some()),
            ("--no-cache", self.no_cache),
            ("--strict", self.strict),
            ("--max-memory", self.max_memory.is_some()),
        ];
        options::given(&all)
    }
}

impl Args {
    /// Writes the page and the plots that were asked for.
    fn write_pages(&self, page: &Page) -> Result<(), OutputError> {
        if let Some(path) = &self.html {
            let html = page.html();
            write_atomically(path, |writer| writer.write_all(html.as_bytes()))?;
        }
        if let Some(folder) = &self.svg {
            for plot in &page.plots {
                write_svg(folder, plot)?;
            }
        }
        Ok(())
    }
}

fn write_svg(folder: &Path, plot: &Plot) -> Result<(), OutputError> {
    let svg = plot.svg();
    let path = folder.join(format!("{}.svg", plot.name));
    write_atomically(&path, |writer| writer.write_all(svg.as_bytes()))
}

/// The machine in words: processor, cores, system.
fn machine() -> String {
    let cpu = system::processor().unwrap_or_else(|| "an unnamed processor".into());
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let cores = crate::cli::summary::plural(cores as u64, "core");
    format!(
        "{cpu}, {cores}, {} {}",
        std::env::consts::OS,
        std::env::consts::ARCH
    )
}

/// The command of this process, as it may be typed again.
fn command() -> String {
    let program = std::iter::once("huygens".to_owned());
    let words = program.chain(std::env::args().skip(1));
    let words: Vec<String> = words.map(|w| quoted(&w)).collect();
    words.join(" ")
}

/// A word as a POSIX shell takes it.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./=+:,%@".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', "'\\''"))
    }
}

/// The first column of the tables under a heading of docs/accuracy.md.
#[cfg(test)]
pub(crate) fn documented(heading: &str) -> std::collections::BTreeSet<String> {
    let text = include_str!("../../docs/accuracy.md");
    let section = text.split("\n## ").find(|s| s.starts_with(heading));
    let rows = section.expect("the heading").lines();
    rows.filter_map(|row| row.strip_prefix("| `")?.split('`').next())
        .map(str::to_owned)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn targets_are_integrals_by_name_and_scenes_otherwise() {
        assert_eq!(what("pi"), Ok(What::Known(Target::Pi)));
        assert_eq!(what("pi.toml"), Ok(What::Scene("pi.toml".into())));
        let message = what("pie").expect_err("neither");
        assert!(message.ends_with("pi, integral, product, peak, box, hemisphere"));
    }

    #[test]
    fn words_are_quoted_where_a_shell_would_split_them() {
        assert_eq!(quoted("--size=64x64"), "--size=64x64");
        assert_eq!(quoted("my scene.toml"), "'my scene.toml'");
        assert_eq!(quoted("it's"), "'it'\\''s'");
        assert_eq!(quoted(""), "''");
    }
}
