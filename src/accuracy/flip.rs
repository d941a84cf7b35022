//! FLIP: what an observer sees of a difference, through NVIDIA's own code (the crate `nv-flip`).
//!
//! It is C++, so the feature `flip` is off by default: Huygens builds with Rust alone.

use super::Picture;

/// Pixels to a degree of the observer's view: the measure's own default, a screen of 3840 pixels and
/// 0.7 m at 0.7 m.
pub const PIXELS_PER_DEGREE: f64 = 67.020_64;

/// The mean of FLIP over an image against a reference, both shown as a screen would show them (the
/// filmic curve, 8-bit sRGB): 0 where nobody sees a difference, at most 1. None where this build has
/// no FLIP, or the images are not of one size.
///
/// P. Andersson, J. Nilsson, T. Akenine-Moeller, M. Oskarsson, K. Astroem, M. Fairchild, "FLIP: A
/// Difference Evaluator for Alternating Images", HPG 2020.
#[must_use]
pub fn flip(image: Picture, reference: Picture) -> Option<f64> {
    if (image.width, image.height) != (reference.width, reference.height) {
        return None;
    }
    mean(image, reference)
}

#[cfg(not(feature = "flip"))]
fn mean(_: Picture, _: Picture) -> Option<f64> {
    None
}

#[cfg(feature = "flip")]
fn mean(image: Picture, reference: Picture) -> Option<f64> {
    use crate::film::tone::{ToneMap, display};
    let shown = |picture: Picture| {
        let code = |&radiance: &[f32; 3]| display(radiance, 1.0, ToneMap::Filmic);
        let codes: Vec<[u8; 3]> = picture.rgb.iter().map(code).collect();
        nv_flip::FlipImageRgb8::with_data(picture.width, picture.height, codes.as_flattened())
    };
    let map = nv_flip::flip(shown(reference), shown(image), PIXELS_PER_DEGREE as f32);
    let values = map.to_vec();
    Some(values.iter().map(|&v| f64::from(v)).sum::<f64>() / values.len() as f64)
}

#[cfg(all(test, feature = "flip"))]
mod tests {
    use super::*;

    fn of(a: &[[f32; 3]], b: &[[f32; 3]]) -> f64 {
        let picture = |rgb| Picture {
            width: 32,
            height: 32,
            rgb,
            variance: None,
        };
        flip(picture(a), picture(b)).expect("of one size")
    }

    #[test]
    fn black_against_white_is_one_and_nothing_against_itself() {
        let (black, white) = (vec![[0.0; 3]; 1024], vec![[1e6; 3]; 1024]);
        assert_eq!(of(&black, &black), 0.0);
        // The measure's range ends there; its code rounds in f32.
        assert!((of(&white, &black) - 1.0).abs() < 0.05);
        let grey = vec![[0.18; 3]; 1024];
        let small = vec![[0.19; 3]; 1024];
        assert!(of(&small, &grey) < of(&white, &grey));
    }
}
