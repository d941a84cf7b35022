//! What next-event estimation selects from: the scene's lights as the kernels' tables.

use super::emitted;
use super::environment::EnvironmentTables;
use super::light_tree::LightTree;
use super::tables::{alias_table, area, diagonal, luminance};
use crate::effects::light_selection;
use crate::scene::{Light, LightKind, Material, Scene, Sky};
use crate::settings::{Integrator, LightSelection, Settings, Strategy};
use huygens_kernels::light::{PUNCTUAL, Punctual, SKY, TREE};
use huygens_kernels::tables::Lights;
use std::f64::consts::{PI, TAU};

/// The lights' tables.
#[derive(Debug, Default)]
pub(crate) struct LightTables {
    /// Probability to select each sphere.
    pub(crate) sphere_selection: Vec<f32>,
    keep: Vec<f32>,
    alias: Vec<u32>,
    source: Vec<u32>,
    punctual: Vec<Punctual>,
    tree: Option<LightTree>,
    environment: Option<EnvironmentTables>,
    sky_selection: f32,
    /// Of each material; see `Materials::area_pdf`.
    pub(crate) area_pdf: Vec<f32>,
    /// Of each triangle; see `Lights::area_pdf`.
    by_triangle: Vec<f32>,
}

/// A light, and its power, W of luminance.
#[derive(Clone, Copy, Debug)]
struct Powered {
    source: u32,
    power: f64,
}

impl LightTables {
    /// The tables of `scene`, by the `strategy` and `light_selection` of `settings`: strategies that
    /// look for light by directions sample what these do not find.
    ///
    /// Powers are `pi * area * sides * luminance` of a triangle or sphere, the luminance of the flux of lights of
    /// no area, `4 pi^2 r^2 * mean luminance` of the sky over a scene of bounding radius `r` (the
    /// flux through that sphere; *PBRT* 4th ed., 12.5). Within a kind of light they are selected by power;
    /// the kinds share the selection as [`shared`] says.
    pub(crate) fn new(scene: &Scene, settings: &Settings) -> Self {
        let mut tables = Self {
            sphere_selection: vec![0.0; scene.spheres.len()],
            ..Self::default()
        };
        let all = matches!(settings.strategy, Strategy::Light | Strategy::Mis)
            || settings.integrator == Integrator::Whitted;
        let exitance = |m: &Material| {
            let sides = 1.0 + f64::from(m.two_sided);
            if all {
                luminance(m.emission.factor) * PI * sides
            } else {
                0.0
            }
        };
        let exitance: Vec<f64> = scene.materials.iter().map(exitance).collect();
        let varied = if all {
            emitted::by_triangle(scene)
        } else {
            Vec::new()
        };
        // Where images vary emission, in the mean over the triangle.
        let exitance_of = |triangle: usize| {
            let m = scene.mesh.material[triangle] as usize;
            let sides = 1.0 + f64::from(scene.materials[m].two_sided);
            varied
                .get(triangle)
                .map_or(exitance[m], |mean| mean * PI * sides)
        };
        let emits = |triangle: usize| exitance_of(triangle) > 0.0;
        // Without geometry there is nothing to light and the radius is 0.
        let radius = 0.5 * diagonal(scene);
        tables.punctual = scene.lights.iter().map(|l| punctual(&l.kind)).collect();
        let (mut near, mut far) = (Vec::new(), Vec::new());
        for i in (0..scene.mesh.triangles()).filter(|&i| emits(i)) {
            let power = exitance_of(i) * area(scene.mesh.corners(i));
            let source = i as u32;
            near.push(Powered { source, power });
        }
        // Spheres are left out of the tree.
        for (i, sphere) in scene.spheres.iter().enumerate() {
            let power = exitance[sphere.material as usize] * sphere.area();
            if power > 0.0 {
                let source = (scene.mesh.triangles() + i) as u32;
                far.push(Powered { source, power });
            }
        }
        for (k, Light { kind, .. }) in scene.lights.iter().enumerate() {
            if all || kind.is_delta() {
                let power = luminance(kind.colour()) * kind.power_factor(radius);
                let source = PUNCTUAL | k as u32;
                let lights = if kind.is_near() { &mut near } else { &mut far };
                lights.push(Powered { source, power });
            }
        }
        let sky = scene.sky.as_ref().filter(|sky| sky.shines());
        if let Some(Sky::Map(map)) = sky {
            tables.environment = Some(EnvironmentTables::new(map));
        }
        if let Some(sky) = sky.filter(|_| all) {
            let power = 4.0 * PI.powi(2) * radius * radius * luminance(sky.mean());
            far.push(Powered { source: SKY, power });
        }
        let (selection, _) = light_selection(scene, settings);
        if selection == LightSelection::Tree {
            let luminance_of = |i: usize| {
                let material = &scene.materials[scene.mesh.material[i] as usize];
                let even = || luminance(material.emission.factor);
                let mean = varied.get(i).copied().unwrap_or_else(even);
                if emits(i) { mean } else { 0.0 }
            };
            tables.tree = Some(LightTree::new(scene, luminance_of));
            let power = near.iter().map(|l| l.power).sum();
            near = vec![Powered {
                source: TREE,
                power,
            }];
        }
        near.append(&mut far);
        // At a finite distance, the sky, other distant ones.
        let kind = |l: &Powered| match l.source {
            SKY => 1,
            TREE => 0,
            PUNCTUAL.. => usize::from(tables.punctual[(l.source & !PUNCTUAL) as usize].distant) * 2,
            _ => 0,
        };
        let factors = shared(near.iter().map(|l| (kind(l), l.power)));
        let weigh = |l: &Powered| match selection {
            LightSelection::Uniform => 1.0,
            _ => (factors[kind(l)] * l.power).max(f64::MIN_POSITIVE),
        };
        let weights: Vec<f64> = near.iter().map(weigh).collect();
        let total: f64 = weights.iter().sum();
        let area_pdf = |&e: &f64| ratio(factors[0] * e, total);
        tables.area_pdf = exitance.iter().map(area_pdf).collect();
        let by_triangle = selection == LightSelection::Uniform || !varied.is_empty();
        if by_triangle && selection != LightSelection::Tree {
            let pdf = |i| {
                let weight = match selection {
                    LightSelection::Uniform => 1.0 / area(scene.mesh.corners(i)),
                    _ => factors[0] * exitance_of(i),
                };
                if emits(i) { ratio(weight, total) } else { 0.0 }
            };
            tables.by_triangle = (0..scene.mesh.triangles()).map(pdf).collect();
        }
        for (&Powered { source, .. }, &weight) in near.iter().zip(&weights) {
            let selection = ratio(weight, total);
            match (source, &mut tables.tree) {
                (SKY, _) => tables.sky_selection = selection,
                (TREE, Some(tree)) => tree.selection = selection,
                (PUNCTUAL.., _) => {
                    tables.punctual[(source & !PUNCTUAL) as usize].selection = selection;
                }
                _ => {
                    let sphere = (source as usize).checked_sub(scene.mesh.triangles());
                    if let Some(sphere) = sphere {
                        tables.sphere_selection[sphere] = selection;
                    }
                }
            }
        }
        tables.source = near.iter().map(|l| l.source).collect();
        (tables.keep, tables.alias) = alias_table(&weights);
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
            tree: self.tree.as_ref().map(LightTree::view),
            area_pdf: &self.by_triangle,
            environment: map
                .zip(self.environment.as_ref())
                .map(|(map, tables)| tables.view(map)),
            zenith,
            nadir,
            sky_selection: self.sky_selection,
        }
    }
}

/// From lights as kind and power, what to multiply the powers of each kind with, so that kinds are
/// selected by the roots of their powers; the sum stays.
///
/// Power is what a light sends out or into the scene, not what arrives at one place: between a lamp and
/// a sky, the two may be orders of magnitude apart, and walls know nothing of either. The root is off by
/// half of those orders, whichever way they go, so that neither kind starves (measured in
/// docs/performance/samplers.md).
fn shared(lights: impl Iterator<Item = (usize, f64)>) -> [f64; 3] {
    let mut power = [0.0f64; 3];
    lights.for_each(|(kind, p)| power[kind] += p);
    let total: f64 = power.iter().sum();
    let roots: f64 = power.iter().map(|&p| (p / total).sqrt()).sum();
    power.map(|p| match (p / total).sqrt() {
        root if root > 0.0 => 1.0 / (root * roots),
        _ => 1.0,
    })
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinds_share_by_the_roots_of_their_powers() {
        // 1 W of lamps in two, 10,000 W of sky, no sun.
        let lights = [(0, 0.25), (0, 0.75), (1, 1e4)];
        let factors = shared(lights.into_iter());
        let weights = lights.map(|(kind, power)| factors[kind] * power);
        let total: f64 = weights.iter().sum();
        // Roots of 1 and 10,000; sums of a few roundings each.
        let close = |a: f64, b: f64| (a / b - 1.0).abs() < 16.0 * f64::EPSILON;
        assert!(close(total, 10_001.0), "{total}");
        assert!(close(weights[0] / total, 0.25 / 101.0), "{weights:?}");
        assert!(close(weights[1] / total, 0.75 / 101.0), "{weights:?}");
        assert!(close(weights[2] / total, 100.0 / 101.0), "{weights:?}");
    }

    /// Scenes of one kind of light are as they were, to the bit.
    #[test]
    fn one_kind_has_its_powers_to_itself() {
        assert_eq!(shared([(1, 0.3), (1, 0.4)].into_iter())[1], 1.0);
        assert_eq!(shared([].into_iter()), [1.0; 3]);
    }
}
