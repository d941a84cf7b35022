//! Mixtures: of two materials, each path that meets them meets one, with the probability of its share.
//! So a mixture needs no kernel, and costs nothing but the draw.

use super::tables::SceneTables;
use crate::effects::{Effects, Shader};
use crate::geometry::Geometry;
use crate::scene::{Bsdf, Scene};
use huygens_kernels::lanes::Ux;
use huygens_kernels::opacity::Coordinates;
use huygens_kernels::queues::{MARKS, PathHits, Paths};
use huygens_kernels::rng::{pcg4d, unit};
use huygens_kernels::texture::{NO_TEXTURE, Textures};

/// A mixture of two materials.
#[derive(Clone, Copy, Debug)]
struct Mixture {
    first: u32,
    second: u32,
    /// Share of the second.
    amount: f32,
    /// What it is multiplied with, or [`NO_TEXTURE`].
    texture: u32,
}

/// The mixtures of a scene.
#[derive(Clone, Debug)]
pub(crate) struct Mixtures<'a> {
    /// By material.
    of: Vec<Option<Mixture>>,
    /// What images of shares are read from, and where.
    images: Option<Textures<'a>>,
    coordinates: Coordinates<'a>,
    seed: u32,
}

impl<'a> Mixtures<'a> {
    /// Those that the scene calls for; none if it calls for none.
    pub(crate) fn new(
        scene: &'a Scene,
        effects: &Effects,
        tables: &'a SceneTables<'a>,
        geometry: &'a Geometry,
        seed: u32,
    ) -> Option<Self> {
        let amounts = tables.amounts();
        let of = |(i, m): (usize, &crate::scene::Material)| match m.bsdf {
            Bsdf::Mix {
                first,
                second,
                amount,
            } => Some(Mixture {
                first,
                second,
                amount: amount.factor,
                texture: amounts.map_or(NO_TEXTURE, |(_, uses)| uses[i]),
            }),
            _ => None,
        };
        effects.shaders.contains(&Shader::Mix).then(|| Self {
            of: scene.materials.iter().enumerate().map(of).collect(),
            images: amounts.map(|(textures, _)| textures),
            coordinates: tables.coordinates(scene, geometry),
            seed,
        })
    }

    /// The share of the second material where path `i` met a mixture: read from the whole image.
    fn share(&self, mixture: &Mixture, hits: &PathHits, i: usize) -> f32 {
        match &self.images {
            Some(images) if mixture.texture != NO_TEXTURE => {
                let uv = self.coordinates.at(hits.primitive[i], hits.u[i], hits.v[i]);
                mixture.amount * images.number(mixture.texture, uv)
            }
            _ => mixture.amount,
        }
    }

    /// What path `i` meets of `material`: the material itself if it is no mixture. A pure function of
    /// seed, pixel, sample and bounce, like all random numbers, but of no sampler: the draw is none of
    /// those that a low-discrepancy sequence spreads.
    pub(crate) fn draw(&self, paths: &Paths, hits: &PathHits, i: usize, mut material: u32) -> u32 {
        let mut depth = 0;
        while let Some(mixture) = self.of[material as usize] {
            let bounce = paths.bounces[i] & !MARKS;
            // A stream apart from the samplers': their blocks do not reach so far.
            let block = !(bounce << 8 | depth);
            let name = [paths.pixel[i], paths.sample[i], block, self.seed];
            let u = unit(pcg4d(name.map(Ux::splat))[0]).as_array()[0];
            material = if u < self.share(&mixture, hits, i) {
                mixture.second
            } else {
                mixture.first
            };
            depth += 1;
        }
        material
    }
}
