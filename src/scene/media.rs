//! What a scene file says of media, as the tables say it.

use super::description::{self, Description};
use super::error::SceneError;
use super::medium::{Fog, Medium};
use super::toml::{SceneFile, suggest};
use super::values::{NonNegative, OneOrThree};
use toml::Spanned;

/// The media that a scene file names, in the order of their names.
///
/// # Errors
/// What is beyond 32-bit floats.
pub(super) fn media(file: &SceneFile, said: &Description) -> Result<Vec<Medium>, SceneError> {
    let medium = |(name, said): (&String, &Spanned<description::Medium>)| {
        let m = said.get_ref();
        let colour = |value: &Option<OneOrThree<NonNegative>>| match value {
            Some(value) => value.0.map(|c| c.0 as f32),
            None => [0.0; 3],
        };
        let (absorption, scattering) = (colour(&m.absorption), colour(&m.scattering));
        if (0..3).any(|c| !(absorption[c] + scattering[c]).is_finite()) {
            let message = "absorption and scattering together are beyond 32-bit floats";
            return Err(file.error(said.span(), message));
        }
        Ok(Medium {
            name: name.clone(),
            absorption,
            scattering,
            g: m.g.map_or(0.0, |g| g.0 as f32),
        })
    };
    said.media.iter().map(medium).collect()
}

/// The fog of a scene.
///
/// # Errors
/// A medium that is not there, a box that is empty.
pub(super) fn fog(file: &SceneFile, said: &Description) -> Result<Option<Fog>, SceneError> {
    let Some(fog) = &said.fog else {
        return Ok(None);
    };
    let fog = fog.get_ref();
    let names: Vec<&str> = said.media.keys().map(String::as_str).collect();
    let bounds = match &fog.within {
        None => None,
        Some(within) => {
            let corner = |c: [super::values::Finite; 3]| c.map(|x| x.0 as f32);
            let (low, high) = (corner(within.get_ref().min), corner(within.get_ref().max));
            if (0..3).any(|axis| low[axis] >= high[axis]) {
                let message = "found a box without volume, expected `min` below `max` on each axis";
                return Err(file.error(within.span(), message));
            }
            Some([low, high])
        }
    };
    Ok(Some(Fog {
        medium: named(file, &names, &fog.medium)?,
        bounds,
    }))
}

/// The index of the medium of this name.
///
/// # Errors
/// If there is none.
pub(super) fn named(
    file: &SceneFile,
    names: &[&str],
    name: &Spanned<String>,
) -> Result<u32, SceneError> {
    let found = names.iter().position(|n| n == name.get_ref());
    found.map(|i| i as u32).ok_or_else(|| {
        let hint = suggest(name.get_ref(), names);
        let message = format!("no medium `{}`, {hint}", name.get_ref());
        file.error(name.span(), message)
    })
}
