//! Build times on the wall clock, with one and with two threads: ours beside Embree's.

use crate::catalogue::Subject;
use crate::clock::wall_and_process;
use crate::embree::{Device, Quality, Scene};
use crate::ours::Ours;
use crate::statistics::{Spread, median, spread};

/// What one number of threads reached.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Builds {
    pub(crate) threads: usize,
    /// Millions of triangles a second.
    pub(crate) ours: f64,
    pub(crate) medium: f64,
    pub(crate) high: f64,
    /// How many times as fast as `medium` ours is, by rounds, on the wall.
    pub(crate) ratio: Spread,
    /// The same by CPU time, all threads together: what a busy machine still lets one see.
    pub(crate) cpu_ratio: f64,
    /// CPU seconds a second of ours and of `medium`: how many threads were really at work.
    pub(crate) busy: [f64; 2],
}

/// Builds each in `rounds` rounds; Embree's HIGH, which takes longest, in the first alone.
///
/// # Errors
/// If Embree or a pool of threads cannot be had.
pub(crate) fn measure(subject: &Subject, threads: usize, rounds: usize) -> Result<Builds, String> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
    let pool = pool.build().map_err(|e| e.to_string())?;
    let device = Device::new(threads)?;
    let millions = subject.mesh.triangles() as f64 / 1e6;
    let ours = || {
        let (wall, cpu, ours) = wall_and_process(|| pool.install(|| Ours::build(&subject.mesh)));
        drop(ours);
        (wall, cpu)
    };
    let embree = |quality| {
        let scene = Scene::prepare(&device, &subject.mesh, quality, false)?;
        let (wall, cpu, scene) = wall_and_process(|| scene.commit());
        scene.map(|_| (wall, cpu))
    };
    let (high, _) = embree(Quality::High)?;
    let (mut first, mut second) = (Vec::new(), Vec::new());
    for _ in 0..rounds {
        first.push(ours());
        second.push(embree(Quality::Medium)?);
    }
    let rate = |times: &[(f64, f64)]| {
        let rates: Vec<f64> = times.iter().map(|(wall, _)| millions / wall).collect();
        median(&rates)
    };
    let busy = |times: &[(f64, f64)]| {
        let shares: Vec<f64> = times.iter().map(|(wall, cpu)| cpu / wall).collect();
        median(&shares)
    };
    let pairs = || first.iter().zip(&second);
    let ratios: Vec<f64> = pairs().map(|(a, b)| b.0 / a.0).collect();
    let cpu_ratios: Vec<f64> = pairs().map(|(a, b)| b.1 / a.1).collect();
    Ok(Builds {
        threads,
        ours: rate(&first),
        medium: rate(&second),
        high: millions / high,
        ratio: spread(&ratios),
        cpu_ratio: median(&cpu_ratios),
        busy: [busy(&first), busy(&second)],
    })
}
