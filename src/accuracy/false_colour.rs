//! Numbers as colours: from black through purple, red and yellow to white, ever lighter.

use crate::film::tone::from_srgb;

/// sRGB codes at equal distances.
const RAMP: [[u8; 3]; 7] = [
    [0, 0, 0],
    [56, 12, 94],
    [134, 22, 106],
    [204, 52, 72],
    [243, 120, 36],
    [252, 204, 70],
    [255, 255, 240],
];

/// What has no number: a blue that is nowhere on the ramp. Linear Rec. 709.
pub const NO_NUMBER: [f32; 3] = [0.0, 0.3, 1.0];

/// The colour of `t`, black at 0 and below, white at 1 and above; [`NO_NUMBER`] of NaN. Linear Rec.
/// 709, for [`crate::film::png::write_png`] without a tone map.
#[must_use]
pub fn false_colour(t: f64) -> [f32; 3] {
    if t.is_nan() {
        return NO_NUMBER;
    }
    let last = RAMP.len() - 1;
    let place = t.clamp(0.0, 1.0) * last as f64;
    let step = (place as usize).min(last - 1);
    let within = place - step as f64;
    std::array::from_fn(|c| {
        let [from, to] = [RAMP[step][c], RAMP[step + 1][c]].map(f64::from);
        from_srgb((from + within * (to - from)) / 255.0) as f32
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_gets_lighter_all_the_way() {
        // Luminance of Rec. 709.
        let luminance = |t: f64| {
            let [r, g, b] = false_colour(t).map(f64::from);
            0.2126 * r + 0.7152 * g + 0.0722 * b
        };
        let steps: Vec<f64> = (0..=1000)
            .map(|i| luminance(f64::from(i) / 1000.0))
            .collect();
        assert!(steps.is_sorted_by(|a, b| a < b));
        assert_eq!(steps[0], 0.0);
        assert!(steps[1000] > 0.98, "{}", steps[1000]);
    }

    #[test]
    fn the_ends_hold_what_lies_beyond() {
        assert_eq!(false_colour(-1.0), false_colour(0.0));
        assert_eq!(false_colour(f64::INFINITY), false_colour(1.0));
        assert_eq!(false_colour(f64::NAN), NO_NUMBER);
    }
}
