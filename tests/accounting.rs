//! The accounting of a render accounts for all of it, and its instruments stay in their bounds.

mod common;

use common::scenes::cornell_box;
use huygens::film::{Film, Image};
use huygens::geometry::Geometry;
use huygens::scene::Scene;
use huygens::settings::Settings;
use huygens::wave::{self, Control, Instruments, RenderStats};

fn render(scene: &Scene, settings: &Settings, instruments: &Instruments) -> RenderStats {
    render_image(scene, settings, instruments).0
}

fn render_image(
    scene: &Scene,
    settings: &Settings,
    instruments: &Instruments,
) -> (RenderStats, Image) {
    let film = Film::new(scene.film.width, scene.film.height, settings.tile);
    let geometry = Geometry::build(&scene.mesh);
    let control = Control::default();
    let stats = wave::render_with(scene, &geometry, settings, &film, &control, instruments);
    (stats, film.develop())
}

fn small() -> (Scene, Settings) {
    let scene = cornell_box(64);
    let settings = Settings {
        spp: 32,
        threads: 2,
        max_depth: Some(4),
        ..scene.settings.clone()
    };
    (scene, settings)
}

/// Both sides are measured in the same run, so a busy machine moves both.
#[test]
fn stages_account_for_at_least_95_percent_of_worker_time() {
    let (scene, settings) = small();
    let stats = render(&scene, &settings, &Instruments::default());
    let stages: f64 = stats.stages.iter().map(|s| s.seconds).sum();
    let all = stats.worker_seconds;
    assert!(stages >= 0.95 * all, "{stages} of {all} seconds");
    // Laps do not overlap; the sums are rounded some thousand times each.
    let rounding = 1e5 * f64::EPSILON * all;
    assert!(stages <= all + rounding, "{stages} of {all} seconds");
}

#[test]
fn bytes_are_what_the_kernels_declare() {
    use huygens_kernels::rays::CLOSEST;
    let (scene, settings) = small();
    let stats = render(&scene, &settings, &Instruments::default());
    let intersect = stats.stages.iter().find(|s| s.name == "intersect");
    let intersect = intersect.expect("every render intersects");
    assert_eq!(intersect.bytes_read, CLOSEST.read * intersect.items_in);
    assert_eq!(
        intersect.bytes_written,
        CLOSEST.written * intersect.items_in
    );
    // Origin, direction, a triangle; a triangle, distance, two weights.
    assert_eq!((CLOSEST.read, CLOSEST.written), (28, 16));
    for stage in &stats.stages {
        assert!(stage.bytes_read + stage.bytes_written > 0, "{}", stage.name);
    }
}

#[test]
fn a_timeline_is_bounded_and_in_order() {
    let (scene, settings) = small();
    let nothing = render(&scene, &settings, &Instruments::default());
    assert!(nothing.timelines.iter().all(|t| t.slices.is_empty()));
    let instruments = Instruments {
        slices: 50,
        counters: true,
        ..Instruments::default()
    };
    let stats = render(&scene, &settings, &instruments);
    assert_eq!(stats.timelines.len(), 2);
    let kept: usize = stats.timelines.iter().map(|t| t.slices.len()).sum();
    let left_out: u64 = stats.timelines.iter().map(|t| t.left_out).sum();
    let calls: u64 = stats.stages.iter().map(|s| s.calls).sum();
    assert_eq!(kept as u64 + left_out, calls);
    assert!(left_out > 0, "the test wants more calls than fit");
    for timeline in &stats.timelines {
        assert!(timeline.slices.len() <= 50);
        for pair in timeline.slices.windows(2) {
            // The end of one is the start of the next, but for the rounding of seconds.
            assert!((pair[0].start + pair[0].seconds - pair[1].start).abs() < 2e-9);
        }
    }
}

/// What `bench --accounting` sets against each other is the same render.
#[test]
fn without_the_accounting_the_image_is_the_same_and_nothing_is_counted() {
    let (scene, settings) = small();
    let (counted, image) = render_image(&scene, &settings, &Instruments::default());
    let instruments = Instruments {
        unaccounted: true,
        ..Instruments::default()
    };
    let (uncounted, same) = render_image(&scene, &settings, &instruments);
    let bits = |image: &Image| {
        image
            .mean
            .iter()
            .map(|p| p.map(f32::to_bits))
            .collect::<Vec<_>>()
    };
    assert!(bits(&image) == bits(&same));
    assert_eq!(counted.samples, uncounted.samples);
    assert!(!counted.stages.is_empty() && uncounted.stages.is_empty());
}

#[test]
fn instruments_do_not_change_the_counts() {
    let (scene, settings) = small();
    let plain = render(&scene, &settings, &Instruments::default());
    let instruments = Instruments {
        slices: 10,
        counters: true,
        processor_time: true,
        ..Instruments::default()
    };
    let watched = render(&scene, &settings, &instruments);
    for (a, b) in plain.stages.iter().zip(&watched.stages) {
        assert_eq!((a.name, a.items_in), (b.name, b.items_in));
    }
}
