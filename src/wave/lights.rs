//! What next-event estimation selects from: the scene's lights as the kernels' tables.

use super::environment::EnvironmentTables;
use super::tables::{alias_table, area, diagonal, luminance};
use crate::scene::{LightKind, Scene, Sky};
use crate::settings::Strategy;
use huygens_kernels::light::{PUNCTUAL, Punctual, SKY};
use huygens_kernels::tables::Lights;
use std::f64::consts::{PI, TAU};

/// Which lights next-event estimation samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Sampled {
    /// All of them.
    All,
    /// Those that nothing else finds.
    Delta,
}

impl From<Strategy> for Sampled {
    fn from(strategy: Strategy) -> Self {
        match strategy {
            Strategy::Uniform | Strategy::Cosine => Self::Delta,
            Strategy::Light | Strategy::Mis => Self::All,
        }
    }
}

/// The lights' tables.
#[derive(Debug, Default)]
pub(crate) struct LightTables {
    keep: Vec<f32>,
    alias: Vec<u32>,
    source: Vec<u32>,
    punctual: Vec<Punctual>,
    environment: Option<EnvironmentTables>,
    sky_selection: f32,
    /// Of each material; see `Materials::area_pdf`.
    pub(crate) area_pdf: Vec<f32>,
}

impl LightTables {
    /// The tables of `scene`. Lights are selected by power: `pi * area * sides * luminance` of a
    /// triangle, the luminance of the flux of lights of no area, `4 pi^2 r^2 * mean luminance` of the
    /// sky over a scene of bounding radius `r` (the flux through that sphere; *PBRT* 4th ed., 12.5).
    pub(crate) fn new(scene: &Scene, sampled: Sampled) -> Self {
        let mut tables = Self::default();
        let all = sampled == Sampled::All;
        let exitance = |m: &crate::scene::Material| {
            let sides = 1.0 + f64::from(m.two_sided);
            if all {
                // Where it is textured, by its factor.
                luminance(m.emission.factor) * PI * sides
            } else {
                0.0
            }
        };
        let exitance: Vec<f64> = scene.materials.iter().map(exitance).collect();
        let mut powers = Vec::new();
        for (i, &m) in scene.mesh.material.iter().enumerate() {
            if exitance[m as usize] > 0.0 {
                tables.source.push(i as u32);
                powers.push(exitance[m as usize] * area(scene.mesh.corners(i)));
            }
        }
        // Without geometry there is nothing to light and the radius is 0.
        let radius = 0.5 * diagonal(&scene.mesh);
        let first = powers.len();
        for light in &scene.lights {
            tables.punctual.push(punctual(&light.kind));
            if all || light.kind.is_delta() {
                let k = tables.punctual.len() as u32 - 1;
                tables.source.push(PUNCTUAL | k);
                let power = luminance(light.kind.colour()) * light.kind.power_factor(radius);
                powers.push(power.max(f64::MIN_POSITIVE));
            }
        }
        let sky = scene.sky.as_ref().filter(|sky| sky.shines());
        if let Some(Sky::Map(map)) = sky {
            tables.environment = Some(EnvironmentTables::new(map));
        }
        if let Some(sky) = sky.filter(|_| all) {
            tables.source.push(SKY);
            let power = 4.0 * PI.powi(2) * radius * radius * luminance(sky.mean());
            powers.push(power.max(f64::MIN_POSITIVE));
        }
        let total: f64 = powers.iter().sum();
        tables.area_pdf = exitance.iter().map(|&e| ratio(e, total)).collect();
        for (&source, &power) in tables.source[first..].iter().zip(&powers[first..]) {
            let selection = ratio(power, total);
            if source == SKY {
                tables.sky_selection = selection;
            } else {
                tables.punctual[(source & !PUNCTUAL) as usize].selection = selection;
            }
        }
        (tables.keep, tables.alias) = alias_table(&powers);
        tables
    }

    /// Whether next-event estimation has anything to sample.
    pub(crate) fn any(&self) -> bool {
        !self.source.is_empty()
    }

    /// The view that kernels take.
    pub(crate) fn view<'a>(&'a self, scene: &'a Scene) -> Lights<'a> {
        let (zenith, nadir) = match scene.sky {
            Some(Sky::Gradient { zenith, nadir }) => (zenith, nadir),
            _ => ([0.0; 3], [0.0; 3]),
        };
        let map = match &scene.sky {
            Some(Sky::Map(map)) => Some(map),
            _ => None,
        };
        Lights {
            keep: &self.keep,
            alias: &self.alias,
            source: &self.source,
            punctual: &self.punctual,
            environment: map
                .zip(self.environment.as_ref())
                .map(|(map, tables)| tables.view(map)),
            zenith,
            nadir,
            sky_selection: self.sky_selection,
        }
    }
}

/// A light of no area as kernels see it, without its selection.
fn punctual(kind: &LightKind) -> Punctual {
    match *kind {
        LightKind::Point {
            position,
            intensity,
            spot,
        } => {
            let full = f64::from(spot.map_or(0.0, |s| s.full));
            let dark = f64::from(spot.map_or(0.0, |s| s.dark));
            Punctual {
                place: position,
                value: intensity,
                axis: spot.map_or([0.0; 3], |s| s.axis),
                edge: spot.map_or(-3.0, |s| s.dark),
                slope: spot.map_or(1.0, |_| ((1.0 / (full - dark)) as f32).min(f32::MAX)),
                density: 1.0,
                ..Punctual::default()
            }
        }
        LightKind::Distant {
            from, irradiance, ..
        } => {
            let extent = kind.extent();
            let disc = extent > 0.0;
            Punctual {
                place: from,
                value: if disc {
                    kind.radiance().map(|c| c as f32)
                } else {
                    irradiance
                },
                distant: true,
                extent: extent as f32,
                density: if disc {
                    (1.0 / (TAU * extent)) as f32
                } else {
                    1.0
                },
                ..Punctual::default()
            }
        }
    }
}

/// `a / total`, 0 where there is no total.
fn ratio(a: f64, total: f64) -> f32 {
    if total > 0.0 { (a / total) as f32 } else { 0.0 }
}
