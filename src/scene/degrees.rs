//! Sine and cosine of angles in degrees.
//!
//! Not the platform's: a scene must compile to the same bits on every machine, and its libm's sine
//! may differ in the last place between two of them. Degrees also reduce exactly, so that a
//! quarter turn gives 0 and 1 and not 6e-17.

/// Sine and cosine of `degrees`, which is finite.
///
/// The angle is reduced to -45..=45 degrees, exactly (a remainder is exact, and so is, by Sterbenz'
/// lemma, a difference of numbers within a factor of two), then summed by Taylor series to x^19
/// and x^18, whose remainders at pi/4 are below (pi/4)^20 / 20! < 1e-20.
pub(super) fn sin_cos(degrees: f64) -> (f64, f64) {
    let turn = degrees % 360.0;
    let quarter = (turn / 90.0).round();
    let x = (turn - 90.0 * quarter).to_radians();
    let square = x * x;
    // Horner over term ratios: 1 - x^2/(a(a+1)) (1 - x^2/((a+2)(a+3)) (...)).
    let series = |first: f64| {
        let mut sum = 1.0;
        for term in (0..9).rev() {
            let a = first + 2.0 * f64::from(term);
            sum = 1.0 - square / (a * (a + 1.0)) * sum;
        }
        sum
    };
    let (sin, cos) = (x * series(2.0), series(1.0));
    match (quarter as i32).rem_euclid(4) {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

#[cfg(test)]
mod tests {
    use super::sin_cos;

    #[test]
    fn agrees_with_the_platform_to_a_few_ulps() {
        // Both are within about 1.5 ulp of the truth near 1; radians() adds one rounding of an
        // argument of up to pi/4 here and of up to 4 pi there (8 half-ulps of 1).
        for i in -2000..=2000 {
            let degrees = f64::from(i) * 0.3607;
            let (sin, cos) = sin_cos(degrees);
            let (s, c) = degrees.to_radians().sin_cos();
            assert!((sin - s).abs() <= 16.0 * f64::EPSILON, "{degrees}");
            assert!((cos - c).abs() <= 16.0 * f64::EPSILON, "{degrees}");
        }
    }

    #[test]
    fn quarter_turns_are_exact() {
        assert_eq!(sin_cos(90.0), (1.0, 0.0));
        assert_eq!(sin_cos(-90.0), (-1.0, 0.0));
        assert_eq!(sin_cos(180.0), (0.0, -1.0));
        assert_eq!(sin_cos(3690.0), (1.0, 0.0));
    }
}
