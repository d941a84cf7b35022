//! Build times on the wall clock, with one and with two threads: ours beside Embree's.

use crate::catalogue::Subject;
use crate::clock::{Lap, lap};
use crate::embree::{Device, Quality, Scene};
use crate::ours::Ours;
use crate::statistics::{Spread, median, spread};
use huygens::geometry::Preset;

/// Seconds that the builds of one lap take at least, all together: small meshes are built several
/// times, so that the system's count of what others do says something.
const LAP: f64 = 0.3;
/// The share of the machine that others may use in a quiet round.
const QUIET: f64 = 0.05;

/// What is built, in the order of a round: ours, then Embree's.
const OURS: [(&str, Preset); 3] = [
    ("balanced", Preset::Balanced),
    ("fast", Preset::Fast),
    ("best", Preset::Best),
];

/// What one number of threads reached.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Builds {
    pub(crate) threads: usize,
    /// Millions of triangles a second: the default preset's, `fast`, and `best`.
    pub(crate) ours: [f64; 3],
    pub(crate) medium: f64,
    pub(crate) high: f64,
    /// How many times as fast as `medium` the default is, by rounds, on the wall.
    pub(crate) ratio: Spread,
    /// The same by CPU time, all threads together: what a busy machine still lets one see.
    pub(crate) cpu_ratio: f64,
    /// Speed of the default and of `medium` over that of as many single threads, by rounds.
    pub(crate) efficiency: [Spread; 2],
    /// CPU seconds a second of ours and of `medium`: how many threads were really at work.
    pub(crate) busy: [f64; 2],
    /// Rounds in which others used next to nothing of the machine: if there are any, all that the
    /// wall clock says is of these.
    pub(crate) quiet: usize,
}

/// The laps of a round: with each number of threads, the default preset's and `medium`.
type Round = Vec<[Lap; 2]>;

/// Builds with 1 to `threads` threads in `rounds` rounds, all numbers of threads in each; `fast`,
/// `best` and Embree's HIGH, which say less, in the first alone.
///
/// # Errors
/// If Embree or a pool of threads cannot be had.
pub(crate) fn measure(
    subject: &Subject,
    threads: usize,
    rounds: usize,
) -> Result<Vec<Builds>, String> {
    let sides: Result<Vec<Side>, _> = (1..=threads).map(|n| Side::new(subject, n)).collect();
    let sides = sides?;
    let mut all: Vec<Round> = Vec::new();
    for _ in 0..rounds {
        let round: Result<Round, String> = sides
            .iter()
            .map(|side| Ok([side.ours(OURS[0].1), side.embree(Quality::Medium)?]))
            .collect();
        all.push(round?);
    }
    let cores = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let is_quiet = |round: &&Round| {
        let laps = || round.iter().flatten();
        let [others, wall] = [
            laps().map(|lap| lap.others).sum::<f64>(),
            laps().map(|lap| lap.wall).sum(),
        ];
        others < QUIET * cores as f64 * wall
    };
    let quiet: Vec<&Round> = all.iter().filter(is_quiet).collect();
    let on_the_wall = if quiet.is_empty() {
        all.iter().collect()
    } else {
        quiet.clone()
    };
    let builds = sides.iter().enumerate().map(|(k, side)| {
        let walls = |of: &dyn Fn(&Round) -> f64| -> Vec<f64> {
            on_the_wall.iter().map(|round| of(round)).collect()
        };
        let efficiency = |which: usize| {
            let one_over_all =
                |round: &Round| round[0][which].wall / (round[k][which].wall * side.threads as f64);
            spread(&walls(&one_over_all))
        };
        let rate = |lap: Lap| side.millions / lap.wall;
        let median_rate = |which: usize| median(&walls(&|round| rate(round[k][which])));
        let busy = |which: usize| {
            let share = |round: &Round| round[k][which].process / round[k][which].wall;
            median(&all.iter().map(share).collect::<Vec<_>>())
        };
        let by_cpu = all
            .iter()
            .map(|round| round[k][1].process / round[k][0].process);
        Ok(Builds {
            threads: side.threads,
            ours: [
                median_rate(0),
                rate(side.ours(OURS[1].1)),
                rate(side.ours(OURS[2].1)),
            ],
            medium: median_rate(1),
            high: rate(side.embree(Quality::High)?),
            ratio: spread(&walls(&|round| round[k][1].wall / round[k][0].wall)),
            cpu_ratio: median(&by_cpu.collect::<Vec<_>>()),
            efficiency: [efficiency(0), efficiency(1)],
            busy: [busy(0), busy(1)],
            quiet: quiet.len(),
        })
    });
    builds.collect()
}

/// Builders with so many threads.
struct Side<'a> {
    subject: &'a Subject,
    threads: usize,
    pool: rayon::ThreadPool,
    device: Device,
    millions: f64,
}

impl<'a> Side<'a> {
    fn new(subject: &'a Subject, threads: usize) -> Result<Self, String> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        Ok(Self {
            subject,
            threads,
            pool: pool.build().map_err(|e| e.to_string())?,
            device: Device::new(threads)?,
            millions: subject.mesh.triangles() as f64 / 1e6,
        })
    }

    /// What a build of ours takes. Freeing it is not part of that.
    fn ours(&self, preset: Preset) -> Lap {
        several(|| {
            let mesh = &self.subject.mesh;
            let (lap, ours) = lap(|| self.pool.install(|| Ours::build(mesh, preset)));
            drop(ours);
            Ok::<_, std::convert::Infallible>(lap)
        })
        .unwrap_or_else(|never| match never {})
    }

    fn embree(&self, quality: Quality) -> Result<Lap, String> {
        several(|| {
            let scene = Scene::prepare(&self.device, &self.subject.mesh, quality, false)?;
            let (lap, scene) = lap(|| scene.commit());
            scene.map(|_| lap)
        })
    }
}

/// The mean of as many laps as take [`LAP`], one at least.
fn several<E>(mut one: impl FnMut() -> Result<Lap, E>) -> Result<Lap, E> {
    let mut sum = one()?;
    let mut n = 1;
    while sum.wall < LAP {
        let Lap {
            wall,
            process,
            others,
        } = one()?;
        sum.wall += wall;
        sum.process += process;
        sum.others += others;
        n += 1;
    }
    let mean = |sum: f64| sum / f64::from(n);
    Ok(Lap {
        wall: mean(sum.wall),
        process: mean(sum.process),
        others: mean(sum.others),
    })
}
