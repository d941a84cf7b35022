//! `--json`: a study for scripts. The layout is an interface: `docs/accuracy.md` documents it, and a
//! test holds the two together.

use crate::cli::json;
use huygens::accuracy::{Curve, LEVEL, Ladder, Problem, Study, Target};
use huygens::film::output::OutputError;
use serde::Serialize;
use std::path::Path;

/// Version of the layout. It grows when a field changes its meaning or goes; new fields may appear
/// without that.
pub(crate) const SCHEMA: u32 = 1;

/// The whole file.
#[derive(Debug, Serialize)]
pub(crate) struct Report<'a> {
    schema: u32,
    program: &'static str,
    version: &'static str,
    target: &'static str,
    what: &'a str,
    exact: f64,
    seed: u32,
    repetitions: u32,
    last_samples: usize,
    level: f64,
    /// `complete`, `budget` or `interrupted`.
    ended: &'static str,
    seconds: f64,
    curves: &'a [Curve],
}

impl<'a> Report<'a> {
    pub(crate) fn new(
        target: Target,
        problem: &'a Problem,
        ladder: &Ladder,
        study: &'a Study,
        ended: &'static str,
        seconds: f64,
    ) -> Self {
        Self {
            schema: SCHEMA,
            program: "huygens",
            version: env!("CARGO_PKG_VERSION"),
            target: target.name(),
            what: &problem.what,
            exact: problem.exact,
            seed: ladder.seed,
            repetitions: ladder.repetitions,
            last_samples: ladder.last,
            level: LEVEL,
            ended,
            seconds,
            curves: &study.curves,
        }
    }

    /// Writes it to `path`, atomically.
    pub(crate) fn write(&self, path: &Path) -> Result<(), OutputError> {
        json::write(path, self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::accuracy::documented;
    use crate::cli::stats::tests::paths;
    use huygens::accuracy::study;
    use std::collections::BTreeSet;

    #[test]
    fn the_layout_is_the_documented_one() {
        let ladder = Ladder {
            last: 256,
            repetitions: 2,
            ..Ladder::default()
        };
        let problem = Target::Pi.problem();
        let study = study(&problem, &ladder, || true);
        let report = Report::new(Target::Pi, &problem, &ladder, &study, "complete", 1.0);
        let json = serde_json::to_value(&report).expect("serialised");
        let mut found = BTreeSet::new();
        paths(&json, "", &mut found);
        assert_eq!(found, documented("accuracy --json"));
        assert_eq!(json["schema"], SCHEMA);
        assert_eq!(
            json["curves"][0]["points"]
                .as_array()
                .expect("points")
                .len(),
            3
        );
    }
}
