//! What a scene file says of glass beside its surface: how its index varies, and what is inside.

use super::said;
use crate::scene::error::SceneError;
use crate::scene::material::{Cauchy, Principled};
use crate::scene::media::named;
use crate::scene::toml::SceneFile;
use crate::scene::values::Finite;
use huygens_kernels::dispersion::{LONGEST, SHORTEST};
use std::ops::Range;
use toml::Spanned;

/// The line that the index of a glass is given for, in nanometres.
const D_LINE: f64 = 587.56;

/// Index at the d line, `default` where none is said, and how it varies.
///
/// # Errors
/// An index that is not positive somewhere in the spectrum, and one that is said twice.
pub(super) fn index(
    file: &SceneFile,
    m: &said::Material,
    default: f32,
) -> Result<(f32, Option<Cauchy>), SceneError> {
    let ior = m.ior.as_ref().map_or(default, |x| x.get_ref().0 as f32);
    one_way(file, m)?;
    let (cauchy, span) = match (&m.abbe, &m.cauchy, &m.sellmeier) {
        (Some(abbe), ..) => {
            let cauchy = Cauchy::from_abbe(f64::from(ior), abbe.get_ref().0);
            (cauchy, abbe.span())
        }
        (_, Some(said), _) => {
            let [a, b, c] = said.get_ref().0;
            // From micrometres, in which tables have it.
            let cauchy = Cauchy {
                a: a as f32,
                b: (b * 1e6) as f32,
                c: (c * 1e12) as f32,
            };
            (cauchy, said.span())
        }
        (.., Some(said)) => (sellmeier(file, said)?, said.span()),
        (None, None, None) => return Ok((ior, None)),
    };
    for wavelength in [SHORTEST, LONGEST] {
        let index = cauchy.at(f64::from(wavelength)) as f32;
        if !(index > 0.0 && index.is_finite()) {
            let message = format!(
                "makes the index of refraction {index:.4} at {wavelength} nm, expected it above 0 from \
                 {SHORTEST} to {LONGEST} nm"
            );
            return Err(file.error(span, message));
        }
    }
    let at_d = if m.abbe.is_some() {
        ior
    } else {
        cauchy.at(D_LINE) as f32
    };
    Ok((at_d, Some(cauchy)))
}

/// The keys that say how the index varies, and where those that are there stand.
fn ways(m: &said::Material) -> [(&'static str, Option<Range<usize>>); 3] {
    [
        ("abbe", m.abbe.as_ref().map(Spanned::span)),
        ("cauchy", m.cauchy.as_ref().map(Spanned::span)),
        ("sellmeier", m.sellmeier.as_ref().map(Spanned::span)),
    ]
}

/// Whether the index is said in one way.
fn one_way(file: &SceneFile, m: &said::Material) -> Result<(), SceneError> {
    let all = ways(m).into_iter();
    let mut said = all.filter_map(|(key, span)| Some((key, span?)));
    let Some((first, _)) = said.next() else {
        return Ok(());
    };
    if let Some((second, span)) = said.next() {
        let message = format!("found both `{first}` and `{second}`, expected one");
        return Err(file.error(span, message));
    }
    match &m.ior {
        Some(ior) if first != "abbe" => {
            let message = format!("found beside `{first}`, which says the index already");
            Err(file.error(ior.span(), message))
        }
        _ => Ok(()),
    }
}

/// Whether what is said of the glass of a principled surface fits the rest of it.
///
/// # Errors
/// An index below 1, and glass where nothing passes.
pub(super) fn fits(
    file: &SceneFile,
    m: &said::Material,
    principled: &Principled,
) -> Result<(), SceneError> {
    if let Some(ior) = m.ior.as_ref().filter(|ior| ior.get_ref().0 < 1.0) {
        let found = ior.get_ref().0;
        let message = format!("found {found:?}, expected a number of at least 1");
        return Err(file.error(ior.span(), message));
    }
    let beside = [
        ("interior", m.interior.as_ref().map(Spanned::span)),
        ("exterior", m.exterior.as_ref().map(Spanned::span)),
    ];
    let mut said = ways(m).into_iter().chain(beside);
    if !principled.passes()
        && let Some((key, Some(span))) = said.find(|(_, span)| span.is_some())
    {
        let message =
            format!("`{key}` is for what light passes: `transmission` is 0, or all is metal");
        return Err(file.error(span, message));
    }
    let Some(cauchy) = &principled.dispersion else {
        return Ok(());
    };
    let ends = [SHORTEST, LONGEST].map(|l| cauchy.at(f64::from(l)));
    let low = ends[0].min(ends[1]);
    match ways(m).into_iter().find_map(|(_, span)| span) {
        Some(span) if low < 1.0 => {
            let message = format!(
                "makes the index of refraction {low:.4} within {SHORTEST} to {LONGEST} nm, expected at \
                 least 1"
            );
            Err(file.error(span, message))
        }
        _ => Ok(()),
    }
}

/// Sellmeier's `n^2 = 1 + sum B l^2 / (l^2 - C)`, `l` in micrometres, as catalogues of glass have it.
///
/// # Errors
/// An index that is no number somewhere in the spectrum.
fn sellmeier(file: &SceneFile, said: &Spanned<[[Finite; 3]; 2]>) -> Result<Cauchy, SceneError> {
    let [b, c] = said.get_ref().map(|row| row.map(|x| x.0));
    let squared = |nanometres: f64| {
        let l2 = (nanometres * 1e-3).powi(2);
        let term = |(b, c): (f64, f64)| b * l2 / (l2 - c);
        1.0 + b.into_iter().zip(c).map(term).sum::<f64>()
    };
    let [low, high] = [SHORTEST, LONGEST].map(|l| (f64::from(l) * 1e-3).powi(2));
    if let Some(pole) = c.into_iter().find(|c| (low..=high).contains(c)) {
        let message = format!(
            "has a pole at {:.0} nm, expected none from {SHORTEST} to {LONGEST} nm",
            pole.sqrt() * 1e3
        );
        return Err(file.error(said.span(), message));
    }
    for nanometres in (SHORTEST as u32)..=(LONGEST as u32) {
        let found = squared(f64::from(nanometres));
        if !(found > 0.0 && found.is_finite()) {
            let message = format!(
                "makes the square of the index {found} at {nanometres} nm, expected it above 0"
            );
            return Err(file.error(said.span(), message));
        }
    }
    Ok(Cauchy::through(|l| squared(l).sqrt()))
}

/// The media inside and outside, by their places among `media`.
///
/// # Errors
/// A medium that is not there, and one beside a pane.
pub(super) fn beside(
    file: &SceneFile,
    media: &[&str],
    m: &said::Material,
) -> Result<[Option<u32>; 2], SceneError> {
    let thin = m.thin.as_ref().is_some_and(|thin| *thin.get_ref());
    let mut found = [None; 2];
    for (found, name) in found.iter_mut().zip([&m.interior, &m.exterior]) {
        let Some(name) = name else { continue };
        if thin {
            let message = "found in a `thin` pane, which has no inside";
            return Err(file.error(name.span(), message));
        }
        *found = Some(named(file, media, name)?);
    }
    Ok(found)
}
