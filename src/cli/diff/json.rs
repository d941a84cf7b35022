//! `--json`: the measures for scripts. The layout is an interface: `docs/accuracy.md` documents it,
//! and a test holds the two together.

use crate::cli::json;
use huygens::accuracy::{Difference, LEVEL, Picture};
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
    image: String,
    reference: String,
    width: u32,
    height: u32,
    level: f64,
    #[serde(flatten)]
    measures: &'a Difference,
    /// The mean of FLIP, where this build has it.
    flip: Option<f64>,
    /// The error that is white in the error image, if one was written.
    scale: Option<f64>,
}

impl<'a> Report<'a> {
    pub(crate) fn new(
        image: &Path,
        reference: &Path,
        picture: Picture,
        measures: &'a Difference,
        flip: Option<f64>,
        scale: Option<f64>,
    ) -> Self {
        Self {
            schema: SCHEMA,
            program: "huygens",
            version: env!("CARGO_PKG_VERSION"),
            image: image.display().to_string(),
            reference: reference.display().to_string(),
            width: picture.width,
            height: picture.height,
            level: LEVEL,
            measures,
            flip,
            scale,
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
    use huygens::accuracy::difference;
    use std::collections::BTreeSet;

    #[test]
    fn the_layout_is_the_documented_one() {
        let picture = Picture {
            width: 1,
            height: 1,
            rgb: &[[1.0; 3]],
            variance: Some(&[[1.0; 3]]),
        };
        let measures = difference(picture, picture).expect("comparable");
        let report = Report::new("a".as_ref(), "b".as_ref(), picture, &measures, None, None);
        let json = serde_json::to_value(&report).expect("serialised");
        let mut found = BTreeSet::new();
        paths(&json, "", &mut found);
        assert_eq!(found, documented("diff --json"));
        assert_eq!(json["schema"], SCHEMA);
    }
}
