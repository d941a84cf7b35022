//! From a material of the scene to its scattering at a point.

use super::conductor::{Conductor, Mirror};
use super::dielectric::{Glass, RoughGlass};
use super::diffuse::Diffuse;
use super::energy::{
    Curve, Ladder, Loss, reflected, reflected_and_passed, reflected_by_schlick, sheen,
};
use super::facets::Facets;
use super::fresnel::fresnel_mean;
use super::principled::{Albedos, Parameters, Principled};
use super::{Bsdf, FLOOR};
use crate::reference::surface::{Point, colour, number};
use crate::reference::vector;
use crate::scene::material::{self, Material, Textured};
use crate::scene::{self, Scene};
use glam::DVec3;
use std::sync::{Arc, OnceLock};

/// Reads a material's values at a point.
pub(in crate::reference) struct Reader<'a> {
    /// Where the surface has coordinates for their images.
    pub(in crate::reference) point: Option<(&'a Scene, &'a Point)>,
}

impl Reader<'_> {
    pub(in crate::reference) fn colour(&self, value: &Textured<[f32; 3]>) -> DVec3 {
        match self.point {
            Some((scene, point)) => colour(scene, value, point.uv),
            None => vector(value.factor),
        }
    }

    pub(in crate::reference) fn number(&self, value: &Textured<f32>) -> f64 {
        match self.point {
            Some((scene, point)) => number(scene, value, point.uv),
            None => value.factor.into(),
        }
    }
}

/// A material that is worn, with its albedos as they come to be asked for.
#[derive(Debug)]
pub(in crate::reference) struct Worn<'a> {
    material: &'a Material,
    /// Of a metal.
    loss: OnceLock<(Loss, DVec3)>,
    layers: Arc<Layers>,
    /// Seen from its front and its back.
    boundary: [Ladder<Curve>; 2],
}

/// Albedos that depend on no index of refraction.
#[derive(Debug)]
struct Layers {
    facets: [Ladder<Curve>; 2],
    coat: [Ladder<Curve>; 2],
    sheen: Ladder<(Curve, f64)>,
}

/// The width of a roughness that does not vary.
fn only(roughness: &Textured<f32>) -> Option<f64> {
    roughness
        .texture
        .is_none()
        .then(|| width(roughness.factor.into()))
}

fn width(roughness: f64) -> f64 {
    (roughness * roughness).clamp(FLOOR, 1.0)
}

/// Whether a roughness that does not vary is below what facets are there for.
fn polished(roughness: &Textured<f32>) -> bool {
    roughness.texture.is_none() && roughness.factor * roughness.factor < FLOOR as f32
}

impl<'a> Worn<'a> {
    pub(in crate::reference) fn new(material: &'a Material) -> Self {
        let (facets, coat, sheen) = match &material.bsdf {
            scene::Bsdf::Dielectric(glass) => (only(&glass.roughness), Some(1.0), Some(1.0)),
            scene::Bsdf::Principled(p) => {
                let sheen = p.sheen_roughness.texture.is_none();
                let roughness = f64::from(p.sheen_roughness.factor).max(0.1);
                (
                    only(&p.roughness),
                    only(&p.clearcoat_roughness),
                    sheen.then_some(roughness),
                )
            }
            _ => (Some(1.0), Some(1.0), Some(1.0)),
        };
        let two = |only| [Ladder::new(only), Ladder::new(only)];
        Self {
            material,
            loss: OnceLock::new(),
            layers: Arc::new(Layers {
                facets: two(facets),
                coat: two(coat),
                sheen: Ladder::new(sheen),
            }),
            boundary: two(facets),
        }
    }

    /// The same of `material`, which differs from this one in its index of refraction alone: what does
    /// not depend on that is shared.
    pub(in crate::reference) fn at<'b>(&self, material: &'b Material) -> Worn<'b> {
        Worn {
            layers: Arc::clone(&self.layers),
            ..Worn::new(material)
        }
    }

    /// The scattering of light towards `o`, at a point and on a side of the surface.
    pub(in crate::reference) fn bsdf(&self, read: &Reader, o: DVec3, front: bool) -> Bsdf<'_> {
        match &self.material.bsdf {
            scene::Bsdf::Diffuse {
                reflectance,
                roughness,
            } => Bsdf::Diffuse(Diffuse {
                albedo: read.colour(reflectance),
                roughness: f64::from(*roughness),
            }),
            scene::Bsdf::Conductor {
                eta,
                k,
                tint,
                roughness,
                anisotropy,
            } => {
                let mirror = Mirror {
                    eta: vector(*eta),
                    k: vector(*k),
                    tint: read.colour(tint),
                };
                if polished(roughness) {
                    return Bsdf::Mirror(mirror);
                }
                let roughness = read.number(roughness);
                Bsdf::Conductor(self.conductor(mirror, roughness, f64::from(*anisotropy)))
            }
            scene::Bsdf::Dielectric(d) => {
                let ior = f64::from(d.ior);
                let glass = Glass {
                    eta: if front || d.thin { ior } else { 1.0 / ior },
                    thin: d.thin,
                    tints: [&d.reflection_tint, &d.transmission_tint].map(|t| read.colour(t)),
                };
                if polished(&d.roughness) {
                    return Bsdf::Glass(glass);
                }
                let alpha = width(read.number(&d.roughness));
                Bsdf::RoughGlass(self.rough(glass, alpha, o.z))
            }
            scene::Bsdf::Principled(p) => Bsdf::Principled(self.principled(p, read, o, front)),
            scene::Bsdf::Mix { .. } => unreachable!("a part of it was drawn"),
        }
    }

    fn conductor(&self, polished: Mirror, roughness: f64, anisotropy: f64) -> Conductor<'_> {
        let alpha = [1.0 + anisotropy, 1.0 - anisotropy];
        let facets = Facets {
            alpha: alpha.map(|by| (roughness * roughness * by).clamp(FLOOR, 1.0)),
        };
        let again = self.material.compensation.then(|| {
            let make = || (Loss::new(facets), fresnel_mean(polished.eta, polished.k));
            let (loss, fresnel) = self.loss.get_or_init(make);
            (loss, *fresnel)
        });
        Conductor {
            polished,
            facets,
            again,
        }
    }

    /// Albedo at cosine `z` of facets of width `alpha` that reflect everything.
    fn reflected(&self, alpha: f64, z: f64) -> f64 {
        self.layers.facets[0].at(alpha, reflected, |curve| curve.at(z))
    }

    fn rough(&self, polished: Glass, alpha: f64, z: f64) -> RoughGlass {
        let kept = if !self.material.compensation {
            1.0
        } else if polished.thin || polished.matched() {
            self.reflected(alpha, z)
        } else {
            let make = |alpha| reflected_and_passed(alpha, polished.eta);
            self.boundary[usize::from(polished.eta < 1.0)].at(alpha, make, |curve| curve.at(z))
        };
        RoughGlass {
            polished,
            alpha,
            kept,
        }
    }

    fn principled(
        &self,
        p: &material::Principled,
        read: &Reader,
        o: DVec3,
        front: bool,
    ) -> Principled {
        let metallic = read.number(&p.metallic);
        let transmission = read.number(&p.transmission);
        let metal = p.metallic.texture.is_none() && p.metallic.factor >= 1.0;
        let passes = transmission > 0.0 && !metal;
        // What lets nothing pass is alike on both sides.
        let within = !front && !p.thin && passes;
        let outside = if within { 0.0 } else { 1.0 };
        let ior = f64::from(p.ior);
        let parameters = Parameters {
            base: read.colour(&p.base_color),
            metallic,
            alpha: width(read.number(&p.roughness)),
            eta: if within { 1.0 / ior } else { ior },
            specular: read.number(&p.specular),
            specular_color: read.colour(&p.specular_color),
            transmission,
            coat: outside * read.number(&p.clearcoat),
            coat_alpha: width(read.number(&p.clearcoat_roughness)),
            sheen: outside * read.colour(&p.sheen_color),
            sheen_roughness: read.number(&p.sheen_roughness).max(0.1),
            compensated: self.material.compensation,
        };
        let both = |ladders: &[Ladder<Curve>; 2], alpha| {
            let at = |curve: &Curve| curve.at(o.z);
            [
                ladders[0].at(alpha, reflected, at),
                ladders[1].at(alpha, reflected_by_schlick, at),
            ]
        };
        let mut albedos = Albedos {
            facets: both(&self.layers.facets, parameters.alpha),
            coat: [0.0; 2],
            sheen: 0.0,
            sheen_scale: 1.0,
        };
        if parameters.coat > 0.0 {
            albedos.coat = both(&self.layers.coat, parameters.coat_alpha);
        }
        if parameters.sheen != DVec3::ZERO {
            let roughness = parameters.sheen_roughness;
            let at = |of: fn(&(Curve, f64), f64) -> f64| {
                self.layers
                    .sheen
                    .at(roughness, sheen, |curve| of(curve, o.z))
            };
            albedos.sheen = at(|(curve, scale), z| scale * curve.at(z));
            albedos.sheen_scale = at(|(_, scale), _| *scale);
        }
        let through = passes.then(|| {
            let tint = (parameters.specular * parameters.specular_color).min(DVec3::ONE);
            let glass = Glass {
                eta: parameters.eta,
                thin: p.thin,
                tints: [tint, parameters.base],
            };
            self.rough(glass, parameters.alpha, o.z)
        });
        Principled::new(&parameters, &albedos, through)
    }
}
