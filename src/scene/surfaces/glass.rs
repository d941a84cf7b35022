//! What a scene file says of glass beside its surface: how its index varies, and what is inside.

use super::said;
use crate::scene::error::SceneError;
use crate::scene::material::{Cauchy, Dielectric};
use crate::scene::media::named;
use crate::scene::toml::SceneFile;
use huygens_kernels::dispersion::{LONGEST, SHORTEST};

/// The line that the index of a glass is given for, in nanometres.
const D_LINE: f32 = 587.56;

/// Index at the d line, and how it varies.
///
/// # Errors
/// An index that is not positive somewhere in the spectrum, and one that is given twice.
pub(super) fn index(
    file: &SceneFile,
    m: &said::Material,
) -> Result<(f32, Option<Cauchy>), SceneError> {
    let default = Dielectric::default().ior;
    let ior = m.ior.as_ref().map_or(default, |x| x.get_ref().0 as f32);
    let (cauchy, span) = match (&m.abbe, &m.cauchy) {
        (None, None) => return Ok((ior, None)),
        (Some(abbe), None) => {
            let cauchy = Cauchy::from_abbe(f64::from(ior), abbe.get_ref().0);
            (cauchy, abbe.span())
        }
        (None, Some(said)) => {
            if let Some(ior) = &m.ior {
                let message = "found beside `cauchy`, which says the index already";
                return Err(file.error(ior.span(), message));
            }
            let [a, b] = said.get_ref().map(|x| x.0);
            let cauchy = Cauchy {
                a: a as f32,
                // From square micrometres, in which tables have it.
                b: (b * 1e6) as f32,
            };
            (cauchy, said.span())
        }
        (Some(_), Some(cauchy)) => {
            let message = "found both `abbe` and `cauchy`, expected one";
            return Err(file.error(cauchy.span(), message));
        }
    };
    let at = |wavelength: f32| cauchy.a + cauchy.b / (wavelength * wavelength);
    for wavelength in [SHORTEST, LONGEST] {
        let index = at(wavelength);
        if !(index > 0.0 && index.is_finite()) {
            let message = format!(
                "makes the index of refraction {index} at {wavelength} nm, expected it above 0 from \
                 {SHORTEST} to {LONGEST} nm"
            );
            return Err(file.error(span, message));
        }
    }
    let ior = if m.cauchy.is_some() { at(D_LINE) } else { ior };
    Ok((ior, Some(cauchy)))
}

/// The medium inside, by its place among `media`.
///
/// # Errors
/// A medium that is not there, and one inside of a pane.
pub(super) fn interior(
    file: &SceneFile,
    media: &[&str],
    m: &said::Material,
) -> Result<Option<u32>, SceneError> {
    let Some(name) = &m.interior else {
        return Ok(None);
    };
    if m.thin.as_ref().is_some_and(|thin| *thin.get_ref()) {
        let message = "found in a `thin` pane, which has no inside";
        return Err(file.error(name.span(), message));
    }
    named(file, media, name).map(Some)
}
