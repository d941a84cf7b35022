//! From a material's BSDF to the slots where its kernel looks for its parameters
//! (`huygens_kernels::scatter::kinds`), and to the images that vary them.

use crate::scene::material::{Cauchy, Dielectric, Principled, TextureUse, Textured};
use crate::scene::{Bsdf, Material};
use huygens_kernels::bsdf::fresnel::conductor_mean;
use huygens_kernels::images::Site;
use huygens_kernels::scatter::kinds::CAUCHY_B;
use huygens_kernels::scatter::texture::Layout;
use huygens_kernels::tables::SLOTS;

/// The slot of the principled surface's index.
const INDEX: usize = 5;

/// The parameters of a material.
#[derive(Clone, Debug, Default)]
pub(crate) struct Parameters {
    /// Their values, or what images are multiplied with.
    pub(crate) slots: [f32; SLOTS],
    /// Which of them are in use, and which images may vary: the same for all materials of a shader.
    pub(crate) layout: Layout,
    /// For each place of `layout.sites`: what varies it.
    pub(crate) images: Vec<Option<TextureUse>>,
}

impl Parameters {
    /// The parameters of `material`. A mixture has none.
    pub(crate) fn of(material: &Material) -> Self {
        let mut all = Self::default();
        match &material.bsdf {
            Bsdf::Diffuse {
                reflectance,
                roughness,
            } => {
                all.colour(reflectance);
                all.plain(&[*roughness]);
            }
            Bsdf::Conductor {
                eta,
                k,
                tint,
                roughness,
                anisotropy,
            } => {
                all.plain(eta);
                all.plain(k);
                all.colour(tint);
                all.number(roughness);
                all.plain(&[*anisotropy]);
                // Light that has met two facets or more is in proportion to it: at 0 there is none.
                let mean = |c: usize| {
                    if material.compensation {
                        conductor_mean(f64::from(eta[c]), f64::from(k[c])) as f32
                    } else {
                        0.0
                    }
                };
                all.plain(&[mean(0), mean(1), mean(2)]);
            }
            Bsdf::Dielectric(glass) => {
                all.dielectric(glass);
                all.plain(&[flag(material.compensation)]);
                all.disperse(0, glass.dispersion.filter(|_| glass.disperses()));
            }
            Bsdf::Principled(p) => {
                all.principled(p);
                all.plain(&[flag(material.compensation)]);
                all.disperse(INDEX, p.dispersion.filter(|_| p.disperses()));
            }
            Bsdf::Mix { .. } => {}
        }
        all
    }

    fn plain(&mut self, values: &[f32]) {
        let at = self.layout.slots;
        self.slots[at..at + values.len()].copy_from_slice(values);
        self.layout.slots += values.len();
    }

    fn colour(&mut self, value: &Textured<[f32; 3]>) {
        self.site(true, value.texture);
        self.plain(&value.factor);
    }

    fn number(&mut self, value: &Textured<f32>) {
        self.site(false, value.texture);
        self.plain(&[value.factor]);
    }

    fn site(&mut self, colour: bool, texture: Option<TextureUse>) {
        let slot = self.layout.slots;
        self.layout.sites.push(Site { slot, colour });
        self.images.push(texture);
    }

    /// An index of refraction at slot `at` that depends on the wavelength.
    fn disperse(&mut self, at: usize, index: Option<Cauchy>) {
        if let Some(Cauchy { a, b, c }) = index {
            self.slots[at] = a;
            self.slots[CAUCHY_B..].copy_from_slice(&[b, c]);
            self.layout.slots = SLOTS;
        }
    }

    fn dielectric(&mut self, glass: &Dielectric) {
        self.plain(&[glass.ior, flag(glass.thin)]);
        self.colour(&glass.reflection_tint);
        self.colour(&glass.transmission_tint);
        self.number(&glass.roughness);
    }

    fn principled(&mut self, p: &Principled) {
        self.colour(&p.base_color);
        self.number(&p.metallic);
        self.number(&p.roughness);
        self.plain(&[p.ior]);
        self.number(&p.specular);
        self.colour(&p.specular_color);
        self.number(&p.transmission);
        self.plain(&[flag(p.thin)]);
        self.number(&p.clearcoat);
        self.number(&p.clearcoat_roughness);
        self.colour(&p.sheen_color);
        self.number(&p.sheen_roughness);
    }
}

fn flag(on: bool) -> f32 {
    f32::from(u8::from(on))
}
