//! Kinds of BSDF: where their parameters stand in the material tables.
//!
//! | kind | slots |
//! |---|---|
//! | [`Diffuse`] | 0-2 reflectance |
//! | [`RoughDiffuse`] | 0-2 reflectance, 3 roughness |

use super::respond::Kind;
use crate::bsdf;
use crate::lanes::Mask;
use crate::tables::Parameters;

/// Lambertian reflection that is not plain: its surface is interpolated or textured.
#[derive(Clone, Copy, Debug)]
pub struct Diffuse;
/// Rough diffuse reflection.
#[derive(Clone, Copy, Debug)]
pub struct RoughDiffuse;

impl Kind for Diffuse {
    type Bsdf = bsdf::Lambert;
    const DELTA: bool = false;
    #[inline(always)]
    fn load(parameters: Parameters, _front: Mask) -> bsdf::Lambert {
        bsdf::Lambert {
            albedo: parameters.colour(0),
        }
    }
}

impl Kind for RoughDiffuse {
    type Bsdf = bsdf::RoughDiffuse;
    const DELTA: bool = false;
    #[inline(always)]
    fn load(parameters: Parameters, _front: Mask) -> bsdf::RoughDiffuse {
        bsdf::RoughDiffuse {
            albedo: parameters.colour(0),
            roughness: parameters.number(3),
        }
    }
}
