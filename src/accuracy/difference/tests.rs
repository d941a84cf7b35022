use super::*;
use crate::estimate::{generator, points::uniform};

fn picture<'a>(rgb: &'a [[f32; 3]], variance: Option<&'a [[f32; 3]]>) -> Picture<'a> {
    Picture {
        width: rgb.len() as u32,
        height: 1,
        rgb,
        variance,
    }
}

#[test]
fn measures_by_hand() {
    // Differences: 1 0 -2 in the first pixel, 0 in the second. All exact in binary.
    let a = [[2.0, 1.0, 0.0], [4.0, 4.0, 4.0]];
    let b = [[1.0, 1.0, 2.0], [4.0, 4.0, 4.0]];
    let d = difference(picture(&a, None), picture(&b, None)).expect("comparable");
    assert_eq!((d.pixels, d.left_out), (2, 0));
    assert_eq!(d.mse, 5.0 / 6.0);
    assert_eq!(d.rmse, (5.0f64 / 6.0).sqrt());
    assert_eq!(d.mae, 0.5);
    assert_eq!(d.bias, [0.5, 0.0, -1.0]);
    assert_eq!(
        d.max,
        Largest {
            value: 2.0,
            x: 0,
            y: 0
        }
    );
    // The mean of |b| is 16/6.
    let floor = 0.01 * (16.0f64 / 6.0).powi(2);
    let relative = (1.0 / (1.0 + floor) + 4.0 / (4.0 + floor)) / 6.0;
    let rel_mse = d.rel_mse.expect("b is not black");
    // Some ten roundings.
    assert!((rel_mse / relative - 1.0).abs() < 16.0 * f64::EPSILON);
    assert_eq!(d.rel_mse, d.rel_mse_all);
    assert_eq!(
        (d.noise, d.bias_interval, d.noise_of),
        (None, None, NoiseOf::None)
    );
}

#[test]
fn relative_errors_do_not_depend_on_the_exposure() {
    let a = [[2.0, 1.0, 0.5], [4.0, 3.0, 4.0]];
    let b = [[1.0, 1.0, 2.0], [4.0, 4.0, 4.0]];
    // By a power of two, so that nothing rounds.
    let scaled =
        |p: &[[f32; 3]]| -> Vec<[f32; 3]> { p.iter().map(|p| p.map(|v| v * 1024.0)).collect() };
    let of = |a: &[[f32; 3]], b: &[[f32; 3]]| {
        difference(picture(a, None), picture(b, None))
            .expect("comparable")
            .rel_mse
    };
    assert_eq!(of(&a, &b), of(&scaled(&a), &scaled(&b)));
}

#[test]
fn one_firefly_in_a_thousand_pixels_does_not_reach_the_robust_measure() {
    let b = vec![[1.0; 3]; 1000];
    let mut a = vec![[1.5; 3]; 1000];
    a[500] = [1e6; 3];
    let d = difference(picture(&a, None), picture(&b, None)).expect("comparable");
    let usual = 0.25 / 1.01;
    assert!((d.rel_mse.expect("known") / usual - 1.0).abs() < 1000.0 * f64::EPSILON);
    assert!(d.rel_mse_all.expect("known") > 1e8);
    assert_eq!((d.max.x, d.max.value), (500, 1e6 - 1.0));
}

#[test]
fn what_is_not_finite_is_left_out_and_a_black_reference_has_no_relative_error() {
    let a = [[f32::NAN, 0.0, 0.0], [1.0; 3], [0.0; 3]];
    let b = [[0.0; 3], [0.0; 3], [f32::INFINITY; 3]];
    let d = difference(picture(&a, None), picture(&b, None)).expect("comparable");
    assert_eq!((d.pixels, d.left_out, d.mse, d.max.x), (1, 2, 1.0, 1));
    assert_eq!((d.rel_mse, d.rel_mse_all), (None, None));
    let none = difference(picture(&a[..1], None), picture(&b[..1], None));
    assert_eq!(none, Err(DifferenceError::NoPixel));
}

#[test]
fn sizes_must_agree() {
    let error = difference(picture(&[[0.0; 3]; 2], None), picture(&[[0.0; 3]; 3], None));
    assert_eq!(
        error.expect_err("two sizes").to_string(),
        "the image has 2 x 1 pixels, the reference 3 x 1; expected one size"
    );
}

#[test]
fn noise_is_counted_as_far_as_it_is_known() {
    let rgb = [[1.0; 3]; 2];
    let known = [[0.25, 0.5, 1.0]; 2];
    let unknown = [[0.25, 0.5, 1.0], [f32::INFINITY; 3]];
    let of = |a: Option<&[[f32; 3]]>, b: Option<&[[f32; 3]]>| {
        let d = difference(picture(&rgb, a), picture(&rgb, b)).expect("comparable");
        (d.noise_of, d.noise)
    };
    let noise = 1.75 / 3.0;
    assert_eq!(of(Some(&known), None), (NoiseOf::Image, Some(noise)));
    assert_eq!(of(None, Some(&known)), (NoiseOf::Reference, Some(noise)));
    assert_eq!(
        of(Some(&known), Some(&known)),
        (NoiseOf::Both, Some(2.0 * noise))
    );
    assert_eq!(of(Some(&unknown), None), (NoiseOf::None, None));
    assert_eq!(of(Some(&unknown), Some(&known)).0, NoiseOf::Reference);
}

/// 2000 pairs of noisy pictures of one image: the interval of the bias holds 0 as often as it says,
/// and the MSE is what the noise explains.
#[test]
fn the_interval_of_the_bias_covers_as_often_as_it_says() {
    let (trials, pixels) = (2000, 16);
    let mut rng = generator(&[1]);
    // Uniform about 1, on a width of 1: variance 1/12.
    let variance = vec![[1.0 / 12.0; 3]; pixels];
    let mut noisy = || -> Vec<[f32; 3]> {
        (0..pixels)
            .map(|_| [0; 3].map(|_| 0.5 + uniform(&mut rng) as f32))
            .collect()
    };
    let (mut covered, mut mse) = ([0.0; 3], crate::estimate::Running::new());
    for _ in 0..trials {
        let (a, b) = (noisy(), noisy());
        let d = difference(picture(&a, Some(&variance)), picture(&b, Some(&variance)));
        let d = d.expect("comparable");
        for (count, [low, high]) in covered.iter_mut().zip(d.bias_interval.expect("known")) {
            *count += f64::from(u8::from(low <= 0.0 && 0.0 <= high));
        }
        mse.push(d.mse - d.noise.expect("known"));
    }
    let n = f64::from(trials);
    for count in covered {
        // Of a mean of 32 uniform numbers, whose kurtosis (-0.04) moves the coverage by 0.0003; five
        // standard deviations are passed with probability 6e-7.
        let z = (count - 0.95 * n) / (n * 0.95 * 0.05).sqrt();
        assert!(z.abs() < 5.0, "{z}");
    }
    assert!((mse.mean() / mse.standard_error().expect("many")).abs() < 5.0);
}
