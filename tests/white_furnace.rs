//! A closed box of reflectance `rho` that emits 1 everywhere holds the radiance `1 / (1 - rho)`;
//! cut after `n` scattering events, the geometric series up to `rho^n`.
//!
//! Confidence intervals need a finite variance, and two strategies have none in some furnaces:
//!
//! * `light`: from a point close to an edge of the box, the wall beyond the edge is seen under
//!   `cos cos / d^2` without bound, so that `P(estimate > t)` falls as `t^-1.5` only. Inside a ball
//!   that factor is constant but for the shallow edges of its tessellation, so `light` is tested
//!   there. (`mis` weighs exactly this down: its estimates are bounded.)
//! * `uniform`: each scattering multiplies a path by `2 rho cos`, whose square has the mean
//!   `4/3 rho^2`. Above `rho = sqrt(3/4)` the variance grows with every bounce, so it is tested there
//!   with the path cut, where the answer is just as exact.

mod common;

use common::picture::mean_by_wave;
use common::scenes::{furnace, round_furnace};
use common::statistics::assert_mean;
use huygens::scene::Scene;
use huygens::settings::{Settings, Strategy};

const ALBEDOS: [f32; 5] = [0.0, 0.1, 0.5, 0.9, 0.99];

type Furnace = fn(f32) -> Scene;

/// Each strategy and a furnace in which its variance is finite.
const CASES: [(Strategy, Furnace); 4] = [
    (Strategy::Uniform, furnace),
    (Strategy::Cosine, furnace),
    (Strategy::Mis, furnace),
    (Strategy::Light, round_furnace),
];

#[test]
fn a_closed_furnace_holds_the_whole_series() {
    for (strategy, furnace) in CASES {
        for albedo in ALBEDOS {
            if strategy == Strategy::Uniform && albedo > 0.75f32.sqrt() {
                continue;
            }
            let settings = Settings {
                strategy,
                // Paths are about 1 / (1 - albedo) long: equal work for each albedo.
                spp: (8192.0 * (1.0 - albedo).max(0.1)) as u32,
                max_depth: None,
                roulette: true,
                ..Settings::default()
            };
            let expected = 1.0 / (1.0 - f64::from(albedo));
            let mean = mean_by_wave(&furnace(albedo), &settings);
            assert_mean(&format!("{strategy:?} at {albedo}"), mean, expected, 18);
        }
    }
}

#[test]
fn a_furnace_cut_at_n_holds_the_series_up_to_n() {
    for (strategy, furnace) in CASES {
        for albedo in ALBEDOS {
            for depth in 0..=6 {
                let settings = Settings {
                    strategy,
                    spp: 1024,
                    max_depth: Some(depth),
                    roulette: false,
                    ..Settings::default()
                };
                let rho = f64::from(albedo);
                let expected = (0..=depth).map(|k| rho.powi(k as i32)).sum();
                let mean = mean_by_wave(&furnace(albedo), &settings);
                let what = format!("{strategy:?} at {albedo}, depth {depth}");
                assert_mean(&what, mean, expected, 4 * 5 * 7);
            }
        }
    }
}

/// A furnace test that any answer passes would be worth nothing.
#[test]
#[should_panic(expected = "standard errors from")]
fn one_percent_is_seen() {
    let settings = Settings {
        strategy: Strategy::Mis,
        spp: 8192,
        max_depth: Some(6),
        ..Settings::default()
    };
    let rho = f64::from(0.9f32);
    let series: f64 = (0..=6).map(|k| rho.powi(k)).sum();
    let mean = mean_by_wave(&furnace(0.9), &settings);
    assert_mean("1% off", mean, 1.01 * series, 1);
}
