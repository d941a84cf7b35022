//! The wave: queues, stages, the loop and the scheduler.

pub mod account;
pub mod control;

pub use account::{BounceStats, RenderStats, StageStats};
pub use control::Control;

use crate::{film::Film, geometry::Geometry, scene::Scene, settings::Settings};

/// Renders all samples of `settings` onto `film`. Returns early, with whole samples only on the
/// film, when `control` is stopped.
pub fn render(
    scene: &Scene,
    geometry: &Geometry,
    settings: &Settings,
    film: &Film,
    control: &Control,
) -> RenderStats {
    let _ = (scene, geometry, settings, film, control);
    unimplemented!("written by the wave room")
}
