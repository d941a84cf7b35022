//! Objects and their instances in a scene file.

use super::builder::Builder;
use super::degrees;
use super::description::{self, Description, Scatter};
use super::error::SceneError;
use super::material::Material;
use super::motion;
use super::placed::{Instance, Object, Placement};
use super::shapes::Shapes;
use super::toml::suggest;
use super::transform::vector;
use glam::{DAffine3, DMat3, DVec3};
use toml::Spanned;

/// Most instances of a scene: their tables would need more than ten gigabytes.
const MOST: u64 = 1 << 26;
/// How far scattered copies are moved out of their rows, over their mean distance.
const JITTER: f64 = 0.4;

impl Shapes<'_> {
    /// What can be told to be wrong with objects and instances before the geometry is there.
    pub(super) fn check_instances(&self, said: &Description) -> Result<(), SceneError> {
        for shape in said.objects.values().flat_map(|object| &object.shapes) {
            if shape.get_ref().sphere.is_some() {
                let message = "an object holds triangles, expected the sphere among `shapes`";
                return Err(self.file.error(shape.span(), message));
            }
        }
        let mut copies = 0;
        for spanned in &said.instances {
            let instance = spanned.get_ref();
            let object = self.object(said, &instance.object)?;
            if object.shapes.is_empty() {
                let message = format!("object `{}` has no shapes", instance.object.get_ref());
                return Err(self.file.error(instance.object.span(), message));
            }
            let map = self.placement(instance.transform.as_ref())?;
            let place = |map: &DAffine3| {
                let wrong = |e: String| self.file.error(spanned.span(), e);
                Placement::new(map).map(|_| ()).map_err(wrong)
            };
            place(&map)?;
            motion::compile(self.file, instance.motion.as_ref())?;
            if let Some(name) = &instance.material {
                self.lookup(name)?;
            }
            if let Some(scatter) = &instance.scatter {
                let [low, high] = scatter.scale();
                if low > high {
                    let message = format!(
                        "scatter: scale: found [{low}, {high}], expected the \
                                           smaller first"
                    );
                    return Err(self.file.error(spanned.span(), message));
                }
                for i in [0, scatter.count.0 - 1] {
                    place(&(scatter.place(i) * map))?;
                }
            }
            copies += u64::from(instance.copies());
            if copies > MOST {
                let message = format!("the scene has {copies} instances, expected at most {MOST}");
                return Err(self.file.error(spanned.span(), message));
            }
        }
        Ok(())
    }

    fn object<'s>(
        &self,
        said: &'s Description,
        name: &Spanned<String>,
    ) -> Result<&'s description::Object, SceneError> {
        said.objects.get(name.get_ref()).ok_or_else(|| {
            let names: Vec<&str> = said.objects.keys().map(String::as_str).collect();
            let hint = suggest(name.get_ref(), &names);
            let message = format!("no object `{}`, {hint}", name.get_ref());
            self.file.error(name.span(), message)
        })
    }

    /// The objects that have instances, and the instances.
    pub(super) fn instances(
        &mut self,
        said: &Description,
    ) -> Result<(Vec<Object>, Vec<Instance>), SceneError> {
        let world = std::mem::take(&mut self.builder);
        let mut objects: Vec<Object> = Vec::new();
        let (mut dropped, mut numbers) = (0, 0u64);
        for (name, object) in &said.objects {
            for shape in &object.shapes {
                self.add(shape)?;
            }
            let mut built = std::mem::take(&mut self.builder);
            dropped += built.dropped;
            built.mesh.vertices.shrink_to_fit();
            built.mesh.indices.shrink_to_fit();
            built.mesh.material.shrink_to_fit();
            objects.push(Object {
                name: name.clone(),
                mesh: built.mesh,
            });
        }
        self.builder = Builder {
            dropped: world.dropped + dropped,
            ..world
        };
        let mut instances = Vec::new();
        for spanned in &said.instances {
            let instance = spanned.get_ref();
            let name = instance.object.get_ref();
            let Some(index) = objects.iter().position(|o| o.name == *name) else {
                unreachable!("instances are checked before they are made");
            };
            let wrong = |message| self.file.error(instance.object.span(), message);
            let material = instance.material.as_ref().map(|name| self.lookup(name));
            let material = material.transpose()?;
            let mesh = &objects[index].mesh;
            if mesh.indices.is_empty() {
                return Err(wrong(format!("object `{name}` has no triangles")));
            }
            let emits = |m: &&Material| m.emits();
            let worn: &mut dyn Iterator<Item = u32> = match material {
                Some(material) => &mut std::iter::once(material),
                None => &mut mesh.material.iter().copied(),
            };
            let mut worn = worn.map(|m| &self.materials[m as usize]);
            if let Some(light) = worn.find(emits) {
                return Err(wrong(format!(
                    "material `{}` of object `{name}` emits, which instances cannot yet, expected \
                     the light among `shapes`",
                    light.name
                )));
            }
            numbers += u64::from(instance.copies()) * mesh.triangles() as u64;
            let all = numbers + (self.builder.mesh.triangles() + self.spheres.len()) as u64;
            if all >= u64::from(u32::MAX) {
                return Err(wrong(format!(
                    "the scene has {all} triangles and spheres, those of instances counted as often \
                     as they are copied, expected at most {}",
                    u32::MAX - 1
                )));
            }
            let motion = motion::compile(self.file, instance.motion.as_ref())?;
            let map = self.placement(instance.transform.as_ref())?;
            let copy = |map: DAffine3| {
                let placement = Placement::new(&map);
                let placement = placement.map_err(|e| self.file.error(spanned.span(), e))?;
                Ok(Instance {
                    object: index as u32,
                    placement,
                    material,
                    motion,
                })
            };
            match &instance.scatter {
                None => instances.push(copy(map)?),
                Some(scatter) => {
                    for i in 0..scatter.count.0 {
                        instances.push(copy(scatter.place(i) * map)?);
                    }
                }
            }
        }
        Ok((objects, instances))
    }
}

impl Scatter {
    fn scale(&self) -> [f64; 2] {
        self.scale.map_or([1.0; 2], |range| range.map(|s| s.0))
    }

    /// Where copy `i` goes: scaled, turned about y, and moved to a point of the parallelogram.
    ///
    /// Points are those of the R2 sequence (M. Roberts, "The Unreasonable Effectiveness of
    /// Quasirandom Sequences", 2018), shifted by the seed: multiples of the inverse powers of the
    /// plastic number, which lie evenly; and as they lie in rows, each is moved by up to [`JITTER`]
    /// of their mean distance. Sizes and angles are independent of them.
    fn place(&self, i: u32) -> DAffine3 {
        const PLASTIC: f64 = 1.324_717_957_244_746;
        let unit = |k: u64| {
            let mixed = mix(u64::from(self.seed.0) << 32 ^ mix(k << 32 ^ u64::from(i)));
            (mixed >> 11) as f64 / (1u64 << 53) as f64
        };
        let shift = |k: u64| (mix(mix(u64::from(self.seed.0)) ^ k) >> 11) as f64;
        let along = |k: u64, step: f64| {
            let start = shift(k) / (1u64 << 53) as f64;
            let aside = JITTER * (2.0 * unit(k) - 1.0) / f64::from(self.count.0).sqrt();
            (start + (f64::from(i) + 1.0) * step + aside).rem_euclid(1.0)
        };
        let (a, b) = (along(1, 1.0 / PLASTIC), along(2, 1.0 / (PLASTIC * PLASTIC)));
        let [e, f] = self.edges.map(vector);
        let point = vector(self.corner) + a * e + b * f;
        let [low, high] = self.scale();
        let scale = low + (high - low) * unit(3);
        let (sin, cos) = degrees::sin_cos(360.0 * unit(4));
        let turn = DMat3::from_cols(
            DVec3::new(cos, 0.0, -sin),
            DVec3::Y,
            DVec3::new(sin, 0.0, cos),
        );
        DAffine3::from_mat3_translation(turn * scale, point)
    }
}

/// The finalizer of SplitMix64 (G. Steele, D. Lea, C. Flood, OOPSLA 2014).
fn mix(z: u64) -> u64 {
    let z = z.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::values::{Count, Finite, Natural, Positive};

    #[test]
    fn scattered_copies_stand_evenly_upright_and_on_the_ground() {
        let n = 1000;
        let scatter = Scatter {
            count: Count(n),
            seed: Natural(3),
            corner: [Finite(-1.0), Finite(2.0), Finite(-1.0)],
            edges: [
                [Finite(2.0), Finite(0.0), Finite(0.0)],
                [Finite(0.0), Finite(0.0), Finite(2.0)],
            ],
            scale: Some([Positive(0.5), Positive(2.0)]),
        };
        let places: Vec<DAffine3> = (0..n).map(|i| scatter.place(i)).collect();
        let mut cells = [0; 16];
        for p in &places {
            let at = p.translation;
            assert!(at.x.abs() <= 1.0 && at.z.abs() <= 1.0 && at.y == 2.0);
            let scale = p.matrix3.y_axis.y;
            assert!((0.5..=2.0).contains(&scale));
            let volume = p.matrix3.determinant() / scale.powi(3);
            assert!(
                (volume - 1.0).abs() <= 32.0 * f64::EPSILON,
                "no mirror, no shear"
            );
            let cell = |c: f64| ((2.0 * (c + 1.0)) as usize).min(3);
            cells[4 * cell(at.x) + cell(at.z)] += 1;
        }
        // Of 62.5 a cell, rows leave or enter by one at each of four sides (8 a side), and so do
        // points that are moved across, within 0.4 of a row.
        let even = |c: &i32| (f64::from(*c) - 62.5).abs() <= 4.0 * 8.0 * 0.4 + 8.0;
        assert!(cells.iter().all(even), "{cells:?}");
    }
}
