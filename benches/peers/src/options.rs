//! The command line.

use crate::catalogue;
use crate::ours::WAVE;
use clap::Parser;
use std::path::PathBuf;

/// Huygens' rays beside Embree's: same meshes, same queues, interleaved in one run, by CPU seconds
/// of one thread.
///
/// A line before it, `build balanced/medium X.XX efficiency X.XX`, is of builds: see the README. The
/// last line is `median robust-ratio b2 X.XX sh1 X.XX`: how many times as fast as Embree's
/// robust mode, as medians over the meshes, second-bounce and bounce shadow rays are.
#[derive(Clone, Debug, Parser)]
#[command(name = "rays.sh", bin_name = "benches/peers/rays.sh")]
pub(crate) struct Options {
    /// A short run: four meshes, fewer rays and rounds
    #[arg(long)]
    pub(crate) quick: bool,
    /// Meshes, separated by commas
    #[arg(long, value_delimiter = ',', value_name = "NAMES", value_parser = catalogue::NAMES)]
    meshes: Vec<String>,
    /// Rays a queue, rounded up to whole waves of 4096 [default: 262144, quick: 65536]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1 << 26))]
    rays: Option<u32>,
    /// Begin each turn with caches full of another tracer's tree
    ///
    /// Otherwise a quarter as many rays of the same kind go before those that are timed.
    #[arg(long)]
    cold: bool,
    /// Rounds of each comparison [default: 5, quick: 3]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000))]
    rounds: Option<u32>,
    /// Rounds of builds; 0 leaves them out [default: 3, quick: 1]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(..=1000))]
    build_rounds: Option<u32>,
    /// Nothing but builds
    #[arg(long)]
    pub(crate) builds_only: bool,
    /// Rays of each kind in the leak check; 0 leaves it out [default: 1000000, quick: 100000]
    #[arg(long, value_name = "N")]
    leak_rays: Option<u32>,
    /// Folder of meshes that do not ship with the project
    #[arg(long, value_name = "DIR", default_value = "../shared/data")]
    pub(crate) data: PathBuf,
}

impl Options {
    fn pick(&self, given: Option<u32>, full: u32, quick: u32) -> usize {
        given.unwrap_or(if self.quick { quick } else { full }) as usize
    }

    /// Names of the meshes.
    pub(crate) fn meshes(&self) -> Vec<&str> {
        if !self.meshes.is_empty() {
            self.meshes.iter().map(String::as_str).collect()
        } else if self.quick {
            catalogue::QUICK.to_vec()
        } else {
            catalogue::NAMES.to_vec()
        }
    }

    /// Rays that each turn begins with, whole waves, none if caches are to be cold.
    pub(crate) fn warm_up(&self) -> usize {
        if self.cold {
            0
        } else {
            (self.rays() / 4).next_multiple_of(WAVE)
        }
    }

    /// Rays a queue, whole waves.
    pub(crate) fn rays(&self) -> usize {
        self.pick(self.rays, 1 << 18, 1 << 16)
            .next_multiple_of(WAVE)
    }

    /// Rounds of rays.
    pub(crate) fn rounds(&self) -> usize {
        self.pick(self.rounds, 5, 3)
    }

    /// Rounds of builds.
    pub(crate) fn build_rounds(&self) -> usize {
        self.pick(self.build_rounds, 3, 1)
    }

    /// Rays of each kind in the leak check.
    pub(crate) fn leak_rays(&self) -> usize {
        self.pick(self.leak_rays, 1_000_000, 100_000)
    }
}
