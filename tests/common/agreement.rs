//! The wave beside the reference, strategy by strategy.

use super::picture::{by_reference, by_wave, independent};
use super::statistics::{SIGNIFICANCE, same};
use huygens::scene::Scene;
use huygens::settings::{Integrator, Settings, Strategy};

/// What is compared with what, and what must show.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Agreement<'a> {
    pub(crate) strategies: &'a [Strategy],
    /// Samples a pixel of the reference.
    pub(crate) reference: u32,
    /// Samples a pixel of each render.
    pub(crate) wave: u32,
    /// A factor that the comparison must notice.
    pub(crate) off: f64,
}

impl Agreement<'_> {
    /// Up to three scattering events, every strategy gives the reference's image, at a level of
    /// [`SIGNIFICANCE`] for all together, and an image `off` times as bright is not taken for it.
    #[track_caller]
    pub(crate) fn assert_of(&self, scene: &Scene) {
        let settings = |integrator, strategy, spp| Settings {
            integrator,
            strategy,
            spp,
            max_depth: Some(3),
            ..independent()
        };
        let reference = Settings {
            seed: 1,
            ..settings(Integrator::Reference, Strategy::Cosine, self.reference)
        };
        let expected = by_reference(scene, &reference);
        let level = SIGNIFICANCE / self.strategies.len() as f64;
        for &strategy in self.strategies {
            let rendered = by_wave(scene, &settings(Integrator::Path, strategy, self.wave));
            same(&rendered, &expected, level)
                .unwrap_or_else(|difference| panic!("{strategy:?}: {difference}"));
            assert!(
                same(&rendered.scaled(self.off), &expected, level).is_err(),
                "{strategy:?}: {} times as much passes too",
                self.off
            );
        }
    }
}

/// Settings for scenes of images.
pub(crate) fn of_images(strategy: Strategy) -> Settings {
    Settings {
        strategy,
        spp: 1024,
        max_depth: Some(3),
        ..independent()
    }
}

/// By every strategy, a scene of images is as the reference sees it.
#[track_caller]
pub(crate) fn assert_images_agree(scene: &Scene) {
    assert_eq!(scene.warnings, Vec::<String>::new());
    let truth = by_reference(scene, &of_images(Strategy::Cosine));
    for strategy in [Strategy::Cosine, Strategy::Light, Strategy::Mis] {
        let seen = by_wave(scene, &of_images(strategy));
        // Three pictures at 1e-5 together.
        if let Err(what) = same(&seen, &truth, 1e-5 / 3.0) {
            panic!("{strategy:?}: {what}");
        }
    }
}
