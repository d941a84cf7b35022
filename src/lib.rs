//! Huygens: a data-oriented wavefront path tracer for CPUs.
//!
//! Paths live in structure-of-arrays queues and move through separate stages; see
//! `ARCHITECTURE.md`. A render, as a library user writes it:
//!
//! ```no_run
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! use huygens::{film::Film, geometry::Geometry, scene, settings::Settings, wave};
//! let scene = scene::load("scenes/cornell-box.toml".as_ref())?;
//! let geometry = Geometry::of(&scene, scene.settings.bvh);
//! let settings = Settings { spp: 16, ..scene.settings.clone() };
//! let film = Film::new(scene.film.width, scene.film.height, settings.tile);
//! let stats = wave::render(&scene, &geometry, &settings, &film, &wave::Control::default());
//! println!("{} samples in {} s", stats.samples, stats.seconds);
//! # Ok(())
//! # }
//! ```

pub mod accuracy;
pub mod effects;
pub mod estimate;
pub mod film;
pub mod geometry;
mod pages;
pub mod processor;
pub mod profile;
pub mod reference;
pub mod resident;
pub mod scene;
pub mod settings;
pub mod throughput;
pub mod wave;
