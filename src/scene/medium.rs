//! Media: what fills the space outside of all glass, or inside of some.

use super::compiled::Scene;

/// A homogeneous medium.
#[derive(Clone, Debug, PartialEq)]
pub struct Medium {
    /// Its name in the scene file.
    pub name: String,
    /// Share of light absorbed along a unit of length, each channel finite and >= 0.
    pub absorption: [f32; 3],
    /// Share of light scattered along a unit of length, each channel finite and >= 0. Its sum with
    /// `absorption` is finite.
    pub scattering: [f32; 3],
    /// Mean cosine of what is scattered: 1 is on, -1 is back. Within +-`phase::G_LIMIT`.
    pub g: f32,
}

impl Medium {
    /// Whether it scatters any light.
    #[must_use]
    pub fn scatters(&self) -> bool {
        self.scattering.iter().any(|&s| s > 0.0)
    }
}

/// What fills the space outside of all glass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fog {
    /// Index of the medium.
    pub medium: u32,
    /// Low and high corner of the box that it fills; everywhere without one.
    pub bounds: Option<[[f32; 3]; 2]>,
}

impl Scene {
    /// The media that light can meet, each with what holds it: the fog, or a material that a surface
    /// wears.
    pub fn media_in_use(&self) -> impl Iterator<Item = (&Medium, String)> {
        let fog = self
            .fog
            .iter()
            .map(|fog| (fog.medium, "the scene's `fog`".to_owned()));
        let worn = self.materials.iter().zip(self.worn());
        let beside = worn.filter(|(_, worn)| *worn).flat_map(|(m, _)| {
            let both = [m.interior(), m.exterior()].into_iter().flatten();
            both.map(|i| (i, format!("material `{}`", m.name)))
        });
        fog.chain(beside)
            .map(|(i, reason)| (&self.media[i as usize], reason))
    }
}
