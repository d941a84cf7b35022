//! A clear sky and its sun (A. Preetham, P. Shirley, B. Smits, "A Practical Analytic Model for
//! Daylight", SIGGRAPH 1999): the sky as an environment map, the sun as a disc.
//!
//! *Sky*: luminance `Y` and chromaticities `x`, `y` each follow R. Perez' five-parameter formula in
//! the angles from the zenith (`theta`) and from the sun (`gamma`),
//!
//! ```text
//! F(theta, gamma) = (1 + A e^(B / cos theta)) (1 + C e^(D gamma) + E cos^2 gamma)
//! ```
//!
//! times their values at the zenith, by the paper's appendix A.2.
//!
//! *Sun*: a black body of 5778 K, seen through Rayleigh scattering and aerosols (appendix A.1). Ozone
//! and water vapour, which take some 5% of the visible light, are left out: they need tables.
//!
//! *Units*: candela become watts by 179 lm/W, the efficacy of white light in *Radiance* (G. Ward, "The
//! RADIANCE Lighting Simulation and Rendering System", SIGGRAPH 1994), so a radiance's relative
//! luminance is its luminance in cd/m^2 over 179.

use super::light::{Environment, Light, LightKind, row_cosine};
use glam::{DMat3, DVec3};
use std::f64::consts::{PI, TAU};

/// Lumens of a watt.
const EFFICACY: f64 = 179.0;
/// Half the angle of the sun's disc, degrees.
const SUN_HALF_ANGLE: f64 = 0.2665;
/// Texels across the map; half as many down.
const WIDTH: u32 = 1024;

/// What a file says of the day.
#[derive(Clone, Copy, Debug)]
pub(super) struct Daylight {
    /// Haze: 2 (very clear) to 10 (hazy).
    pub(super) turbidity: f64,
    /// Unit vector to the sun in the map's frame, y up; above the horizon.
    pub(super) sun: DVec3,
    /// Reflectance of the ground.
    pub(super) ground: DVec3,
    /// What all radiances are multiplied with.
    pub(super) scale: DVec3,
}

/// Linear Rec. 709 of CIE XYZ, negative components cut: colours beyond its gamut.
fn rec709(xyz: DVec3) -> DVec3 {
    let matrix = DMat3::from_cols(
        DVec3::new(3.240_454_2, -0.969_266_0, 0.055_643_4),
        DVec3::new(-1.537_138_5, 1.876_010_8, -0.204_025_9),
        DVec3::new(-0.498_531_4, 0.041_556_0, 1.057_225_2),
    );
    (matrix * xyz).max(DVec3::ZERO)
}

/// Perez' formula with the coefficients `A` to `E`.
fn perez([a, b, c, d, e]: [f64; 5], cos_theta: f64, gamma: f64) -> f64 {
    let glow = 1.0 + c * (d * gamma).exp() + e * gamma.cos().powi(2);
    (1.0 + a * (b / cos_theta).exp()) * glow
}

impl Daylight {
    fn cos_sun(&self) -> f64 {
        self.sun.y
    }

    /// Coefficients of Perez' formula for `Y`, `x` and `y`.
    fn coefficients(&self) -> [[f64; 5]; 3] {
        let t = self.turbidity;
        let linear = |rows: [[f64; 2]; 5]| rows.map(|[slope, at_0]| slope * t + at_0);
        [
            linear([
                [0.1787, -1.4630],
                [-0.3554, 0.4275],
                [-0.0227, 5.3251],
                [0.1206, -2.5771],
                [-0.0670, 0.3703],
            ]),
            linear([
                [-0.0193, -0.2592],
                [-0.0665, 0.0008],
                [-0.0004, 0.2125],
                [-0.0641, -0.8989],
                [-0.0033, 0.0452],
            ]),
            linear([
                [-0.0167, -0.2608],
                [-0.0950, 0.0092],
                [-0.0079, 0.2102],
                [-0.0441, -1.6537],
                [-0.0109, 0.0529],
            ]),
        ]
    }

    /// `Y` (cd/m^2), `x` and `y` at the zenith.
    fn zenith(&self) -> [f64; 3] {
        let (t, theta) = (self.turbidity, self.cos_sun().clamp(-1.0, 1.0).acos());
        let chi = (4.0 / 9.0 - t / 120.0) * (PI - 2.0 * theta);
        let luminance = (4.0453 * t - 4.9710) * chi.tan() - 0.2155 * t + 2.4192;
        let cubic = |rows: [[f64; 4]; 3]| -> f64 {
            let in_theta = rows.map(|r| ((r[0] * theta + r[1]) * theta + r[2]) * theta + r[3]);
            (in_theta[0] * t + in_theta[1]) * t + in_theta[2]
        };
        let x = cubic([
            [0.001_66, -0.003_75, 0.002_09, 0.0],
            [-0.029_03, 0.063_77, -0.032_02, 0.003_94],
            [0.116_93, -0.211_96, 0.060_52, 0.258_86],
        ]);
        let y = cubic([
            [0.002_75, -0.006_10, 0.003_17, 0.0],
            [-0.042_14, 0.089_70, -0.041_53, 0.005_16],
            [0.153_46, -0.267_56, 0.066_70, 0.266_88],
        ]);
        [1000.0 * luminance, x, y]
    }

    /// Radiance of the sky from `direction`, above the horizon, before `scale`.
    fn sky(&self, direction: DVec3) -> DVec3 {
        let gamma = direction.dot(self.sun).clamp(-1.0, 1.0).acos();
        let theta_sun = self.cos_sun().clamp(-1.0, 1.0).acos();
        let (coefficients, zenith) = (self.coefficients(), self.zenith());
        let [luminance, x, y] = std::array::from_fn(|k| {
            let at = |cos, gamma| perez(coefficients[k], cos, gamma);
            zenith[k] * at(direction.y, gamma) / at(1.0, theta_sun)
        });
        let xyz = DVec3::new(x / y, 1.0, (1.0 - x - y) / y) * luminance;
        rec709(xyz) / EFFICACY
    }

    /// Irradiance by the sun of a surface that faces it, before `scale`.
    fn sun(&self) -> DVec3 {
        let theta = self.cos_sun().clamp(-1.0, 1.0).acos().to_degrees();
        // Relative optical mass of the air: F. Kasten, 1965.
        let mass = 1.0 / (self.cos_sun() + 0.15 * (93.885 - theta).powf(-1.253));
        let aerosol = 0.046_08 * self.turbidity - 0.045_86;
        let transmittance = |micron: f64| {
            let rayleigh = 0.008_735 * micron.powf(-4.08);
            (-(rayleigh + aerosol * micron.powf(-1.3)) * mass).exp()
        };
        let half = SUN_HALF_ANGLE.to_radians();
        let projected = PI * half.sin().powi(2);
        let step = 1.0;
        let spectrum = (0..471).map(|k| 360.0 + step * f64::from(k));
        let xyz: DVec3 = spectrum
            .map(|nm| observer(nm) * (black_body(nm) * transmittance(nm / 1000.0) * step))
            .sum();
        rec709(xyz * 683.0) * (projected / EFFICACY)
    }

    /// The sky above and the ground below, and the sun. `frame` is that of the map in the world.
    pub(super) fn compile(&self, frame: [[f32; 3]; 3]) -> (Environment, Light) {
        let (width, height) = (WIDTH as usize, WIDTH as usize / 2);
        let direct = self.sun();
        let mut texels = vec![[0.0f32; 3]; width * height];
        let mut irradiance = direct * self.cos_sun();
        for row in 0..height / 2 {
            let (theta, strip) = (
                PI * (row as f64 + 0.5) / height as f64,
                row_cosine(row, height) - row_cosine(row + 1, height),
            );
            for column in 0..width {
                // At the middle of the map -z, to the right of it +x.
                let phi = TAU * ((column as f64 + 0.5) / width as f64 - 0.5);
                let direction = DVec3::new(
                    theta.sin() * phi.sin(),
                    theta.cos(),
                    -theta.sin() * phi.cos(),
                );
                let radiance = self.sky(direction);
                irradiance += radiance * (direction.y * strip * TAU / width as f64);
                texels[row * width + column] = (radiance * self.scale).as_vec3().to_array();
            }
        }
        let ground = self.ground * irradiance / PI * self.scale;
        texels[width * height / 2..].fill(ground.as_vec3().to_array());
        let map = Environment {
            width: WIDTH,
            height: WIDTH / 2,
            texels,
            frame,
        };
        let axes = frame.map(|a| DVec3::from_array(a.map(f64::from)));
        let from = axes[0] * self.sun.x + axes[1] * self.sun.y + axes[2] * self.sun.z;
        let sun = Light {
            name: "sun".to_owned(),
            kind: LightKind::Distant {
                from: from.normalize().as_vec3().to_array(),
                irradiance: (direct * self.scale).as_vec3().to_array(),
                half_angle: SUN_HALF_ANGLE,
            },
        };
        (map, sun)
    }
}

/// CIE 1931 colour matching functions at a wavelength in nm: C. Wyman, P. Sloan, P. Shirley, "Simple
/// Analytic Approximations to the CIE XYZ Color Matching Functions", JCGT 2(2), 2013.
fn observer(nm: f64) -> DVec3 {
    let lobe = |height: f64, middle: f64, below: f64, above: f64| {
        let t = (nm - middle) / if nm < middle { below } else { above };
        height * (-0.5 * t * t).exp()
    };
    DVec3::new(
        lobe(1.056, 599.8, 37.9, 31.0)
            + lobe(0.362, 442.0, 16.0, 26.7)
            + lobe(-0.065, 501.1, 20.4, 26.2),
        lobe(0.821, 568.8, 46.9, 40.5) + lobe(0.286, 530.9, 16.3, 31.1),
        lobe(1.217, 437.0, 11.8, 36.0) + lobe(0.681, 459.0, 26.0, 13.8),
    )
}

/// Planck's radiance of the sun's surface, 5778 K, in W/m^2/sr/nm.
fn black_body(nm: f64) -> f64 {
    const H: f64 = 6.626_070_15e-34;
    const C: f64 = 299_792_458.0;
    const K: f64 = 1.380_649e-23;
    let metres = nm * 1e-9;
    let x = H * C / (metres * K * 5778.0);
    2.0 * H * C * C / metres.powi(5) / x.exp_m1() * 1e-9
}

#[cfg(test)]
mod tests {
    use super::*;

    fn day(turbidity: f64, elevation: f64) -> Daylight {
        let (sin, cos) = elevation.to_radians().sin_cos();
        Daylight {
            turbidity,
            sun: DVec3::new(cos, sin, 0.0),
            ground: DVec3::splat(0.2),
            scale: DVec3::ONE,
        }
    }

    /// Illuminance in lux.
    fn lux(irradiance: DVec3) -> f64 {
        EFFICACY * irradiance.dot(DVec3::new(0.2126, 0.7152, 0.0722))
    }

    #[test]
    fn the_sun_is_as_bright_as_it_is() {
        // Outside the atmosphere 128 to 134 klx (CIE; a black body has a little less blue).
        let half = SUN_HALF_ANGLE.to_radians();
        let luminance: f64 = (0..471)
            .map(|k| 360.0 + f64::from(k))
            .map(|nm| 683.0 * observer(nm).y * black_body(nm))
            .sum();
        let outside = luminance * PI * half.sin().powi(2);
        assert!((120e3..140e3).contains(&outside), "{outside}");
        // On the ground 100 klx and some at noon (IES), a few near the horizon.
        let noon = lux(day(2.5, 80.0).sun());
        assert!((85e3..115e3).contains(&noon), "{noon}");
        let low = day(2.5, 3.0).sun();
        assert!((1e3..30e3).contains(&lux(low)), "{low}");
        assert!(low.x > low.y && low.y > low.z, "it sets red: {low}");
    }

    #[test]
    fn a_clear_sky_is_blue_and_gives_tens_of_thousands_of_lux() {
        let day = day(2.5, 45.0);
        let away = DVec3::new(-0.6, 0.8, 0.0);
        let colour = day.sky(away);
        assert!(colour.z > colour.y && colour.y > colour.x, "{colour}");
        let (map, _) = day.compile([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
        // The ground's radiance tells the irradiance: sky, and the sun's times its height.
        let ground = DVec3::from_array(map.texels[map.texels.len() - 1].map(f64::from));
        let whole = lux(ground * PI / 0.2);
        let sky = whole - lux(day.sun() * day.sun.y);
        // Clear skies are measured to give 10 to 20 klx; this model is known to be brighter (G. Zotti,
        // A. Wilkie, W. Purgathofer, WSCG 2007). What this guards against is a wrong unit.
        assert!((5e3..50e3).contains(&sky), "{sky}");
    }

    #[test]
    fn the_map_is_brightest_where_the_sun_stands() {
        let day = day(4.0, 30.0);
        // A frame that is turned and lies on its side.
        let frame = [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let (map, sun) = day.compile(frame);
        let bright = |k: &usize| map.texels[*k].iter().sum::<f32>();
        let brightest = (0..map.texels.len())
            .max_by(|a, b| bright(a).total_cmp(&bright(b)))
            .expect("texels");
        let (x, y) = (brightest % WIDTH as usize, brightest / WIDTH as usize);
        // +x lies three quarters across; 30 degrees up are a third of the way down.
        assert!((x as f64 / f64::from(WIDTH) - 0.75).abs() < 0.01, "{x}");
        assert!(
            (y as f64 / f64::from(WIDTH / 2) - 1.0 / 3.0).abs() < 0.01,
            "{y}"
        );
        let LightKind::Distant { from, .. } = sun.kind else {
            panic!("the sun is far away");
        };
        // cos 30 along the map's x, which is the world's z; sin 30 along its y, the world's x.
        let expected = [0.5, 0.0, 0.75f32.sqrt()];
        for (found, expected) in from.into_iter().zip(expected) {
            assert!((found - expected).abs() < 1e-6);
        }
    }

    #[test]
    fn the_zenith_is_that_of_the_formula() {
        for (turbidity, elevation) in [(2.0, 60.0), (5.0, 20.0), (10.0, 89.0)] {
            let day = day(turbidity, elevation);
            let luminance = EFFICACY * day.sky(DVec3::Y).dot(DVec3::new(0.2126, 0.7152, 0.0722));
            let [expected, ..] = day.zenith();
            // The matrix to Rec. 709 has seven digits, these weights four.
            assert!(
                (luminance / expected - 1.0).abs() < 1e-3,
                "{luminance} {expected}"
            );
        }
    }
}
