//! Light that no triangle emits, for the oracle: what rays find that leave the scene, and what delta
//! lights, which no ray finds, send to a point.

use super::vector;
use crate::scene::{Environment, Light, LightKind, Scene, Sky};
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// The scene's lights that are no triangles.
#[derive(Debug)]
pub(super) struct Lights<'a> {
    sky: Option<&'a Sky>,
    /// Those that rays find, and those that they do not.
    discs: Vec<Disc>,
    delta: Vec<&'a Light>,
}

#[derive(Debug)]
struct Disc {
    middle: DVec3,
    half_angle: f64,
    radiance: DVec3,
}

/// What a delta light sends to a point.
pub(super) struct Arriving {
    /// Unit vector to the light.
    pub(super) direction: DVec3,
    /// How far away it is.
    pub(super) distance: f64,
    /// Irradiance of a surface that faces it.
    pub(super) irradiance: DVec3,
}

impl<'a> Lights<'a> {
    pub(super) fn new(scene: &'a Scene) -> Self {
        let mut lights = Self {
            sky: scene.sky.as_ref(),
            discs: Vec::new(),
            delta: Vec::new(),
        };
        for light in &scene.lights {
            match light.kind {
                LightKind::Distant {
                    from,
                    irradiance,
                    half_angle,
                } if half_angle > 0.0 => {
                    let half_angle = half_angle.to_radians();
                    // E = L times the integral of the cosine over the disc.
                    let projected = PI * half_angle.sin().powi(2);
                    lights.discs.push(Disc {
                        middle: vector(from).normalize(),
                        half_angle,
                        radiance: vector(irradiance) / projected,
                    });
                }
                _ => lights.delta.push(light),
            }
        }
        lights
    }

    /// Radiance from the unit vector `direction`, where nothing is in the way.
    pub(super) fn beyond(&self, direction: DVec3) -> DVec3 {
        let sky = match self.sky {
            None => DVec3::ZERO,
            Some(Sky::Gradient { zenith, nadir }) => {
                vector(*nadir).lerp(vector(*zenith), 0.5 + 0.5 * direction.y)
            }
            Some(Sky::Map(map)) => bilinear(map, direction),
        };
        let inside = |disc: &&Disc| disc.middle.angle_between(direction) < disc.half_angle;
        let discs: DVec3 = self.discs.iter().filter(inside).map(|d| d.radiance).sum();
        sky + discs
    }

    /// What each delta light sends to `point`, if nothing is in the way.
    pub(super) fn arriving(&self, point: DVec3) -> impl Iterator<Item = Arriving> {
        self.delta.iter().map(move |light| match light.kind {
            LightKind::Distant {
                from, irradiance, ..
            } => Arriving {
                direction: vector(from).normalize(),
                distance: f64::INFINITY,
                irradiance: vector(irradiance),
            },
            LightKind::Point {
                position,
                intensity,
                spot,
            } => {
                let to = vector(position) - point;
                let direction = to.normalize();
                let share = spot.map_or(1.0, |spot| {
                    let [dark, full] = [spot.dark, spot.full].map(f64::from);
                    let t = (-vector(spot.axis).dot(direction) - dark) / (full - dark);
                    let t = t.clamp(0.0, 1.0);
                    t * t * (3.0 - 2.0 * t)
                });
                Arriving {
                    direction,
                    distance: to.length(),
                    irradiance: vector(intensity) * (share / to.length_squared()),
                }
            }
        })
    }
}

/// The map's radiance from `direction`: weights of the four texels about its place.
fn bilinear(map: &Environment, direction: DVec3) -> DVec3 {
    let [x, y, z] = map.frame.map(|axis| vector(axis).dot(direction));
    let longitude = x.atan2(-z) / TAU + 0.5;
    let latitude = y.clamp(-1.0, 1.0).acos() / PI;
    let across = longitude * f64::from(map.width) - 0.5;
    let down = latitude * f64::from(map.height) - 0.5;
    let mut sum = DVec3::ZERO;
    for (i, j) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
        let (column, row) = (across.floor() + f64::from(i), down.floor() + f64::from(j));
        let weight = (1.0 - (across - column).abs()) * (1.0 - (down - row).abs());
        let column = (column as i64).rem_euclid(i64::from(map.width));
        let row = (row as i64).clamp(0, i64::from(map.height) - 1);
        sum += weight * vector(map.texels[(row * i64::from(map.width) + column) as usize]);
    }
    sum
}
