//! Lights that are not surfaces, as the kernels' tables are made from them.

use std::sync::Arc;

/// Light from all around, without end.
#[derive(Clone, Debug, PartialEq)]
pub enum Sky {
    /// Radiance (W/m^2/sr) that goes linearly with the height of the direction.
    Gradient {
        /// From straight above (+y); each channel finite and >= 0.
        zenith: [f32; 3],
        /// From straight below (-y); each channel finite and >= 0.
        nadir: [f32; 3],
    },
    /// Radiance by direction.
    Map(Arc<Environment>),
}

/// An equirectangular map of radiance (W/m^2/sr), bilinear between the centres of its texels.
#[derive(Clone, Debug, PartialEq)]
pub struct Environment {
    /// Texels across, 1..=65535.
    pub width: u32,
    /// Texels down, 1..=65535.
    pub height: u32,
    /// By rows from straight up; each channel finite and >= 0.
    pub texels: Vec<[f32; 3]>,
    /// Orthonormal axes in the world: rightwards of the map's middle, up, and against its middle.
    pub frame: [[f32; 3]; 3],
}

impl Sky {
    /// The same radiance from everywhere.
    #[must_use]
    pub const fn constant(radiance: [f32; 3]) -> Self {
        Self::Gradient {
            zenith: radiance,
            nadir: radiance,
        }
    }

    /// Mean radiance over all directions. Of a gradient, since the height of a uniform direction is
    /// uniform (Archimedes), that of the horizon.
    #[must_use]
    pub fn mean(&self) -> [f32; 3] {
        match self {
            Self::Gradient { zenith, nadir } => {
                std::array::from_fn(|c| 0.5 * (zenith[c] + nadir[c]))
            }
            Self::Map(map) => map.mean(),
        }
    }

    /// Whether there is any light in it.
    #[must_use]
    pub fn shines(&self) -> bool {
        let bright = |colour: &[f32; 3]| colour.iter().any(|&c| c > 0.0);
        match self {
            Self::Gradient { zenith, nadir } => bright(zenith) || bright(nadir),
            Self::Map(map) => map.texels.iter().any(bright),
        }
    }
}

impl Environment {
    /// Mean radiance over all directions: of the texels, by their solid angles.
    #[must_use]
    pub fn mean(&self) -> [f32; 3] {
        let (mut sum, mut of) = ([0.0; 3], 0.0);
        for (row, texels) in self.texels.chunks_exact(self.width as usize).enumerate() {
            let [top, bottom] = [row, row + 1].map(|r| row_cosine(r, self.height as usize));
            let share = (top - bottom) / f64::from(self.width);
            of += top - bottom;
            for texel in texels {
                (0..3).for_each(|c| sum[c] += share * f64::from(texel[c]));
            }
        }
        sum.map(|s| (s / of) as f32)
    }
}

/// `cos(theta)` on the upper edge of row `row` of `rows` that cut the sphere at equal angles.
pub(crate) fn row_cosine(row: usize, rows: usize) -> f64 {
    super::degrees::sin_cos(180.0 * row as f64 / rows as f64).1
}

/// A light of no area.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// For people: its name, or its place in the scene file.
    pub name: String,
    /// What it is.
    pub kind: LightKind,
}

/// Lights of no area, in world space. Every channel of every colour is finite and >= 0, and one of
/// them > 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightKind {
    /// Light from a point, the same all around or within a cone.
    Point {
        /// Where it is.
        position: [f32; 3],
        /// Radiant intensity, W/sr; of a spot, where it is full.
        intensity: [f32; 3],
        /// The cone; without one the light goes all around.
        spot: Option<Spot>,
    },
    /// Parallel light, or a disc in the sky.
    Distant {
        /// Unit vector to where it comes from.
        from: [f32; 3],
        /// Irradiance of a surface that faces it, W/m^2.
        irradiance: [f32; 3],
        /// Half the angle that the disc subtends, in degrees, at most 90; 0 for parallel light.
        half_angle: f64,
    },
}

/// The cone of a spot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// Unit vector along its light.
    pub axis: [f32; 3],
    /// Cosine of the angle from the axis at which it is dark.
    pub dark: f32,
    /// Cosine of the angle up to which it is full, at least `dark`.
    pub full: f32,
}

impl LightKind {
    /// Its intensity or irradiance.
    #[must_use]
    pub fn colour(&self) -> [f32; 3] {
        match self {
            Self::Point { intensity, .. } => *intensity,
            Self::Distant { irradiance, .. } => *irradiance,
        }
    }

    /// What its colour is to be multiplied with to give the power that it sends into a scene of
    /// bounding radius `radius`, W.
    #[must_use]
    pub fn power_factor(&self, radius: f64) -> f64 {
        use std::f64::consts::{PI, TAU};
        match self {
            Self::Point { spot: None, .. } => 2.0 * TAU,
            // The smooth step is symmetric about 1/2, so half of the fading zone counts.
            Self::Point {
                spot: Some(spot), ..
            } => TAU * (1.0 - 0.5 * (f64::from(spot.full) + f64::from(spot.dark))),
            Self::Distant { .. } => PI * radius * radius,
        }
    }

    /// Whether it is at a finite distance.
    #[must_use]
    pub fn is_near(&self) -> bool {
        matches!(self, Self::Point { .. })
    }

    /// Whether no ray finds it.
    #[must_use]
    pub fn is_delta(&self) -> bool {
        self.extent() == 0.0
    }

    /// `1 - cos` of a disc's half angle; 0 for a light that has none.
    #[must_use]
    pub fn extent(&self) -> f64 {
        match self {
            Self::Point { .. } => 0.0,
            Self::Distant { half_angle, .. } => {
                2.0 * super::degrees::sin_cos(0.5 * half_angle).0.powi(2)
            }
        }
    }

    /// Radiance of a disc, W/m^2/sr: its irradiance over the projected solid angle
    /// `pi sin^2(half angle)`. Infinite for a light that has none.
    #[must_use]
    pub fn radiance(&self) -> [f64; 3] {
        let extent = self.extent();
        let sin2 = extent * (2.0 - extent);
        self.colour()
            .map(|c| f64::from(c) / (std::f64::consts::PI * sin2))
    }
}
