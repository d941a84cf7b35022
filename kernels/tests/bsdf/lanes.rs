//! A lane's result is its own: what its neighbours hold, or where in the vector it stands, does not
//! change a bit of it. Images that do not depend on how paths are queued rest on this.

use crate::common::Source;
use huygens_kernels::bsdf::charlie::ROUGHNESS_FLOOR;
use huygens_kernels::bsdf::{
    ALPHA_FLOOR, Bsdf, Principled, ReflectionEnergy, RoughConductor, RoughDielectric, RoughDiffuse,
    SmoothConductor, SmoothDielectric, TransmissionEnergy,
};
use huygens_kernels::lanes::{Fx, LANES, Mask};
use huygens_kernels::vec3::Vec3x;

/// What lies in the padding of a queue is unspecified: it may come out as anything, but a table must
/// not be read outside, in whatever lane.
fn assert_no_panic<B: Bsdf>(make: impl Fn(&Columns) -> B) {
    for value in [
        f32::NAN,
        f32::INFINITY,
        f32::NEG_INFINITY,
        f32::MAX,
        -1.0,
        f32::MIN_POSITIVE,
    ] {
        let bsdf = make(&Columns([[value; LANES]; 17]));
        for direction in [[0.6, 0.0, 0.8], [value; 3]] {
            let w = Vec3x::splat(direction);
            let up = Vec3x::splat([0.0, 0.6, 0.8]);
            for u in [0.0, 0.5, value] {
                bsdf.evaluate(w, up);
                bsdf.evaluate(up, w);
                bsdf.sample(w, [Fx::splat(u); 3]);
            }
        }
    }
}

/// Columns of parameters for `LANES` surfaces, each drawn for itself.
struct Columns([[f32; LANES]; 17]);

impl Columns {
    /// Half of the parameters of a surface are at the ends of their domain.
    fn draw(source: &mut Source) -> Self {
        let mut one = || match source.unit() {
            u if u < 0.25 => 0.0,
            u if u < 0.5 => 1.0,
            _ => source.unit(),
        };
        Self(std::array::from_fn(|_| std::array::from_fn(|_| one())))
    }

    /// The same with every lane holding what lane `lane` holds.
    fn spread(&self, lane: usize) -> Self {
        Self(self.0.map(|column| [column[lane]; LANES]))
    }

    fn at(&self, column: usize) -> Fx {
        Fx::new(self.0[column])
    }

    fn rgb(&self, column: usize) -> Vec3x {
        Vec3x::new(self.at(column), self.at(column + 1), self.at(column + 2))
    }

    fn width(&self, column: usize) -> Fx {
        self.at(column).fast_max(Fx::splat(ALPHA_FLOOR))
    }

    /// 0.5, 1, 1.5 and what is between.
    fn eta(&self, column: usize) -> Fx {
        self.at(column) + Fx::splat(0.5)
    }

    fn yes(&self, column: usize) -> Mask {
        self.at(column).simd_gt(Fx::splat(0.5))
    }

    fn glass(&self) -> SmoothDielectric {
        SmoothDielectric {
            eta: self.eta(0),
            thin: self.yes(1),
            reflection: self.rgb(2),
            transmission: self.rgb(5),
        }
    }
}

/// Value, pdf, weight and direction as bits, of one lane.
fn bits(bsdf: &impl Bsdf, o: Vec3x, i: Vec3x, u: [Fx; 3], lane: usize) -> Vec<u32> {
    let evaluated = bsdf.evaluate(o, i);
    let drawn = bsdf.sample(o, u);
    let mut all = vec![evaluated.pdf.as_array()[lane], drawn.pdf.as_array()[lane]];
    for v in [evaluated.value, drawn.weight, drawn.direction] {
        all.extend(v.lane(lane));
    }
    all.iter().map(|x| x.to_bits()).collect()
}

fn assert_alone<B: Bsdf>(name: &str, make: impl Fn(&Columns) -> B) {
    assert_no_panic(&make);
    let mut source = Source(71);
    for _ in 0..200 {
        let columns = Columns::draw(&mut source);
        let up = |w: [f32; 3]| [w[0], w[1], w[2].abs().max(1e-3)];
        let o: [[f32; 3]; LANES] = std::array::from_fn(|_| up(source.direction()));
        let i: [[f32; 3]; LANES] = std::array::from_fn(|_| source.direction());
        let u: [Fx; 3] = std::array::from_fn(|_| source.unit_lanes());
        let vector = |w: [[f32; 3]; LANES]| {
            let column = |c: usize| Fx::new(std::array::from_fn(|l| w[l][c]));
            Vec3x::new(column(0), column(1), column(2))
        };
        let together = make(&columns);
        for lane in 0..LANES {
            let beside = bits(&together, vector(o), vector(i), u, lane);
            let alone = bits(
                &make(&columns.spread(lane)),
                Vec3x::splat(o[lane]),
                Vec3x::splat(i[lane]),
                u.map(|u| Fx::splat(u.as_array()[lane])),
                (lane + 3) % LANES,
            );
            assert_eq!(beside, alone, "{name}, lane {lane}");
        }
    }
}

#[test]
fn diffuse() {
    assert_alone("rough diffuse", |c| RoughDiffuse {
        albedo: c.rgb(0),
        roughness: c.at(3),
    });
}

#[test]
fn conductors() {
    assert_alone("smooth conductor", |c| SmoothConductor {
        eta: c.rgb(0),
        k: c.rgb(3),
    });
    assert_alone("rough conductor", |c| RoughConductor {
        eta: c.rgb(0),
        k: c.rgb(3),
        mean: c.rgb(6),
        // In some lanes isotropic.
        alpha: [c.width(9), c.yes(11).select(c.width(9), c.width(10))],
        energy: ReflectionEnergy::table(),
    });
}

#[test]
fn dielectrics() {
    assert_alone("smooth dielectric", Columns::glass);
    assert_alone("rough dielectric", |c| RoughDielectric {
        surface: c.glass(),
        alpha: c.width(8),
        energy: TransmissionEnergy::table(),
        compensated: c.yes(9),
    });
}

#[test]
fn principled() {
    assert_alone("principled", |c| Principled {
        base: c.rgb(0),
        metallic: c.at(3),
        alpha: c.width(4),
        eta: c.eta(5),
        specular: c.at(6),
        specular_color: c.rgb(7),
        transmission: c.at(10),
        thin: c.yes(11),
        coat: c.at(12),
        coat_alpha: c.width(13),
        sheen: Vec3x::new(c.at(14), c.at(14), Fx::ZERO),
        sheen_roughness: c.at(15).fast_max(Fx::splat(ROUGHNESS_FLOOR)),
        compensated: c.yes(16),
    });
}
