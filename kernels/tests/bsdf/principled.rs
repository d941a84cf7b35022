//! The metallic-roughness model.

use crate::common::{Source, Suite};
use crate::harness::{
    COSINES, Map, ROUNDING, assert_close, chi_square, consistent, corners, direction, dot, furnace,
    rounded, splat,
};
use crate::twin;
use huygens_kernels::bsdf::charlie::ROUGHNESS_FLOOR;
use huygens_kernels::bsdf::{
    ALPHA_FLOOR, Bsdf, Principled, ReflectionEnergy, RoughDielectric, SchlickEnergy, SheenEnergy,
    SmoothDielectric, TransmissionEnergy,
};
use huygens_kernels::lanes::{Fx, Mask};
use huygens_kernels::vec3::Vec3x;
use std::f64::consts::PI;

fn mask(yes: bool) -> Mask {
    if yes {
        Fx::ONE.simd_eq(Fx::ONE)
    } else {
        Fx::ZERO
    }
}

/// A material's parameters, one set for all lanes.
#[derive(Clone, Copy, Debug)]
struct Material {
    base: [f32; 3],
    metallic: f32,
    alpha: f32,
    eta: f32,
    specular: f32,
    specular_color: [f32; 3],
    transmission: f32,
    thin: bool,
    coat: f32,
    coat_alpha: f32,
    sheen: [f32; 3],
    sheen_roughness: f32,
}

/// What glTF takes where a file says nothing, but for a roughness of a half, and white.
const PLAIN: Material = Material {
    base: [1.0; 3],
    metallic: 0.0,
    alpha: 0.25,
    eta: 1.5,
    specular: 1.0,
    specular_color: [1.0; 3],
    transmission: 0.0,
    thin: true,
    coat: 0.0,
    coat_alpha: ALPHA_FLOOR,
    sheen: [0.0; 3],
    sheen_roughness: ROUGHNESS_FLOOR,
};

impl Material {
    fn lanes(&self) -> Principled {
        Principled {
            base: Vec3x::splat(self.base),
            metallic: Fx::splat(self.metallic),
            alpha: Fx::splat(self.alpha),
            eta: Fx::splat(self.eta),
            specular: Fx::splat(self.specular),
            specular_color: Vec3x::splat(self.specular_color),
            transmission: Fx::splat(self.transmission),
            thin: mask(self.thin),
            coat: Fx::splat(self.coat),
            coat_alpha: Fx::splat(self.coat_alpha),
            sheen: Vec3x::splat(self.sheen),
            sheen_roughness: Fx::splat(self.sheen_roughness),
            compensated: mask(true),
        }
    }
}

/// One of each kind, and mixtures of all.
fn materials() -> Vec<(&'static str, Material)> {
    let thick = Material {
        transmission: 1.0,
        thin: false,
        ..PLAIN
    };
    let coated = Material {
        coat: 1.0,
        coat_alpha: 0.3,
        ..PLAIN
    };
    let all = Material {
        base: [0.9, 0.6, 0.2],
        metallic: 0.3,
        specular: 0.8,
        specular_color: [1.0, 0.7, 0.4],
        transmission: 0.5,
        sheen: [0.3, 0.6, 0.2],
        sheen_roughness: 0.5,
        coat: 0.6,
        coat_alpha: 0.3,
        ..PLAIN
    };
    vec![
        ("plastic", PLAIN),
        (
            "polished plastic",
            Material {
                alpha: ALPHA_FLOOR,
                ..PLAIN
            },
        ),
        (
            "rough plastic",
            Material {
                alpha: 1.0,
                ..PLAIN
            },
        ),
        ("diamond paint", Material { eta: 2.4, ..PLAIN }),
        ("index 1", Material { eta: 1.0, ..PLAIN }),
        (
            "no specular",
            Material {
                specular: 0.0,
                ..PLAIN
            },
        ),
        (
            "metal",
            Material {
                metallic: 1.0,
                ..PLAIN
            },
        ),
        (
            "rough metal",
            Material {
                metallic: 1.0,
                alpha: 1.0,
                ..PLAIN
            },
        ),
        (
            "half metal",
            Material {
                metallic: 0.5,
                alpha: 0.5,
                ..PLAIN
            },
        ),
        (
            "thin glass",
            Material {
                transmission: 1.0,
                ..PLAIN
            },
        ),
        ("glass", thick),
        (
            "glass from within",
            Material {
                eta: 1.0 / 1.5,
                ..thick
            },
        ),
        (
            "rough glass",
            Material {
                alpha: 1.0,
                ..thick
            },
        ),
        (
            "half glass",
            Material {
                transmission: 0.5,
                ..thick
            },
        ),
        ("coated", coated),
        (
            "coated metal",
            Material {
                metallic: 1.0,
                coat_alpha: ALPHA_FLOOR,
                ..coated
            },
        ),
        (
            "coated glass",
            Material {
                coat: 0.5,
                coat_alpha: 0.3,
                ..thick
            },
        ),
        (
            "velvet",
            Material {
                sheen: [1.0; 3],
                sheen_roughness: 0.3,
                ..PLAIN
            },
        ),
        (
            "fine velvet",
            Material {
                sheen: [1.0; 3],
                ..PLAIN
            },
        ),
        (
            "rough velvet",
            Material {
                sheen: [1.0, 0.5, 0.0],
                sheen_roughness: 1.0,
                ..PLAIN
            },
        ),
        ("all", all),
        ("all, thick", Material { thin: false, ..all }),
        (
            "all, from within",
            Material {
                thin: false,
                eta: 1.0 / 1.5,
                ..all
            },
        ),
        (
            "black",
            Material {
                base: [0.0; 3],
                specular: 0.0,
                ..PLAIN
            },
        ),
    ]
}

#[test]
fn a_furnace_never_gains_and_white_materials_keep_their_light() {
    let materials = materials();
    let comparisons = materials.len() * COSINES.len();
    for (name, material) in materials {
        for cos in COSINES {
            let eta = if material.thin {
                1.0
            } else {
                f64::from(material.eta)
            };
            let albedo = furnace(&material.lanes(), direction(cos, 0.3), eta, comparisons);
            // Some forty roundings in a mixture's weight.
            let bound = albedo.half + 40.0 * ROUNDING;
            assert!(albedo.most <= 1.0 + bound, "{name} from {cos}: {albedo:?}");
            let white = material.base == [1.0; 3] && material.sheen[0] == material.sheen[2];
            if white {
                assert!(
                    albedo.least >= 0.98 - bound,
                    "{name} from {cos}: {albedo:?}"
                );
            }
        }
    }
}

#[test]
fn samples_follow_their_pdf() {
    let mut suite = Suite::default();
    for (name, material) in materials() {
        if material.alpha < 0.1 || (material.coat > 0.0 && material.coat_alpha < 0.1) {
            continue;
        }
        for cos in [0.05, 0.3, 0.9] {
            let o = rounded(direction(cos, 0.7));
            let down = Map::Facets {
                o,
                alpha: [f64::from(material.alpha); 2],
                eta: f64::from(material.eta),
            };
            let down = if material.thin { Map::Even } else { down };
            let name = format!("{name} from {cos}");
            chi_square(&mut suite, &name, &material.lanes(), o, [Map::Even, down]);
        }
    }
    suite.finish();
}

#[test]
fn the_ends_of_the_unit_cube_and_grazing_directions_are_sound() {
    let index_one = Material {
        transmission: 1.0,
        thin: false,
        eta: 1.0,
        ..PLAIN
    };
    let narrow = Material {
        transmission: 0.7,
        thin: false,
        alpha: ALPHA_FLOOR,
        ..PLAIN
    };
    let more = [("index 1 glass", index_one), ("polished glass", narrow)];
    for (name, material) in materials().into_iter().chain(more) {
        for cos in COSINES.into_iter().chain([1e-7]) {
            let o = rounded(direction(cos, 0.7));
            corners(name, &material.lanes(), o);
            // The same code says both, of the same directions: the weight's own roundings.
            consistent(name, &material.lanes(), o, |_, _| 4.0 * ROUNDING);
        }
    }
}

fn lane(x: Fx) -> f64 {
    f64::from(x.as_array()[0])
}

/// The model as its pages write it, in f64, for reflected directions; albedos from the tables.
fn twin(m: &Material, o: [f64; 3], i: [f64; 3], c: usize) -> f64 {
    let (cos, alpha) = (Fx::splat(o[2] as f32), Fx::splat(m.alpha));
    let inside = m.eta < 1.0 && !m.thin;
    let h = twin::normalized(twin::sum(o, i));
    let near = dot(o, h);
    let eta = f64::from(m.eta);
    let schlick = |f0: f64, f90: f64, cos: f64| f0 + (f90 - f0) * (1.0 - cos).max(0.0).powi(5);
    let facets = |alpha: f32| twin::reflection(o, i, [f64::from(alpha); 2]).0;
    let [base, specular, metallic, transmission] =
        [m.base[c], m.specular, m.metallic, m.transmission].map(f64::from);

    // From outside in.
    let kept = |alpha: Fx| 1.0 - lane(ReflectionEnergy::table().lost(cos, alpha));
    let steep = |alpha: Fx| lane(SchlickEnergy::table().albedo(cos, alpha));
    let layer = |f0: f64, f90: f64, alpha: Fx| {
        let e = kept(alpha);
        f0 * e + (f90 - f0) * steep(alpha).min(e)
    };
    let coat = if inside { 0.0 } else { f64::from(m.coat) };
    let coat_lobe = coat * schlick(0.04, 1.0, near) * facets(m.coat_alpha);
    let below_coat = 1.0 - coat * layer(0.04, 1.0, Fx::splat(m.coat_alpha));
    let sheen = m.sheen.map(|s| if inside { 0.0 } else { f64::from(s) });
    let cloth = Fx::splat(m.sheen_roughness);
    let exponent = 1.0 / f64::from(m.sheen_roughness).powi(2);
    let sin = (1.0 - h[2] * h[2]).max(0.0).sqrt();
    let density = (2.0 + exponent) * sin.powf(exponent) / (2.0 * PI);
    let visible = 1.0 / (4.0 * (o[2] + i[2] - o[2] * i[2]));
    let sheen_lobe = sheen[c] * density * visible * i[2] * lane(SheenEnergy::table().scale(cloth));
    let most = sheen.into_iter().fold(0.0, f64::max);
    let below_sheen = 1.0 - most * lane(SheenEnergy::table().albedo(cos, cloth));

    let metal = schlick(base, 1.0, near) * (1.0 + base * (1.0 - kept(alpha)) / kept(alpha));
    let normal = ((eta - 1.0) / (eta + 1.0)).powi(2);
    let f0 = m
        .specular_color
        .map(|s| (normal * f64::from(s)).min(1.0) * specular);
    let f0_most = f0.into_iter().fold(0.0, f64::max);
    let under = (1.0 - layer(f0_most, specular, alpha)).max(0.0);
    let opaque = schlick(f0[c], specular, near) * facets(m.alpha) + base / PI * i[2] * under;
    let glass = RoughDielectric {
        surface: SmoothDielectric {
            eta: Fx::splat(m.eta),
            thin: mask(m.thin),
            reflection: Vec3x::splat(m.specular_color.map(|s| (s * m.specular).min(1.0))),
            transmission: Vec3x::splat(m.base),
        },
        alpha,
        energy: TransmissionEnergy::table(),
        compensated: mask(true),
    };
    let glass = f64::from(glass.evaluate(splat(o), splat(i)).value.lane(0)[c]);
    let dielectric = transmission * glass + (1.0 - transmission) * opaque;
    let inner = metallic * metal * facets(m.alpha) + (1.0 - metallic) * dielectric;
    coat_lobe + below_coat * (sheen_lobe + below_sheen * inner)
}

#[test]
fn lanes_agree_with_the_formula_in_f64() {
    let mut source = Source(61);
    for (name, material) in materials() {
        for _ in 0..300 {
            let up = |w: [f32; 3]| rounded([w[0], w[1], w[2].abs().max(0.02)].map(f64::from));
            let (o, i) = (up(source.direction()), up(source.direction()));
            let value = material.lanes().evaluate(splat(o), splat(i)).value.lane(0);
            let h: [f64; 3] = std::array::from_fn(|c| o[c] + i[c]);
            let length = dot(h, h).sqrt();
            // As for metals, by the narrowest lobe there is; the sheen's logarithm is taken 1 / 2
            // roughness^2 times, its argument being off by twice what the half vector is over its
            // sine; and whatever is mixed rounds like 1.
            let narrow = if material.coat > 0.0 {
                material.alpha.min(material.coat_alpha)
            } else {
                material.alpha
            };
            let sin = h[0].hypot(h[1]) / length;
            let exponent = 0.5 / f64::from(material.sheen_roughness).powi(2);
            let bound = 64.0 + (8.0 / f64::from(narrow) + 8.0 * exponent / sin) / length;
            // And the logarithm itself, of at most 69, by wide's roundings.
            let bound = (bound + 200.0 * exponent) * ROUNDING;
            for c in 0..3 {
                let twin = twin(&material, o, i, c);
                let off = (f64::from(value[c]) - twin).abs();
                assert!(
                    off <= bound * twin + 4.0 * ROUNDING * i[2],
                    "{name} {o:?} {i:?}: {off:e} {twin:e}"
                );
            }
        }
    }
}

#[test]
fn no_weight_is_above_ten() {
    let mut source = Source(67);
    for (name, material) in materials() {
        let mut most = 0f32;
        for cos in COSINES {
            for _ in 0..1000 {
                let u = std::array::from_fn(|_| source.unit_lanes());
                let drawn = material.lanes().sample(splat(direction(cos, 1.0)), u);
                let weight = drawn.weight.max_component();
                most = weight.to_array().into_iter().fold(most, f32::max);
            }
        }
        assert!(most <= 10.0, "{name}: {most}");
    }
}

/// White metal reflects everything at each facet: without compensation its value is that of the facets
/// alone.
#[test]
fn without_compensation_metal_reflects_once() {
    let mut source = Source(77);
    for alpha in [0.05, 0.3, 1.0] {
        let metal = Principled {
            compensated: mask(false),
            ..Material {
                metallic: 1.0,
                alpha,
                ..PLAIN
            }
            .lanes()
        };
        for _ in 0..200 {
            let up = |mut w: [f32; 3]| {
                w[2] = w[2].abs().max(0.05);
                rounded(w.map(f64::from))
            };
            let (o, i) = (up(source.direction()), up(source.direction()));
            let value = metal.evaluate(splat(o), splat(i)).value.x;
            let expected = twin::reflection(o, i, [f64::from(alpha); 2]).0;
            // Half a rounding of directions moves the half vector by that over its length, and the
            // density of facets by up to twice that over their width.
            let h = twin::sum(o, i);
            let bound = (64.0 + 4.0 / (f64::from(alpha) * dot(h, h).sqrt())) * ROUNDING;
            assert_close("metal", lane(value), expected, bound);
        }
    }
}
