//! One wavelength for the oracle: drawn evenly over the spectrum, and what it is worth in red, green and
//! blue.
//!
//! A whole sample is of one wavelength, whether it meets glass that disperses or not: what depends on no
//! wavelength is then weighed too, by weights whose mean is 1.

use super::random::uniform;
use glam::DVec3;
use rand_pcg::rand_core::Rng;
use std::sync::LazyLock;

/// The visible spectrum, in nanometres, as the renderer has it.
const RANGE: [f64; 2] = [380.0, 730.0];

/// A wavelength.
pub(super) struct Wavelength {
    pub(super) nanometres: f64,
    pub(super) weight: DVec3,
}

/// What makes the means of the matching functions over the spectrum 1.
static SCALE: LazyLock<DVec3> = LazyLock::new(|| {
    let steps = 20_000;
    let at = |k: i32| RANGE[0] + (RANGE[1] - RANGE[0]) * (f64::from(k) + 0.5) / f64::from(steps);
    let sum: DVec3 = (0..steps).map(|k| matching(at(k))).sum();
    f64::from(steps) / sum
});

pub(super) fn draw(rng: &mut impl Rng) -> Wavelength {
    let nanometres = RANGE[0] + (RANGE[1] - RANGE[0]) * uniform(rng);
    Wavelength {
        nanometres,
        weight: matching(nanometres) * *SCALE,
    }
}

/// The matching functions of sRGB's primaries: CIE 1931 in the fit of C. Wyman, P. Sloan, P. Shirley
/// (JCGT 2(2), 2013, equation 4), by IEC 61966-2-1's matrix.
fn matching(nm: f64) -> DVec3 {
    let lobe = |scale: f64, mean: f64, below: f64, above: f64| {
        let t = (nm - mean) * if nm < mean { below } else { above };
        scale * (-0.5 * t * t).exp()
    };
    let x = lobe(0.362, 442.0, 0.0624, 0.0374) + lobe(1.056, 599.8, 0.0264, 0.0323)
        - lobe(0.065, 501.1, 0.0490, 0.0382);
    let y = lobe(0.821, 568.8, 0.0213, 0.0247) + lobe(0.286, 530.9, 0.0613, 0.0322);
    let z = lobe(1.217, 437.0, 0.0845, 0.0278) + lobe(0.681, 459.0, 0.0385, 0.0725);
    DVec3::new(
        3.240_454_2 * x - 1.537_138_5 * y - 0.498_531_4 * z,
        -0.969_266_0 * x + 1.876_010_8 * y + 0.041_556_0 * z,
        0.055_643_4 * x - 0.204_025_9 * y + 1.057_225_2 * z,
    )
}
