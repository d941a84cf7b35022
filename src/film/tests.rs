use super::*;
use rand_pcg::Pcg32;
use rand_pcg::rand_core::Rng;
use std::sync::atomic::AtomicUsize;

/// Radiance of a sample as a pure function of pixel and sample, of widely different magnitudes, so
/// that any change in the order of addition shows.
fn radiance(x: u32, y: u32, sample: u32) -> [f32; 3] {
    let mut rng = Pcg32::new(u64::from(x) << 32 | u64::from(y), u64::from(sample));
    std::array::from_fn(|_| {
        let magnitude = (rng.next_u32() % 40) as i32 - 20;
        f32::powi(2.0, magnitude) * (rng.next_u32() >> 8) as f32
    })
}

fn fill(job: &Job, buffer: &mut SampleBuffer) {
    for slot in 0..job.slots() {
        let (pixel, sample) = (slot as u32 / job.samples, slot as u32 % job.samples);
        let (x, y) = (pixel % job.tile.width, pixel / job.tile.width);
        let value = radiance(job.tile.x + x, job.tile.y + y, job.first_sample + sample);
        for channel in 0..3 {
            buffer.radiance[channel][slot] = value[channel];
        }
    }
}

/// Exposes a 37 x 29 film with 24 samples, as the scheduler does: jobs in order, tile by tile,
/// handed out by a counter.
fn expose(tile: u32, samples_a_job: u32, threads: usize) -> Image {
    let film = Film::new(37, 29, tile);
    let jobs: Vec<Job> = film
        .tiles()
        .iter()
        .enumerate()
        .flat_map(|(tile_index, &tile)| {
            let firsts = (0..24).step_by(samples_a_job as usize);
            firsts.map(move |first_sample| Job {
                tile_index,
                tile,
                first_sample,
                samples: samples_a_job.min(24 - first_sample),
            })
        })
        .collect();
    let next = AtomicUsize::new(0);
    let stop = AtomicBool::new(false);
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                let mut buffer = SampleBuffer::new((tile * tile * samples_a_job) as usize);
                while let Some(job) = jobs.get(next.fetch_add(1, Ordering::Relaxed)) {
                    fill(job, &mut buffer);
                    assert!(film.commit(job, &buffer, &stop).is_empty());
                }
            });
        }
    });
    film.develop()
}

#[test]
fn image_does_not_depend_on_tiles_jobs_or_threads() {
    let expected = expose(64, 24, 1);
    for (tile, samples_a_job, threads) in [(8, 24, 1), (5, 7, 1), (16, 1, 3), (64, 5, 4)] {
        let image = expose(tile, samples_a_job, threads);
        assert!(
            image == expected,
            "tile {tile}, {samples_a_job} samples a job, {threads} threads"
        );
    }
}

#[test]
fn tiles_cover_every_pixel_once_in_scanline_order() {
    let film = Film::new(37, 29, 8);
    let mut covered = vec![0; 37 * 29];
    for tile in film.tiles() {
        for y in tile.y..tile.y + tile.height {
            for x in tile.x..tile.x + tile.width {
                covered[(y * 37 + x) as usize] += 1;
            }
        }
    }
    assert!(covered.iter().all(|&c| c == 1));
    assert!(film.tiles().is_sorted_by_key(|t| (t.y, t.x)));
}

fn one_pixel(samples: &[f32]) -> Image {
    let film = Film::new(1, 1, 1);
    let job = Job {
        tile_index: 0,
        tile: film.tiles()[0],
        first_sample: 0,
        samples: samples.len() as u32,
    };
    let buffer = SampleBuffer {
        radiance: std::array::from_fn(|_| samples.to_vec()),
    };
    film.commit(&job, &buffer, &AtomicBool::new(false));
    film.develop()
}

#[test]
fn mean_and_variance_of_the_mean_are_exact_on_small_integers() {
    // Sample variance of 1, 2, 3, 6: (4 + 1 + 0 + 9) / 3; over 4 samples: 14 / 12.
    let image = one_pixel(&[1.0, 2.0, 3.0, 6.0]);
    assert_eq!(image.mean, [[3.0; 3]]);
    assert_eq!(image.variance, [[(14.0f64 / 3.0 / 4.0) as f32; 3]]);
    assert_eq!(image.samples, [4]);
}

#[test]
fn variance_is_unknown_below_two_samples_and_zero_for_equal_ones() {
    assert_eq!(one_pixel(&[]).mean, [[0.0; 3]]);
    assert_eq!(one_pixel(&[]).variance, [[f32::INFINITY; 3]]);
    assert_eq!(one_pixel(&[0.3]).mean, [[0.3; 3]]);
    assert_eq!(one_pixel(&[0.3]).variance, [[f32::INFINITY; 3]]);
    assert_eq!(one_pixel(&[0.25; 7]).variance, [[0.0; 3]]);
}

#[test]
fn samples_that_are_not_finite_are_left_out_whole_and_named() {
    let film = Film::new(5, 3, 4);
    let tile = film.tiles()[1];
    let job = Job {
        tile_index: 1,
        tile,
        first_sample: 0,
        samples: 2,
    };
    let mut buffer = SampleBuffer::new(job.slots());
    for column in &mut buffer.radiance {
        column.fill(1.0);
    }
    // The tile is one pixel wide: pixel 1 is (4, 1), pixel 2 is (4, 2).
    buffer.radiance[0][2] = f32::NAN;
    buffer.radiance[2][5] = f32::NEG_INFINITY;
    let dropped = film.commit(&job, &buffer, &AtomicBool::new(false));
    assert_eq!(dropped, [(4, 1, 0), (4, 2, 1)]);
    let image = film.develop();
    assert_eq!(image.samples[4], 2);
    assert_eq!(image.samples[9], 1);
    assert_eq!(image.mean[9], [1.0; 3]);
    assert_eq!(film.samples(), 4);
}

#[test]
fn a_commit_that_waits_for_its_turn_wakes_on_stop_without_adding() {
    let film = Film::new(1, 1, 1);
    let job = Job {
        tile_index: 0,
        tile: film.tiles()[0],
        first_sample: 3,
        samples: 1,
    };
    let stop = AtomicBool::new(false);
    std::thread::scope(|scope| {
        let waiting = scope.spawn(|| film.commit(&job, &SampleBuffer::new(1), &stop));
        std::thread::sleep(2 * STOP_POLL);
        assert!(!waiting.is_finished());
        stop.store(true, Ordering::Relaxed);
        assert!(waiting.join().expect("no panic").is_empty());
    });
    assert_eq!(film.samples(), 0);
}
