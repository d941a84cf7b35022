//! What a scene file says of its sky and of lights that are no surfaces, as the tables say it.

use super::compile::radiance;
use super::daylight::Daylight;
use super::degrees;
use super::description::{self, Description};
use super::error::SceneError;
use super::import::panorama::{self, Pixels};
use super::light::{Environment, Light, LightKind, Sky, Spot};
use super::toml::SceneFile;
use super::values::{Finite, NonNegative, OneOrThree};
use glam::{DMat3, DQuat, DVec3};
use std::path::PathBuf;
use std::sync::Arc;
use toml::Spanned;

/// The file of the sky's map, if it has one, which is there.
pub(super) fn map_file(
    file: &SceneFile,
    said: &Description,
) -> Result<Option<PathBuf>, SceneError> {
    let Some(name) = said.sky.as_ref().and_then(|s| s.get_ref().map.as_ref()) else {
        return Ok(None);
    };
    let path = file.beside(name.get_ref());
    panorama::check(&path).map_err(|message| file.error(name.span(), message))?;
    Ok(Some(path))
}

/// What can be told to be wrong without the sky's map at hand.
pub(super) fn check(file: &SceneFile, said: &Description) -> Result<(), SceneError> {
    if let Some(sky) = &said.sky {
        check_sky(file, sky)?;
    }
    lights(file, said, &mut Vec::new()).map(|_| ())
}

fn check_sky(file: &SceneFile, sky: &Spanned<description::Sky>) -> Result<(), SceneError> {
    let (span, sky) = (sky.span(), sky.get_ref());
    let kinds = [
        ("radiance", sky.radiance.is_some()),
        ("map", sky.map.is_some()),
        ("sun", sky.sun.is_some()),
    ];
    let mut given = kinds.iter().filter(|(_, given)| *given);
    let (Some((kind, _)), None) = (given.next(), given.next()) else {
        return Err(file.error(span, "expected exactly one of `radiance`, `map` and `sun`"));
    };
    for (name, key, kinds) in [
        (
            "nadir",
            sky.nadir.as_ref().map(Spanned::span),
            ["radiance"; 2],
        ),
        (
            "scale",
            sky.scale.as_ref().map(Spanned::span),
            ["map", "sun"],
        ),
        ("rotate", sky.rotate.as_ref().map(Spanned::span), ["map"; 2]),
        ("up", sky.up.as_ref().map(Spanned::span), ["map", "sun"]),
        (
            "turbidity",
            sky.turbidity.as_ref().map(Spanned::span),
            ["sun"; 2],
        ),
        ("ground", sky.ground.as_ref().map(Spanned::span), ["sun"; 2]),
        ("disc", sky.disc.as_ref().map(Spanned::span), ["sun"; 2]),
    ] {
        if let Some(key) = key
            && !kinds.contains(kind)
        {
            let message = format!("a sky of `{kind}` has no `{name}`");
            return Err(file.error(key, message));
        }
    }
    let up = up(file, sky)?;
    if let Some(sun) = &sky.sun
        && direction(file, sun)?.dot(up) <= 0.0
    {
        return Err(file.error(
            sun.span(),
            "is not above the horizon, expected a sun that is up",
        ));
    }
    Ok(())
}

/// The direction of a sky's top.
fn up(file: &SceneFile, sky: &description::Sky) -> Result<DVec3, SceneError> {
    sky.up
        .as_ref()
        .map_or(Ok(DVec3::Y), |up| direction(file, up))
}

/// The sky, and the sun in it, if it brings one; `map` holds the pixels of its map, if it has one.
pub(super) fn sky(
    file: &SceneFile,
    said: &Description,
    map: Option<Pixels>,
) -> Result<(Option<Sky>, Option<Light>), SceneError> {
    let Some(sky) = &said.sky else {
        return Ok((None, None));
    };
    let (span, sky) = (sky.span(), sky.get_ref());
    let up = up(file, sky)?;
    let degrees = sky.rotate.as_ref().map_or(0.0, |r| r.get_ref().0);
    let frame = frame(up, degrees);
    let scale = sky
        .scale
        .as_ref()
        .map_or([1.0; 3], |s| radiance(*s.get_ref()));
    let too_bright = || file.error(span.clone(), "`scale` takes the sky beyond 32-bit floats");
    let finite = |texels: &[[f32; 3]]| texels.as_flattened().iter().all(|c| c.is_finite());
    if let Some(sun) = &sky.sun {
        let axes = frame.map(|a| DVec3::from_array(a.map(f64::from)));
        let sun = direction(file, sun)?;
        let ground = sky
            .ground
            .as_ref()
            .map_or([0.2; 3], |g| g.get_ref().0.map(|c| c.0));
        let day = Daylight {
            turbidity: sky.turbidity.as_ref().map_or(3.0, |t| t.get_ref().0),
            sun: DVec3::from_array(axes.map(|axis| axis.dot(sun))).normalize(),
            ground: DVec3::from_array(ground),
            scale: DVec3::from_array(scale.map(f64::from)),
        };
        let (map, sun) = day.compile(frame);
        let disc = sun
            .kind
            .radiance()
            .iter()
            .all(|&c| c <= f64::from(f32::MAX));
        if !finite(&map.texels) || !disc {
            return Err(too_bright());
        }
        let shown = sky.disc.as_ref().is_none_or(|d| *d.get_ref());
        let sun = (shown && sun.kind.colour().iter().any(|&c| c > 0.0)).then_some(sun);
        return Ok((Some(Sky::Map(Arc::new(map))), sun));
    }
    let Some(map) = map else {
        let zenith = radiance(sky.radiance.unwrap_or(OneOrThree([NonNegative(0.0); 3])));
        let nadir = sky
            .nadir
            .as_ref()
            .map_or(zenith, |n| radiance(*n.get_ref()));
        return Ok((Some(Sky::Gradient { zenith, nadir }), None));
    };
    let mut texels = map.rgb;
    if sky.scale.is_some() {
        for texel in &mut texels {
            (0..3).for_each(|c| texel[c] *= scale[c]);
        }
        if !finite(&texels) {
            return Err(too_bright());
        }
    }
    let map = Environment {
        width: map.width,
        height: map.height,
        texels,
        frame,
    };
    Ok((Some(Sky::Map(Arc::new(map))), None))
}

/// The axes of a map whose top lies towards the unit vector `up`, turned about it: rightwards of its
/// middle, up, and against its middle. Upright and not turned, the middle lies towards -z; for
/// another `up` all is turned there the short way.
fn frame(up: DVec3, degrees: f64) -> [[f32; 3]; 3] {
    let (sin, cos) = degrees::sin_cos(degrees);
    let upright = DMat3::from_quat(DQuat::from_rotation_arc(DVec3::Y, up));
    let turned = [
        DVec3::new(cos, 0.0, -sin),
        DVec3::Y,
        DVec3::new(sin, 0.0, cos),
    ];
    turned.map(|axis| (upright * axis).as_vec3().to_array())
}

/// A unit vector along what the file says, which must not be zero.
fn direction(file: &SceneFile, said: &Spanned<[Finite; 3]>) -> Result<DVec3, SceneError> {
    let vector = DVec3::from_array(said.get_ref().map(|x| x.0));
    vector.try_normalize().ok_or_else(|| {
        file.error(
            said.span(),
            "found a vector of length 0, expected a direction",
        )
    })
}

/// The lights that are no surfaces. Those that are black are left out with a warning.
pub(super) fn lights(
    file: &SceneFile,
    said: &Description,
    warnings: &mut Vec<String>,
) -> Result<Vec<Light>, SceneError> {
    let mut lights = Vec::new();
    for (i, light) in said.lights.iter().enumerate() {
        let kind = kind(file, light)?;
        let said = light.get_ref().name.as_deref();
        let name = said.map_or_else(|| format!("lights[{i}]"), str::to_owned);
        if kind.colour().iter().all(|&c| c == 0.0) {
            warnings.push(format!("light `{name}` is black: left out"));
        } else {
            lights.push(Light { name, kind });
        }
    }
    Ok(lights)
}

fn kind(file: &SceneFile, light: &Spanned<description::Light>) -> Result<LightKind, SceneError> {
    let (span, light) = (light.span(), light.get_ref());
    let kind = match (&light.point, &light.spot, &light.sun) {
        (Some(point), None, None) => LightKind::Point {
            position: single(point.position),
            intensity: [0.0; 3],
            spot: None,
        },
        (None, Some(spot), None) => LightKind::Point {
            position: single(spot.position),
            intensity: [0.0; 3],
            spot: Some(cone(file, spot)?),
        },
        (None, None, Some(sun)) => LightKind::Distant {
            from: direction(file, &sun.from)?.as_vec3().to_array(),
            irradiance: [0.0; 3],
            half_angle: 0.5 * sun.angle.map_or(0.0, |a| a.0),
        },
        _ => {
            let message = "expected exactly one of `point`, `spot` and `sun`";
            return Err(file.error(span, message));
        }
    };
    let quantities = [
        ("power", &light.power),
        ("intensity", &light.intensity),
        ("irradiance", &light.irradiance),
        ("radiance", &light.radiance),
    ];
    let given: Vec<_> = quantities
        .into_iter()
        .filter_map(|(name, value)| value.as_ref().map(|v| (name, v)))
        .collect();
    let [(name, value)] = given[..] else {
        let message = match kind {
            LightKind::Point { .. } => "expected either `power` or `intensity`",
            LightKind::Distant { .. } => "expected either `irradiance` or `radiance`",
        };
        return Err(file.error(span, message));
    };
    let colour = value.get_ref().0.map(|c| c.0);
    let scaled = |factor: f64| colour.map(|c| (c * factor) as f32);
    let with = match kind {
        LightKind::Point { position, spot, .. } => {
            let factor = match name {
                "intensity" => 1.0,
                "power" => 1.0 / kind.power_factor(0.0),
                _ => {
                    return Err(file.error(
                        value.span(),
                        format!(
                            "a point and a spot have a `power` or an `intensity`, not `{name}`"
                        ),
                    ));
                }
            };
            LightKind::Point {
                position,
                intensity: scaled(factor),
                spot,
            }
        }
        LightKind::Distant {
            from, half_angle, ..
        } => {
            let factor = match name {
                "irradiance" => 1.0,
                "radiance" if half_angle > 0.0 => {
                    std::f64::consts::PI * degrees::sin_cos(half_angle).0.powi(2)
                }
                "radiance" => {
                    return Err(file.error(
                        value.span(),
                        "a sun without an `angle` has no `radiance`: expected `irradiance`",
                    ));
                }
                _ => {
                    return Err(file.error(
                        value.span(),
                        format!("a sun has an `irradiance` or a `radiance`, not `{name}`"),
                    ));
                }
            };
            LightKind::Distant {
                from,
                irradiance: scaled(factor),
                half_angle,
            }
        }
    };
    let finite = |c: &f32| c.is_finite();
    let disc = with.extent() == 0.0 || with.radiance().iter().all(|&c| c <= f64::from(f32::MAX));
    if with.colour().iter().all(finite) && disc {
        Ok(with)
    } else {
        Err(file.error(
            value.span(),
            "is beyond 32-bit floats for a light of this angle",
        ))
    }
}

fn single(point: [Finite; 3]) -> [f32; 3] {
    point.map(|x| x.0 as f32)
}

/// The share of a spot's angle over which it fades, unless the file says another.
const BLEND: f64 = 0.1;

fn cone(file: &SceneFile, spot: &description::Spot) -> Result<Spot, SceneError> {
    let from = DVec3::from_array(spot.position.map(|x| x.0));
    let to = DVec3::from_array(spot.target.get_ref().map(|x| x.0));
    let axis = (to - from).try_normalize().ok_or_else(|| {
        file.error(
            spot.target.span(),
            "is where the light stands, expected another point",
        )
    })?;
    let edge = 0.5 * spot.angle.0;
    let full = edge * (1.0 - spot.blend.map_or(BLEND, |b| b.0));
    let cos = |degrees: f64| degrees::sin_cos(degrees).1 as f32;
    Ok(Spot {
        axis: axis.as_vec3().to_array(),
        dark: cos(edge),
        full: cos(full),
    })
}
