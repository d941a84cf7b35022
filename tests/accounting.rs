//! The accounting of a render accounts for all of it, and its instruments stay in their bounds.

mod common;

use common::scenes::cornell_box;
use huygens::film::Film;
use huygens::geometry::Geometry;
use huygens::scene::Scene;
use huygens::settings::Settings;
use huygens::wave::{self, Control, Instruments, RenderStats};

fn render(scene: &Scene, settings: &Settings, instruments: &Instruments) -> RenderStats {
    let film = Film::new(scene.film.width, scene.film.height, settings.tile);
    let geometry = Geometry::build(&scene.mesh);
    let control = Control::default();
    wave::render_with(scene, &geometry, settings, &film, &control, instruments)
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
        processor_time: false,
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

#[test]
fn instruments_do_not_change_the_counts() {
    let (scene, settings) = small();
    let plain = render(&scene, &settings, &Instruments::default());
    let instruments = Instruments {
        slices: 10,
        counters: true,
        processor_time: true,
    };
    let watched = render(&scene, &settings, &instruments);
    for (a, b) in plain.stages.iter().zip(&watched.stages) {
        assert_eq!((a.name, a.items_in), (b.name, b.items_in));
    }
}
