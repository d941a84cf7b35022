//! Numbers for people, and text on the standard output.

use std::io::Write;

/// Three significant digits and a prefix, ready for a unit: `1.23 M`.
pub(crate) fn si(value: f64) -> String {
    let prefixes = ["", "k", "M", "G", "T", "P"];
    let mut scaled = value;
    let mut index = 0;
    // 999.5 would round to four digits.
    while scaled.abs() >= 999.5 && index + 1 < prefixes.len() {
        scaled /= 1000.0;
        index += 1;
    }
    let decimals = match scaled.abs() {
        _ if index == 0 && scaled.fract() == 0.0 => 0,
        a if a < 9.995 => 2,
        a if a < 99.95 => 1,
        _ => 0,
    };
    format!("{scaled:.decimals$} {}", prefixes[index])
}

/// Bytes, in powers of 1000.
pub(crate) fn bytes(value: u64) -> String {
    format!("{}B", si(value as f64))
}

/// Seconds, to a precision that fits.
pub(crate) fn seconds(value: f64) -> String {
    if value < 60.0 {
        return format!("{value:.3} s");
    }
    let whole = value.round() as u64;
    let (hours, minutes, rest) = (whole / 3600, whole / 60 % 60, whole % 60);
    if hours > 0 {
        format!("{hours} h {minutes:02} min {rest:02} s")
    } else {
        format!("{minutes} min {rest:02} s")
    }
}

/// Seconds as three significant digits with a unit from ns to s: `12.3 ms`; from a minute on as
/// [`seconds`].
pub(crate) fn duration(value: f64) -> String {
    if value >= 60.0 {
        return seconds(value);
    }
    let mut scaled = value;
    for unit in ["s", "ms", "us", "ns"] {
        // What would round to 1.00 belongs to this unit.
        if scaled >= 0.9995 || unit == "ns" {
            let decimals = match scaled {
                _ if scaled == 0.0 => 0,
                s if s < 9.995 => 2,
                s if s < 99.95 => 1,
                _ => 0,
            };
            return format!("{scaled:.decimals$} {unit}");
        }
        scaled *= 1000.0;
    }
    unreachable!("the last unit takes all")
}

/// Writes to the standard output. A reader that has gone away (`| head`) is no error of ours.
pub(crate) fn out(text: &str) {
    let _ = std::io::stdout().write_all(text.as_bytes());
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_significant_digits() {
        for (value, text) in [
            (0.0, "0 "),
            (999.0, "999 "),
            (999.9, "1.00 k"),
            (1234.0, "1.23 k"),
            (12_345.0, "12.3 k"),
            (123_456.0, "123 k"),
            (999_600.0, "1.00 M"),
            (2.5e9, "2.50 G"),
        ] {
            assert_eq!(si(value), text);
        }
    }

    #[test]
    fn short_times_have_their_unit() {
        for (value, text) in [
            (0.0, "0 ns"),
            (2.5e-11, "0.03 ns"),
            (1.5e-9, "1.50 ns"),
            (999.6e-9, "1.00 us"),
            (12.34e-6, "12.3 us"),
            (0.123_4, "123 ms"),
            (0.999_4, "999 ms"),
            (0.999_6, "1.00 s"),
            (59.94, "59.9 s"),
            (61.0, "1 min 01 s"),
        ] {
            assert_eq!(duration(value), text);
        }
    }

    #[test]
    fn long_times_have_hours() {
        assert_eq!(seconds(1.23456), "1.235 s");
        assert_eq!(seconds(61.4), "1 min 01 s");
        assert_eq!(seconds(3.0 * 3600.0 + 62.0), "3 h 01 min 02 s");
    }
}
