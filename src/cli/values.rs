//! Values of options: from text, with what was expected where they are wrong.

use huygens::settings::Settings;
use std::time::Duration;

/// A maximum depth, or explicitly none (where the scene has one).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Depth(pub(crate) Option<u32>);

/// Width and height in pixels.
pub(crate) fn size(text: &str) -> Result<(u32, u32), String> {
    let expected = || format!("expected WIDTHxHEIGHT, such as 640x480, found {text}");
    let (width, height) = text.split_once(['x', 'X']).ok_or_else(expected)?;
    let side = |side: &str| -> Result<u32, String> {
        let pixels: i64 = side.parse().map_err(|_| expected())?;
        match pixels {
            1..=65_535 => Ok(pixels as u32),
            _ => Err(format!("a side of {pixels} pixels; expected 1 to 65535")),
        }
    };
    Ok((side(width)?, side(height)?))
}

/// A maximum depth, or `none`.
pub(crate) fn depth(text: &str) -> Result<Depth, String> {
    if text == "none" {
        return Ok(Depth(None));
    }
    let number = text.parse().ok().filter(|&d| d <= i32::MAX as u32);
    number
        .map(|d| Depth(Some(d)))
        .ok_or_else(|| "expected 0 to 2147483647, or none".to_owned())
}

/// A finite number above 0.
pub(crate) fn positive(text: &str) -> Result<f32, String> {
    let number: Option<f32> = text.parse().ok();
    number
        .filter(|v| v.is_finite() && *v > 0.0)
        .ok_or_else(|| "expected a finite number above 0".to_owned())
}

/// A share above 0 and at most 1, as a number or in per cent.
pub(crate) fn share(text: &str) -> Result<f64, String> {
    let (number, unit) = match text.strip_suffix('%') {
        Some(number) => (number, 100.0),
        None => (text, 1.0),
    };
    let number: Option<f64> = number.trim().parse().ok();
    number
        .map(|n| n / unit)
        .filter(|s| *s > 0.0 && *s <= 1.0)
        .ok_or_else(|| "expected a share above 0 and at most 1, such as 1% or 0.01".to_owned())
}

/// Exposure in stops, between -64 and 64.
pub(crate) fn stops(text: &str) -> Result<f32, String> {
    let number: Option<f32> = text.parse().ok();
    number
        .filter(|v| (-64.0..=64.0).contains(v))
        .ok_or_else(|| "expected a number of stops from -64 to 64".to_owned())
}

/// A time above 0: a number and `ms`, `s`, `m` or `h`; `s` if there is none.
pub(crate) fn time(text: &str) -> Result<Duration, String> {
    let (number, unit) = match text.find(|c: char| c.is_ascii_alphabetic()) {
        Some(at) => text.split_at(at),
        None => (text, "s"),
    };
    let scale = match unit.trim() {
        "ms" => Some(1e-3),
        "s" => Some(1.0),
        "m" | "min" => Some(60.0),
        "h" => Some(3600.0),
        _ => None,
    };
    let number: Option<f64> = number.trim().parse().ok();
    let seconds = number.zip(scale).map(|(n, scale)| n * scale);
    // Beyond it a Duration would overflow.
    let longest = 1e9;
    seconds
        .filter(|s| *s > 0.0 && *s <= longest)
        .map(Duration::from_secs_f64)
        .ok_or_else(|| "expected a time above 0, such as 90s, 500ms, 2m or 1h".to_owned())
}

/// Branches of a path, by scattering event.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Split(pub(crate) Vec<u32>);

/// Numbers of branches, with commas between them.
pub(crate) fn split(text: &str) -> Result<Split, String> {
    let numbers: Option<Vec<u32>> = text.split(',').map(|n| n.trim().parse().ok()).collect();
    let product = |numbers: &Vec<u32>| {
        let all = numbers.iter().map(|&n| u64::from(n));
        all.fold(1u64, u64::saturating_mul)
    };
    numbers
        .filter(|n| n.len() <= Settings::MOST_SPLITS && !n.contains(&0))
        .filter(|n| product(n) <= Settings::MOST_BRANCHES.into())
        .map(Split)
        .ok_or_else(|| {
            format!(
                "expected at most {} numbers from 1, such as 4 or 4,2, whose product is at most {}",
                Settings::MOST_SPLITS,
                Settings::MOST_BRANCHES
            )
        })
}

/// Numbers with commas between them.
pub(crate) fn list(numbers: &[u32]) -> String {
    let numbers: Vec<String> = numbers.iter().map(u32::to_string).collect();
    numbers.join(",")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes() {
        assert_eq!(size("640x480"), Ok((640, 480)));
        assert_eq!(size("1X65535"), Ok((1, 65_535)));
        for wrong in [
            "0x480", "640x0", "640", "640x", "axb", "-1x5", "65536x1", "6 x4", "",
        ] {
            assert!(size(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn depths() {
        assert_eq!(depth("none"), Ok(Depth(None)));
        assert_eq!(depth("0"), Ok(Depth(Some(0))));
        assert_eq!(depth("2147483647"), Ok(Depth(Some(2_147_483_647))));
        assert!(depth("2147483648").is_err() && depth("-1").is_err() && depth("").is_err());
    }

    #[test]
    fn times() {
        for (text, seconds) in [
            ("90s", 90.0),
            ("90", 90.0),
            ("1.5 s", 1.5),
            ("500ms", 0.5),
            ("2m", 120.0),
            ("2min", 120.0),
            ("1h", 3600.0),
        ] {
            assert_eq!(time(text), Ok(Duration::from_secs_f64(seconds)), "{text}");
        }
        for wrong in [
            "",
            "s",
            "0s",
            "-1s",
            "nan",
            "inf",
            "1e30h",
            "5 fortnights",
            "1s2",
        ] {
            assert!(time(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn splits() {
        assert_eq!(split("4"), Ok(Split(vec![4])));
        assert_eq!(split("4, 2,1"), Ok(Split(vec![4, 2, 1])));
        assert_eq!(list(&[4, 2, 1]), "4,2,1");
        assert!(split("65536").is_ok() && split("1,1,1,1,1,1,1,1").is_ok());
        for wrong in [
            "",
            "0",
            "4,0",
            "4,",
            "-1",
            "2.5",
            "65537",
            "256,257",
            "1,1,1,1,1,1,1,1,1",
            "4294967295,4294967295,4294967295",
        ] {
            assert!(split(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn shares() {
        for (text, expected) in [("1%", 0.01), ("0.01", 0.01), ("100 %", 1.0), ("1", 1.0)] {
            assert_eq!(share(text), Ok(expected), "{text}");
        }
        for wrong in ["", "%", "0", "-1%", "101%", "1.5", "nan", "one"] {
            assert!(share(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn numbers_that_are_not_finite_are_refused() {
        assert!(positive("nan").is_err() && positive("inf").is_err() && positive("0").is_err());
        assert!(stops("nan").is_err() && stops("65").is_err());
        assert_eq!(stops("-1.5"), Ok(-1.5));
    }
}
