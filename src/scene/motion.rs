//! Motion while the shutter is open: what a scene file says of it, and where things are at a moment.

use super::compiled::{Camera, Scene};
use super::description;
use super::error::SceneError;
use super::material::Bsdf;
use super::placed::{Instance, Placement};
use super::toml::SceneFile;
use glam::{DAffine3, DMat3, DVec3};
pub use huygens_kernels::motion::Motion;
use toml::Spanned;

/// The motion that a file says; none if it goes nowhere.
///
/// # Errors
/// An axis of no direction, more than a whole turn, a way beyond 32-bit floats.
pub(super) fn compile(
    file: &SceneFile,
    said: Option<&Spanned<description::Motion>>,
) -> Result<Option<Motion>, SceneError> {
    let Some(spanned) = said else {
        return Ok(None);
    };
    let said = spanned.get_ref();
    let travel = said.translate.map_or([0.0; 3], |v| v.map(|x| x.0 as f32));
    let (mut axis, mut turns) = ([0.0, 1.0, 0.0], 0.0);
    if let Some(rotate) = &said.rotate {
        let (about, degrees) = rotate
            .get_ref()
            .axis()
            .map_err(|message| file.error(rotate.span(), message))?;
        if degrees.abs() > 360.0 {
            let message = format!("found {degrees} degrees, expected a turn of at most 360");
            return Err(file.error(rotate.span(), message));
        }
        // A turn the other way is one about the opposite axis.
        axis = (about * degrees.signum()).as_vec3().to_array();
        turns = (degrees.abs() / 360.0) as f32;
    }
    let still = turns == 0.0 && travel == [0.0; 3];
    Ok((!still).then_some(Motion {
        travel,
        axis,
        turns,
    }))
}

/// `R(time)` and the way gone by then, in f64.
pub(crate) fn at(motion: &Motion, time: f64) -> (DMat3, DVec3) {
    let wide = |v: [f32; 3]| DVec3::from_array(v.map(f64::from));
    let angle = std::f64::consts::TAU * f64::from(motion.turns) * time;
    let axis = wide(motion.axis).normalize();
    (
        DMat3::from_axis_angle(axis, angle),
        time * wide(motion.travel),
    )
}

/// Where an instance is at a moment.
pub(crate) fn placed(instance: &Instance, time: f64) -> DAffine3 {
    let still = instance.placement.map();
    let Some(motion) = &instance.motion else {
        return still;
    };
    let (turn, way) = at(motion, time);
    DAffine3::from_mat3_translation(turn * still.matrix3, still.translation + way)
}

impl Scene {
    /// What moves while the shutter is open, if anything does.
    #[must_use]
    pub fn moves(&self) -> Option<String> {
        if self.camera_motion.is_some() {
            return Some("the camera's `motion`".to_owned());
        }
        let moving = self.instances.iter().find(|i| i.motion.is_some())?;
        let object = &self.objects[moving.object as usize];
        Some(format!("an instance of object `{}`", object.name))
    }

    /// The scene as it is at `time`, from 0 to 1 while the shutter is open: nothing in it moves.
    #[must_use]
    pub fn frozen(&self, time: f64) -> Self {
        let mut still = self.clone();
        for (from, to) in self.instances.iter().zip(&mut still.instances) {
            if from.motion.is_some() {
                // A rigid motion of what could be placed can be placed.
                if let Ok(placement) = Placement::new(&placed(from, time)) {
                    to.placement = placement;
                }
                to.motion = None;
            }
        }
        if let Some(motion) = still.camera_motion.take() {
            let (turn, way) = at(&motion, time);
            let wide = |v: [f32; 3]| DVec3::from_array(v.map(f64::from));
            let turned = |v: [f32; 3]| (turn * wide(v)).as_vec3().to_array();
            let c = self.camera;
            still.camera = Camera {
                origin: (wide(c.origin) + way).as_vec3().to_array(),
                forward: turned(c.forward),
                right: turned(c.right),
                up: turned(c.up),
                ..c
            };
        }
        still
    }

    /// Whether glass that it holds disperses light.
    #[must_use]
    pub fn disperses(&self) -> bool {
        let worn = self.materials.iter().zip(self.worn());
        worn.filter(|(_, worn)| *worn).any(|(m, _)| m.disperses())
    }

    /// The scene as it is in light of one wavelength, in nanometres: nothing in it disperses.
    #[must_use]
    pub fn at_wavelength(&self, nanometres: f64) -> Self {
        let mut single = self.clone();
        for material in &mut single.materials {
            let disperses = material.disperses();
            let (ior, dispersion) = match &mut material.bsdf {
                Bsdf::Dielectric(glass) => (&mut glass.ior, &mut glass.dispersion),
                Bsdf::Principled(p) => (&mut p.ior, &mut p.dispersion),
                _ => continue,
            };
            if let Some(cauchy) = dispersion.take().filter(|_| disperses) {
                *ior = cauchy.at(nanometres) as f32;
            }
        }
        single
    }
}
