//! Media: how far rays get, what occlusion rays lose, and which medium a path is in.
//!
//! All of it is there only where a scene has a medium. The stage `travel` stands between intersect and
//! sort; paths that it scatters go to a list of their own, as those at surfaces do.

use super::Wave;
use super::account::Stage;
use super::sampling::{AnySampler, with_sampler};
use super::shade::Program;
use crate::scene::{Bsdf, Scene};
use huygens_kernels::bare::called_for;
use huygens_kernels::medium::{self, CLEAR, Media, OUTSIDE, TRAVEL, UNCHANGED, travel};
use huygens_kernels::queues::{Listed, PathsMut, ShadowsMut, Surfaces};
use huygens_kernels::scatter::medium::scatter;
use huygens_kernels::scatter::{LightsAlone, LightsWeighted, NoLights, Out};
use huygens_kernels::tables::Tables;
use std::ops::Range;

/// The tables of a scene's media: rows [`OUTSIDE`] and [`CLEAR`], then the scene's own.
#[derive(Debug, Default)]
pub(crate) struct MediaTables {
    extinction: [Vec<f32>; 3],
    scattering: [Vec<f32>; 3],
    rate: [Vec<f32>; 3],
    g: Vec<f32>,
    bounds: [[f32; 3]; 2],
    interior: Vec<u32>,
    exterior: Vec<u32>,
}

/// The row of a scene's medium number `i`.
fn row_of(i: u32) -> u32 {
    CLEAR + 1 + i
}

impl MediaTables {
    pub(crate) fn new(scene: &Scene) -> Self {
        let mut tables = Self {
            bounds: [[f32::NEG_INFINITY; 3], [f32::INFINITY; 3]],
            ..Self::default()
        };
        let fog = scene.fog.as_ref();
        tables.push(fog.map(|fog| &scene.media[fog.medium as usize]));
        tables.push(None);
        for medium in &scene.media {
            tables.push(Some(medium));
        }
        if let Some(bounds) = fog.and_then(|fog| fog.bounds) {
            tables.bounds = bounds;
        }
        let interior = |m: &crate::scene::Material| match &m.bsdf {
            Bsdf::Dielectric(glass) if glass.thin => UNCHANGED,
            Bsdf::Principled(p) if p.thin => UNCHANGED,
            _ => m.interior().map_or(CLEAR, row_of),
        };
        tables.interior = scene.materials.iter().map(interior).collect();
        let exterior = |m: &crate::scene::Material| m.exterior().map_or(OUTSIDE, row_of);
        tables.exterior = scene.materials.iter().map(exterior).collect();
        tables
    }

    fn push(&mut self, medium: Option<&crate::scene::Medium>) {
        let (absorption, scattering, g) = match medium {
            Some(m) => (m.absorption, m.scattering, m.g),
            None => ([0.0; 3], [0.0; 3], 0.0),
        };
        let scatters = scattering.iter().any(|s| *s > 0.0);
        for c in 0..3 {
            let extinction = absorption[c] + scattering[c];
            self.extinction[c].push(extinction);
            self.scattering[c].push(scattering[c]);
            self.rate[c].push(if scatters { extinction } else { 0.0 });
        }
        self.g.push(g);
    }

    pub(crate) fn view(&self) -> Media<'_> {
        fn all(c: &[Vec<f32>; 3]) -> [&[f32]; 3] {
            c.each_ref().map(Vec::as_slice)
        }
        Media {
            extinction: all(&self.extinction),
            scattering: all(&self.scattering),
            rate: all(&self.rate),
            g: &self.g,
            bounds: self.bounds,
            interior: &self.interior,
            exterior: &self.exterior,
        }
    }
}

impl Wave<'_> {
    /// Takes paths through their media, up to what they met.
    pub(super) fn travel(&mut self) {
        let (Some(medium), Some(media)) = (
            self.extras.mediums(),
            called_for(self.setup.tables.media.as_ref()),
        ) else {
            return;
        };
        let n = self.paths.len();
        let (mut paths, mut hits) = (self.paths.view_mut(), self.hits.view_mut());
        with_sampler!(self.setup.sampler, sampler => {
            travel(n, medium, media, sampler, &mut paths, &mut hits);
        });
        let traced = &self.traced;
        self.account.book(Stage::Travel, traced, traced, TRAVEL * n);
    }
}

/// Scatters the listed paths, which were scattered in media.
pub(crate) fn in_medium(
    program: Program,
    listed: Listed,
    medium: &[u32],
    tables: &Tables,
    sampler: AnySampler,
    out: &mut Out,
) {
    let Some(media) = &tables.media else { return };
    match program {
        Program::Mis => with_sampler!(sampler, s => {
            scatter::<LightsWeighted, _>(listed, medium, media, tables, s, out);
        }),
        Program::Light | Program::Blind { delta: true, .. } => with_sampler!(sampler, s => {
            scatter::<LightsAlone, _>(listed, medium, media, tables, s, out);
        }),
        _ => with_sampler!(sampler, s => {
            scatter::<NoLights, _>(listed, medium, media, tables, s, out);
        }),
    }
}

/// What one list of paths became: in which media it goes on.
pub(crate) struct Gone<'a, 'b> {
    /// The list.
    pub(crate) listed: Listed<'a>,
    /// Media, place by place of the paths.
    pub(crate) medium: &'a [u32],
    /// Row by row of the list, where light passes through the surfaces.
    pub(crate) surfaces: Option<Surfaces<'b>>,
}

impl Gone<'_, '_> {
    /// Takes from the light of its occlusion rays, items `cast` of `shadows`, what the media take.
    /// `rows` are those that cast them ([`super::cast::rows_of`]).
    pub(crate) fn attenuate(
        &self,
        media: &Media,
        cast: Range<usize>,
        rows: &[u32],
        shadows: &mut ShadowsMut,
    ) {
        let Self {
            listed,
            medium,
            surfaces,
        } = *self;
        medium::attenuate(cast, rows, listed, medium, media, surfaces, shadows);
    }

    /// Writes the media of the paths that it became, items `from` and on of `scattered`.
    pub(crate) fn cross(&self, media: &Media, scattered: &PathsMut, from: usize, into: &mut [u32]) {
        if let Some(surfaces) = self.surfaces {
            medium::cross(
                self.listed,
                self.medium,
                media,
                surfaces,
                scattered,
                from,
                into,
            );
        }
    }
}
