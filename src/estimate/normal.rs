//! Levels of significance: the quantiles of the normal distribution, and Šidák's correction.

/// The `z` below which a standard normal variable lies with probability `p`; infinite at 0 and 1,
/// NaN outside. Relative error about 1e-16.
///
/// M. J. Wichura, "Algorithm AS 241: The Percentage Points of the Normal Distribution", Applied
/// Statistics 37(3), 1988, routine PPND16.
#[must_use]
pub fn normal_quantile(p: f64) -> f64 {
    let q = p - 0.5;
    if q.abs() <= 0.425 {
        let r = 0.180625 - q * q;
        return q * ratio(&CENTRE, r);
    }
    let tail = if q < 0.0 { p } else { 1.0 - p };
    if tail == 0.0 {
        return f64::INFINITY.copysign(q);
    }
    let r = (-tail.ln()).sqrt();
    let z = if r <= 5.0 {
        ratio(&MIDDLE, r - 1.6)
    } else {
        ratio(&FAR, r - 5.0)
    };
    z.copysign(q)
}

/// The significance of each of `tests` independent tests that together reject a true hypothesis
/// with probability `significance`: `1 - (1 - significance)^(1 / tests)` (Z. Šidák, JASA 62, 1967).
/// Also safe for tests that depend on one another as normal variables do.
#[must_use]
pub fn sidak(significance: f64, tests: usize) -> f64 {
    -((-significance).ln_1p() / tests as f64).exp_m1()
}

/// Numerator over denominator, lowest power first.
fn ratio(coefficients: &[[f64; 8]; 2], r: f64) -> f64 {
    let horner = |c: &[f64; 8]| c.iter().rev().fold(0.0, |sum, c| sum * r + c);
    horner(&coefficients[0]) / horner(&coefficients[1])
}

const CENTRE: [[f64; 8]; 2] = [
    [
        3.387_132_872_796_366_608_0,
        1.331_416_678_917_843_774_5e2,
        1.971_590_950_306_551_442_7e3,
        1.373_169_376_550_946_112_5e4,
        4.592_195_393_154_987_145_7e4,
        6.726_577_092_700_870_085_3e4,
        3.343_057_558_358_812_810_5e4,
        2.509_080_928_730_122_672_7e3,
    ],
    [
        1.0,
        4.231_333_070_160_091_125_2e1,
        6.871_870_074_920_579_083_0e2,
        5.394_196_021_424_751_107_7e3,
        2.121_379_430_158_659_586_7e4,
        3.930_789_580_009_271_061_0e4,
        2.872_908_573_572_194_267_4e4,
        5.226_495_278_852_854_561_0e3,
    ],
];

const MIDDLE: [[f64; 8]; 2] = [
    [
        1.423_437_110_749_683_577_34,
        4.630_337_846_156_545_295_90,
        5.769_497_221_460_691_405_50,
        3.647_848_324_763_204_605_04,
        1.270_458_252_452_368_382_58,
        2.417_807_251_774_506_117_70e-1,
        2.272_384_498_926_918_458_33e-2,
        7.745_450_142_783_414_076_40e-4,
    ],
    [
        1.0,
        2.053_191_626_637_758_821_87,
        1.676_384_830_183_803_849_40,
        6.897_673_349_851_000_045_50e-1,
        1.481_039_764_274_800_745_90e-1,
        1.519_866_656_361_645_719_66e-2,
        5.475_938_084_995_344_946_00e-4,
        1.050_750_071_644_416_843_24e-9,
    ],
];

const FAR: [[f64; 8]; 2] = [
    [
        6.657_904_643_501_103_777_20,
        5.463_784_911_164_114_369_90,
        1.784_826_539_917_291_335_80,
        2.965_605_718_285_048_912_30e-1,
        2.653_218_952_657_612_309_30e-2,
        1.242_660_947_388_078_438_60e-3,
        2.711_555_568_743_487_578_15e-5,
        2.010_334_399_292_288_132_65e-7,
    ],
    [
        1.0,
        5.998_322_065_558_879_376_90e-1,
        1.369_298_809_227_358_053_10e-1,
        1.487_536_129_085_061_485_25e-2,
        7.868_691_311_456_132_591_00e-4,
        1.846_318_317_510_054_681_80e-5,
        1.421_511_758_316_445_888_70e-7,
        2.044_263_103_389_939_785_64e-15,
    ],
];

#[cfg(test)]
mod tests {
    use super::*;

    /// The lower tail at `z <= 0`: by the series of odd double factorials near 0, by Laplace's
    /// continued fraction beyond (Abramowitz and Stegun, 26.2.11 and 26.2.14).
    fn lower_tail(z: f64) -> f64 {
        let x = -z;
        let density = (-0.5 * x * x).exp() / std::f64::consts::TAU.sqrt();
        if x < 2.0 {
            let mut term = x;
            let mut sum = 0.0;
            for n in 1..60 {
                sum += term;
                term *= x * x / f64::from(2 * n + 1);
            }
            0.5 - density * sum
        } else {
            density / (1..400).rev().fold(x, |rest, k| x + f64::from(k) / rest)
        }
    }

    #[test]
    fn quantile_inverts_the_distribution() {
        for exponent in 1..=250 {
            for p in [
                (-f64::from(exponent)).exp2(),
                0.5 - 0.4 * f64::from(exponent) / 250.0,
            ] {
                let z = normal_quantile(p);
                // d ln p = at most (1 + z^2) d ln z; some dozen roundings in either function.
                let bound = 32.0 * (1.0 + z * z) * f64::EPSILON;
                assert!((lower_tail(z) / p - 1.0).abs() < bound, "p = {p}, z = {z}");
            }
        }
    }

    #[test]
    fn quantile_is_odd_and_ends_in_infinity() {
        assert_eq!(normal_quantile(0.5), 0.0);
        assert_eq!(normal_quantile(0.0), f64::NEG_INFINITY);
        assert_eq!(normal_quantile(1.0), f64::INFINITY);
        assert!(normal_quantile(-0.1).is_nan() && normal_quantile(1.1).is_nan());
        // Exact binary fractions, so that 1 - p does not round.
        for k in 1..64 {
            let p = f64::from(k) / 64.0;
            assert_eq!(normal_quantile(p), -normal_quantile(1.0 - p));
        }
    }

    #[test]
    fn sidak_gives_the_family_its_significance() {
        for tests in [1, 2, 100, 10_000] {
            let family = 1.0 - (1.0 - sidak(0.01, tests)).powi(tests as i32);
            // `tests` roundings of a number near 1.
            assert!((family - 0.01).abs() < 2.0 * tests as f64 * f64::EPSILON);
        }
    }
}
