//! `huygens inspect`.

mod camera;
mod contents;
mod text;

use crate::cli::failure::{Failure, warn};
use crate::cli::load::read;
use crate::cli::options::SceneOptions;
use crate::cli::progress::Progress;
use crate::cli::summary::plural;
use crate::cli::text::out;
use contents::Contents;
use huygens::geometry::{Geometry, Preset};
use huygens::wave;
use miette::IntoDiagnostic;

/// Show what a scene holds and what it needs, without rendering it
#[derive(Debug, clap::Args)]
#[command(args_override_self = true)]
pub(crate) struct Args {
    #[command(flatten)]
    scene: SceneOptions,

    /// Print JSON (see docs/stats.md)
    #[arg(long)]
    json: bool,

    /// How much work goes into the tree over the triangles [if the scene says nothing: balanced]
    #[arg(long, value_name = "NAME")]
    bvh: Option<Preset>,
}

/// Runs `huygens inspect`.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let path = &args.scene.scene;
    let progress = Progress::new(false);
    let scene = read(&args.scene, None, args.bvh, progress)?.scene;
    warn(&scene.warnings, args.scene.strict)?;
    let label = format!(
        "build over {}",
        plural(scene.stored_triangles() as u64, "triangle")
    );
    let preset = args.bvh.unwrap_or(scene.settings.bvh);
    let build = || Geometry::of(&scene, preset);
    let (geometry, _) = progress.phase(&label, build);
    let plan = wave::plan(&scene, &geometry, &scene.settings);
    let contents = Contents::of(&scene, path, &geometry.memory(), plan);
    if args.json {
        let json = serde_json::to_string_pretty(&contents).into_diagnostic();
        out(&(json.map_err(Failure::Other)? + "\n"));
    } else {
        out(&contents.to_text());
    }
    Ok(())
}
