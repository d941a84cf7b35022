//! Loading a scene, with progress and timings, as every subcommand does it.

use crate::cli::failure::Failure;
use crate::cli::memory;
use crate::cli::options::SceneOptions;
use crate::cli::progress::Progress;
use huygens::geometry::Preset;
use huygens::scene::{Scene, SceneError, Source};
use std::sync::atomic::{AtomicU64, Ordering};

/// A scene, and how long it took.
pub(crate) struct Loaded {
    pub(crate) scene: Scene,
    /// Wall-clock seconds of opening the scene and reading its files.
    pub(crate) parse_seconds: f64,
    /// Wall-clock seconds of making the scene's tables.
    pub(crate) compile_seconds: f64,
}

/// Loads a scene to be rendered: as [`read`], and refuses what cannot be rendered yet.
pub(crate) fn load(
    options: &SceneOptions,
    size: Option<(u32, u32)>,
    bvh: Option<Preset>,
    progress: Progress,
) -> Result<Loaded, Failure> {
    let loaded = read(options, size, bvh, progress)?;
    match loaded.scene.unsupported() {
        Some(why) => Err(Failure::Input(miette::miette!(
            "{}: {why}",
            options.scene.display()
        ))),
        None => Ok(loaded),
    }
}

/// Loads a scene on the current rayon pool; its warnings are not out yet. `size` is that of the
/// image and `bvh` the preset of the tree, where the command line says one.
pub(crate) fn read(
    options: &SceneOptions,
    size: Option<(u32, u32)>,
    bvh: Option<Preset>,
    progress: Progress,
) -> Result<Loaded, Failure> {
    let wrong = |e: SceneError| Failure::Input(miette::Report::new(e));
    let name = options.scene.display();
    let open = || Source::open(&options.scene);
    let (source, open_seconds) = progress.phase(&format!("open {name}"), open);
    let source = source.map_err(wrong)?;
    if let Some(limit) = options.max_memory {
        let (counts, _) = progress.phase(&format!("measure {name}"), || source.counts());
        let film = source.film();
        let size = size.unwrap_or((film.width, film.height));
        let preset = bvh.unwrap_or_else(|| source.bvh());
        memory::ensure(limit, counts.map_err(wrong)?, preset, size)?;
    }
    let read = AtomicU64::new(0);
    let bytes = source.bytes();
    let (parsed, parse_seconds) = progress.bytes(
        &format!("read {name}"),
        bytes,
        || read.load(Ordering::Relaxed),
        || source.parse(&read),
    );
    let parsed = parsed.map_err(wrong)?;
    let (scene, compile_seconds) = progress.phase("compile", || parsed.compile());
    Ok(Loaded {
        scene: scene.map_err(wrong)?,
        parse_seconds: open_seconds + parse_seconds,
        compile_seconds,
    })
}
