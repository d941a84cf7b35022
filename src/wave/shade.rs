//! Shade: what light does where rays end, one kernel a kind.
//!
//! In: paths, hits, and the lists that sort them. Out: light added to samples; scattered paths;
//! occlusion rays.
//!
//! Which kernels run is settled once a render, in [`Program`]: a strategy or an integrator is a
//! choice of kernels, not a branch inside them.

use super::sampling::{AnySampler, with_sampler};
use super::sort::Wanted;
use crate::effects::Effects;
use crate::film::SampleBuffer;
use crate::settings::{Integrator, Strategy};
use huygens_kernels::bare::called_for;
use huygens_kernels::emission::{sky_emission, surface_emission};
use huygens_kernels::look::{Look, look};
use huygens_kernels::queues::Listed;
use huygens_kernels::scatter::ambient::ambient;
use huygens_kernels::scatter::plain::scatter;
use huygens_kernels::scatter::{Cosine, LightsAlone, LightsWeighted, NoLights, Out, Uniform};
use huygens_kernels::tables::Tables;

/// What a render does at surfaces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Program {
    /// Directions with pdf 1 / (2 pi), or with pdf cos / pi; `delta` lights, which these never find,
    /// are sampled all the same, so that every strategy gives one image.
    Blind { uniform: bool, delta: bool },
    /// Cosine directions to go on, lights found by sampling them.
    Light,
    /// Cosine directions and light samples, weighted.
    Mis,
    /// Ambient occlusion up to a distance, by uniform or cosine directions.
    Ambient { distance: f32, uniform: bool },
    /// A quick look.
    Look(Look),
}

impl Program {
    /// The program of an integrator and a strategy, for a scene with or without lights that it samples.
    pub(crate) fn new(
        integrator: Integrator,
        strategy: Strategy,
        has_lights: bool,
        ao_distance: f32,
    ) -> Self {
        match integrator {
            Integrator::Whitted if has_lights => Self::Light,
            Integrator::Whitted => Self::Blind {
                uniform: false,
                delta: false,
            },
            Integrator::Path | Integrator::Direct | Integrator::Reference => match strategy {
                Strategy::Uniform | Strategy::Cosine => Self::Blind {
                    uniform: strategy == Strategy::Uniform,
                    delta: has_lights,
                },
                // Nothing to sample: what is left of both is the cosine.
                Strategy::Light | Strategy::Mis if !has_lights => Self::Blind {
                    uniform: false,
                    delta: false,
                },
                Strategy::Light => Self::Light,
                Strategy::Mis => Self::Mis,
            },
            Integrator::Ao => Self::Ambient {
                distance: ao_distance,
                uniform: strategy == Strategy::Uniform,
            },
            Integrator::Normals => Self::Look(Look::Normals),
            Integrator::Depth => Self::Look(Look::Depth),
            Integrator::Albedo => Self::Look(Look::Albedo),
        }
    }

    /// Whether a ray that scatters no more can still find light that counts, whatever its pdf.
    pub(crate) fn last_ray_is_of_use(self) -> bool {
        matches!(self, Self::Blind { .. } | Self::Mis)
    }

    /// Whether next-event estimation is in use.
    pub(crate) fn samples_lights(self) -> bool {
        matches!(
            self,
            Self::Light | Self::Mis | Self::Blind { delta: true, .. }
        )
    }

    /// Whether surfaces are looked at whatever the maximum depth.
    pub(crate) fn is_transport(self) -> bool {
        !matches!(self, Self::Ambient { .. } | Self::Look(_))
    }

    /// Which lists the sort stage fills.
    pub(crate) fn wanted(self, effects: &Effects) -> Wanted {
        let transport = self.is_transport();
        Wanted {
            // Where nothing is, nothing occludes.
            sky: match self {
                Self::Ambient { .. } => true,
                _ => transport && effects.sky,
            },
            emission: transport && effects.emission,
            unsampled_only: self == Self::Light,
        }
    }
}

/// Adds what paths find that leave the scene.
pub(crate) fn sky(
    program: Program,
    listed: Listed,
    tables: &Tables,
    samples: &mut SampleBuffer,
    dropped: impl FnMut(u32),
) {
    let radiance = &mut samples.columns();
    match program {
        Program::Mis => sky_emission::<true>(listed, tables, radiance, dropped),
        _ => sky_emission::<false>(listed, tables, radiance, dropped),
    }
}

/// Adds what surfaces emit towards the paths.
pub(crate) fn emission(
    program: Program,
    listed: Listed,
    tables: &Tables,
    samples: &mut SampleBuffer,
    dropped: impl FnMut(u32),
) {
    let radiance = &mut samples.columns();
    let images = called_for(tables.images.as_ref()).is_some_and(|i| !i.emission.is_empty());
    match (program, images) {
        (Program::Mis, false) => surface_emission::<true, false>(listed, tables, radiance, dropped),
        (Program::Mis, true) => surface_emission::<true, true>(listed, tables, radiance, dropped),
        (_, false) => surface_emission::<false, false>(listed, tables, radiance, dropped),
        (_, true) => surface_emission::<false, true>(listed, tables, radiance, dropped),
    }
}

/// Scatters the listed plain surfaces behind what `out` already holds; light of quick looks goes to
/// `samples`.
pub(crate) fn plain(
    program: Program,
    listed: Listed,
    tables: &Tables,
    sampler: AnySampler,
    out: &mut Out,
    samples: &mut SampleBuffer,
    dropped: impl FnMut(u32),
) {
    match program {
        Program::Blind {
            uniform: true,
            delta: false,
        } => {
            with_sampler!(sampler, s => scatter::<Uniform, NoLights, _>(listed, tables, s, out));
        }
        Program::Blind {
            uniform: false,
            delta: false,
        } => {
            with_sampler!(sampler, s => scatter::<Cosine, NoLights, _>(listed, tables, s, out));
        }
        Program::Blind {
            uniform: true,
            delta: true,
        } => {
            with_sampler!(sampler, s => scatter::<Uniform, LightsAlone, _>(listed, tables, s, out));
        }
        Program::Light | Program::Blind { delta: true, .. } => {
            with_sampler!(sampler, s => scatter::<Cosine, LightsAlone, _>(listed, tables, s, out));
        }
        Program::Mis => {
            with_sampler!(sampler, s => scatter::<Cosine, LightsWeighted, _>(listed, tables, s, out));
        }
        Program::Ambient { distance, uniform } => {
            if uniform {
                with_sampler!(sampler, s => ambient::<Uniform, _>(listed, tables, s, distance, out));
            } else {
                with_sampler!(sampler, s => ambient::<Cosine, _>(listed, tables, s, distance, out));
            }
        }
        Program::Look(what) => look(what, listed, tables, &mut samples.columns(), dropped),
    }
}
