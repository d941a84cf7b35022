//! `--json` of a scene: the layout of [`super::json`], and what only scenes have.

use super::json::SCHEMA;
use super::scene::Done;
use crate::cli::json;
use huygens::accuracy::LEVEL;
use huygens::accuracy::scene::{SceneCurve, Target};
use huygens::film::output::OutputError;
use serde::Serialize;
use std::path::Path;

/// The whole file.
#[derive(Debug, Serialize)]
pub(super) struct Report<'a> {
    schema: u32,
    program: &'static str,
    version: &'static str,
    target: &'static str,
    what: &'a str,
    /// Nobody knows it.
    exact: Option<f64>,
    seed: u32,
    repetitions: u32,
    last_samples: usize,
    level: f64,
    ended: &'static str,
    seconds: f64,
    scene: Scene,
    reference: Reference<'a>,
    target_error: f64,
    threads: usize,
    machine: String,
    command: String,
    advice: String,
    target_met: Option<Target>,
    curves: &'a [SceneCurve],
}

#[derive(Debug, Serialize)]
struct Scene {
    file: String,
    hash: String,
    width: u32,
    height: u32,
    settings: String,
}

#[derive(Debug, Serialize)]
struct Reference<'a> {
    what: &'a str,
    brightness: f64,
    error: Option<f64>,
    seconds: Option<f64>,
}

impl<'a> Report<'a> {
    pub(super) fn new(done: &'a Done) -> Self {
        let truth = done.truth;
        Self {
            schema: SCHEMA,
            program: "huygens",
            version: env!("CARGO_PKG_VERSION"),
            target: "scene",
            what: &done.scene.name,
            exact: None,
            seed: done.ladder.seed,
            repetitions: done.ladder.repetitions,
            last_samples: done.ladder.last,
            level: LEVEL,
            ended: done.ended,
            seconds: done.seconds,
            scene: Scene {
                file: done.file.display().to_string(),
                hash: blake3::Hash::from_bytes(done.scene.hash)
                    .to_hex()
                    .to_string(),
                width: done.scene.film.width,
                height: done.scene.film.height,
                settings: crate::cli::options::as_options(done.scene),
            },
            reference: Reference {
                what: &truth.what,
                brightness: truth.brightness,
                error: (truth.noise > 0.0).then_some(truth.error),
                seconds: truth.seconds,
            },
            target_error: done.target_error,
            threads: done.threads,
            machine: super::machine(),
            command: super::command(),
            advice: done.advice.join(" "),
            target_met: done.study.target,
            curves: &done.study.curves,
        }
    }

    /// Writes it to `path`, atomically.
    pub(super) fn write(&self, path: &Path) -> Result<(), OutputError> {
        json::write(path, self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::accuracy::documented;
    use crate::cli::stats::tests::paths;
    use huygens::accuracy::Ladder;
    use huygens::accuracy::scene::{Family, Stage, Truth, choices, meet_target, study_scene};
    use huygens::geometry::Geometry;
    use huygens::wave::Control;
    use std::collections::BTreeSet;

    /// What is common to integrals and scenes is documented with the integrals.
    #[test]
    fn the_layout_is_the_documented_one() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/cornell-box.toml");
        let mut scene = huygens::scene::load(path.as_ref()).expect("it ships");
        (scene.film.width, scene.film.height) = (4, 4);
        let geometry = Geometry::build(&scene.mesh);
        let control = Control::default();
        let stage = Stage {
            scene: &scene,
            geometry: &geometry,
            control: &control,
            progress: &|_, _| (),
        };
        let truth = Truth::make(&stage, 1.0, None).expect("light");
        let ladder = Ladder {
            first: 1,
            last: 4,
            repetitions: 2,
            seed: 0,
        };
        let choices = choices(&scene, &[Family::Depth]);
        let mut study = study_scene(&stage, &truth, &choices, &ladder, 0.02, |_| 0.0);
        study.target = meet_target(&stage, &truth, 1.0, 2, 0.0, 0.0);
        let done = Done {
            scene: &scene,
            file: "a.toml".as_ref(),
            truth: &truth,
            ladder: &ladder,
            target_error: 0.02,
            study: &study,
            strips: None,
            advice: Vec::new(),
            threads: 1,
            ended: "complete",
            seconds: 1.0,
        };
        let json = serde_json::to_value(Report::new(&done)).expect("serialised");
        let mut found = BTreeSet::new();
        paths(&json, "", &mut found);
        let mut expected = documented("accuracy --json");
        expected.extend(documented("What scenes add"));
        assert_eq!(found, expected);
        assert_eq!(
            json["curves"].as_array().expect("curves").len(),
            choices.len()
        );
    }
}
