//! Studies of scenes find what theory says, and the same thing every time.

mod common;

use common::scenes::{Builder, cornell_box, floor_from_above, furnace};
use huygens::accuracy::Ladder;
use huygens::accuracy::scene::{Family, SceneStudy, Stage, Truth, choices, study_scene};
use huygens::geometry::Geometry;
use huygens::scene::{Scene, Sky};
use huygens::settings::{Integrator, Sampler, Settings, Strategy};
use huygens::wave::Control;

fn study(
    scene: &Scene,
    families: &[Family],
    reference_error: f64,
    ladder: &Ladder,
) -> (Truth, SceneStudy) {
    let geometry = Geometry::of(scene, scene.settings.bvh);
    let control = Control::default();
    let stage = Stage {
        scene,
        geometry: &geometry,
        control: &control,
        progress: &|_, _| (),
    };
    let truth = Truth::make(&stage, reference_error, None).expect("light");
    let choices = choices(scene, families);
    let study = study_scene(&stage, &truth, &choices, ladder, 0.05, |_| 0.0);
    (truth, study)
}

fn with(mut scene: Scene, size: u32, settings: Settings) -> Scene {
    (scene.film.width, scene.film.height) = (size, size);
    scene.settings = settings;
    scene
}

/// A floor in the light of the sky, partly below a ceiling: smooth but for the ceiling's edge.
fn sky() -> Scene {
    let mut b = Builder::new();
    let grey = b.material([0.5; 3], [0.0; 3]);
    let (d, h) = (1.0, 2.0);
    b.quad(grey, [[-d, h, -d], [d, h, -d], [d, h, d], [-d, h, d]]);
    let mut scene = floor_from_above(0.5, b);
    scene.sky = Some(Sky::Gradient {
        zenith: [1.0, 2.0, 3.0],
        nadir: [0.5; 3],
    });
    scene
}

/// Variance falls as 1/N exactly, so the expectation of every rung lies on the line. Each of seven
/// rungs knows its error to a few per cent, the slope to about 0.01; the interval (of level 0.9999)
/// holds -1/2 and is itself no wider than 0.05 either way.
#[test]
fn independent_samples_have_a_slope_of_a_half() {
    let independent = |strategy, max_depth| Settings {
        strategy,
        max_depth,
        sampler: Sampler::Independent,
        ..Settings::default()
    };
    let ladder = Ladder {
        first: 4,
        last: 256,
        repetitions: 8,
        seed: 1,
    };
    for (what, scene) in [
        ("sky", with(sky(), 16, independent(Strategy::Light, None))),
        (
            "furnace",
            with(furnace(0.5), 16, independent(Strategy::Cosine, Some(4))),
        ),
        (
            "box",
            with(cornell_box(16), 16, independent(Strategy::Mis, None)),
        ),
    ] {
        let (_, study) = study(&scene, &[], 0.02, &ladder);
        let fit = study.curves[0].curve.fit().expect("seven rungs");
        let [low, high] = fit.slope_interval(0.9999).expect("seven rungs");
        assert!(low <= -0.5 && -0.5 <= high, "{what}: {low} to {high}");
        assert!((fit.slope + 0.5).abs() < 0.05, "{what}: {}", fit.slope);
    }
}

/// On an open floor under a sky that changes slowly, a pixel is a smooth integral in two dimensions.
#[test]
fn sobol_points_are_steeper_on_smooth_pixels() {
    let mut smooth = floor_from_above(0.5, Builder::new());
    smooth.sky = sky().sky;
    // Off the edge that the floor's two triangles share.
    smooth.camera.origin = [0.3, 1.0, 0.1];
    let settings = Settings {
        integrator: Integrator::Direct,
        strategy: Strategy::Cosine,
        // A path that dies by chance is a jump that no points smooth.
        roulette: false,
        ..Settings::default()
    };
    let ladder = Ladder {
        first: 1,
        last: 64,
        repetitions: 8,
        seed: 1,
    };
    let (_, study) = study(
        &with(smooth, 8, settings),
        &[Family::Sampler],
        1e-4,
        &ladder,
    );
    for curve in study.measured() {
        let fit = curve.curve.fit().expect("seven rungs");
        let [low, high] = fit.slope_interval(0.999).expect("seven rungs");
        let errors: Vec<f64> = curve.curve.points.iter().map(|p| p.error).collect();
        let name = &format!("{} {errors:?}", curve.curve.name);
        if curve.curve.name.ends_with("independent") {
            assert!(low <= -0.5 && -0.5 <= high, "{name}: {low} to {high}");
        } else if curve.curve.name.ends_with("sobol") {
            assert!(high < -0.5, "{name}: {low} to {high}");
        } else {
            // Grids of 2, 8 and 32 cells are not square: their points bend, and the interval is wide.
            assert!(fit.slope < -0.8, "{name}: {low} to {high}");
        }
    }
}

/// The f64 tracer and the wave converge to one image on every scene that ships and that the tracer
/// supports: no bias beyond five standard errors, over the image and in the squares of its pixels.
#[test]
fn the_f64_reference_agrees_with_the_wave() {
    let ladder = Ladder {
        first: 64,
        last: 128,
        repetitions: 6,
        seed: 2,
    };
    for name in ["cornell-box", "furnace", "veach-lights", "depth-of-field"] {
        let path = format!("{}/scenes/{name}.toml", env!("CARGO_MANIFEST_DIR"));
        let scene = huygens::scene::load(path.as_ref()).expect("it ships");
        let settings = scene.settings.clone();
        let (_, study) = study(
            &with(scene, 12, settings),
            &[Family::Precision],
            0.04,
            &ladder,
        );
        let f64s = &study.curves[1];
        assert_eq!(f64s.curve.name, "f64 reference");
        for p in &f64s.curve.points {
            let z = p.bias_squared / p.bias_squared_error;
            assert!(z.abs() < 5.0, "{name}: {p:?}");
            let off = p.point.bias.abs() / p.point.bias_error;
            assert!(off < 5.0, "{name}: {p:?}");
        }
    }
}

/// Which strategy reaches an error sooner is no matter of chance.
#[test]
fn three_runs_agree_on_the_order() {
    let order = |seed| {
        let ladder = Ladder {
            first: 4,
            last: 256,
            repetitions: 4,
            seed,
        };
        let (_, study) = study(&cornell_box(16), &[Family::Strategy], 0.05, &ladder);
        let cost = |name: &str| {
            let curve = study.measured().find(|c| c.curve.name == name);
            let cost = curve.expect(name).cost_of(0.2);
            cost.seconds().expect("it falls")
        };
        let lights = cost("mis+sobol").max(cost("light+sobol"));
        let [cosine, uniform] = ["cosine+sobol", "uniform+sobol"].map(cost);
        // Lights sampled beat directions by a factor of tens, known to a factor of two or so: few of
        // those samples meet the light. Cosine beats uniform by less than that.
        (lights * 3.0 < cosine, lights * 3.0 < uniform)
    };
    for seed in 0..3 {
        assert_eq!(order(seed), (true, true), "seed {seed}");
    }
}
