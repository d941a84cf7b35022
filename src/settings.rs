//! What a render is asked to do, apart from the scene: the same words in scene files, on the
//! command line and in the library.

use huygens_kernels::roulette::{GAINS, SURVIVAL_GAIN};
use serde::{Deserialize, Serialize};

/// What the wave computes for each camera sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Integrator {
    /// Light transport along paths of any length.
    Path,
    /// Emission and light that scatters once: `path` with a maximum depth of 1.
    Direct,
    /// Lights sampled at the first surface that is no mirror, where paths end (T. Whitted, 1980),
    /// whatever the strategy.
    Whitted,
    /// The unoccluded share of the cosine-weighted hemisphere, up to a distance.
    Ao,
    /// The geometric normal that faces the camera, mapped from -1..1 to 0..1.
    Normals,
    /// Distance along the camera ray.
    Depth,
    /// Diffuse reflectance.
    Albedo,
    /// The scalar, recursive f64 tracer that the others are tested against. Slow.
    Reference,
}

impl Integrator {
    /// Whether it computes light.
    #[must_use]
    pub fn is_transport(self) -> bool {
        match self {
            Self::Path | Self::Direct | Self::Whitted | Self::Reference => true,
            Self::Ao | Self::Normals | Self::Depth | Self::Albedo => false,
        }
    }
}

/// How a surface looks for light.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Strategy {
    /// Directions uniform over the hemisphere, pdf 1 / (2 pi).
    Uniform,
    /// Directions with pdf cos / pi.
    Cosine,
    /// Next-event estimation alone: a point on a light at every surface.
    Light,
    /// Cosine directions and next-event estimation, weighted by the power heuristic.
    Mis,
}

/// How next-event estimation chooses among the lights; none biases the image.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum LightSelection {
    /// Whichever should pay: `tree` for many lights at a finite distance, else `power`.
    #[default]
    Auto,
    /// Each light, and each triangle of one, as often as any other.
    Uniform,
    /// By power.
    Power,
    /// By distance, orientation and intensity, along a tree over all lights at a finite distance.
    Tree,
}

/// How the numbers that a path draws are spread over the samples of a pixel; none biases the image.
/// The film's estimate of the variance is that of independent samples: see `film::Image::variance`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Sampler {
    /// Independent uniform numbers.
    Independent,
    /// A jittered grid of as many cells as samples, shuffled, a pair of numbers at a time.
    Stratified,
    /// Owen-scrambled Sobol points, four numbers at a time. Best at powers of two.
    Sobol,
    /// The same, with neighbouring pixels' errors as different as possible. Best at powers of two.
    BlueNoise,
}

/// How finely images on surfaces are read. It decides about the image, not its noise alone: a footprint
/// blurs what is smaller.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum TextureLod {
    /// Averaged over the footprint of the ray that meets the surface
    #[default]
    Footprint,
    /// The whole image, however far away
    Finest,
}

/// How much work goes into the tree over the scene's triangles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Preset {
    /// The quickest to build.
    Fast,
    /// The least time to build and render in most cases.
    #[default]
    Balanced,
    /// The quickest to trace: also tries a tree that cuts long triangles, with up to twice as many
    /// references, and others; keeps the one that should cost rays least.
    Best,
}

/// Everything that a render needs besides scene, geometry and film.
///
/// The image depends on `integrator`, `strategy`, `light_selection`, `sampler`, `spp`, `max_depth`,
/// `roulette`, `survival`, `split`, `seed`, `texture_lod` and `ao_distance`; never on `bvh`, `threads`,
/// `wave` or `tile`.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// What is computed for each sample.
    pub integrator: Integrator,
    /// How a surface looks for light.
    pub strategy: Strategy,
    /// How lights are chosen where they are sampled.
    pub light_selection: LightSelection,
    /// Where the random numbers come from. The integrator `reference` has its own.
    pub sampler: Sampler,
    /// Samples a pixel, at least 1.
    pub spp: u32,
    /// The largest number of scattering events on a path; 0 shows emission only. `None`: no limit.
    pub max_depth: Option<u32>,
    /// Whether paths end at random by their throughput. Without it and without a maximum depth, a
    /// path in a closed scene would never end, so [`Settings::depth_limit`] then sets one.
    pub roulette: bool,
    /// Chance of a path to survive the roulette, over its throughput; above 0. The larger, the longer
    /// paths live, and the more each costs.
    pub survival: f32,
    /// Ways on from a path's first scattering event, from each of those at the second, and so on, at
    /// most [`Settings::MOST_SPLITS`] of them, each at least 1; after that, one. Their product is at
    /// most [`Settings::MOST_BRANCHES`], and times `spp` below 2^31.
    pub split: Vec<u32>,
    /// Seed of the random numbers.
    pub seed: u32,
    /// How finely images on surfaces are read. The integrator `reference` reads them at their finest.
    pub texture_lod: TextureLod,
    /// Occlusion distance of `ao` in scene units; `None`: a tenth of the scene's diagonal.
    pub ao_distance: Option<f32>,
    /// How much work goes into the tree over the triangles.
    pub bvh: Preset,
    /// Worker threads; 0: one for each core.
    pub threads: usize,
    /// Paths in a worker's wave.
    pub wave: usize,
    /// Edge of a square tile in pixels.
    pub tile: u32,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            integrator: Integrator::Path,
            strategy: Strategy::Mis,
            light_selection: LightSelection::Auto,
            sampler: Sampler::Sobol,
            spp: 64,
            max_depth: None,
            roulette: true,
            survival: SURVIVAL_GAIN,
            split: Vec::new(),
            seed: 0,
            texture_lod: TextureLod::default(),
            ao_distance: None,
            bvh: Preset::default(),
            threads: 0,
            wave: 4096,
            tile: 32,
        }
    }
}

impl Settings {
    /// The most scattering events at which paths branch.
    pub const MOST_SPLITS: usize = GAINS;
    /// The most branches of a camera sample.
    pub const MOST_BRANCHES: u32 = 1 << 16;

    /// A [`Settings::survival`] of roulette that ends paths a good deal sooner than usual.
    pub const AGGRESSIVE: f32 = 0.5;

    /// Depth at which paths are cut when neither a maximum depth nor roulette ends them: what is
    /// lost at an albedo of 0.99 is then below e^-40 of the answer.
    pub const CUT_WITHOUT_ROULETTE: u32 = 4096;

    /// The number of scattering events after which every path ends.
    #[must_use]
    pub fn depth_limit(&self) -> u32 {
        let asked = match self.integrator {
            Integrator::Direct => Some(self.max_depth.unwrap_or(1).min(1)),
            _ => self.max_depth,
        };
        asked.unwrap_or(if self.roulette {
            u32::MAX >> 1
        } else {
            Self::CUT_WITHOUT_ROULETTE
        })
    }
}
