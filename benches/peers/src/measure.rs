//! One mesh: Huygens and Embree over its four sets of rays.

use crate::agree::{Agreement, differences};
use crate::catalogue::Subject;
use crate::embree::{Device, Packets, Quality, Scene, Single, Stream};
use crate::ours::Ours;
use crate::queue::{Closest, Found, Occluded, Queue};
use crate::rounds::{Timings, Variant};
use crate::sets::{Set, Sets};
use huygens::geometry::Preset;
use std::cell::RefCell;

/// What Huygens is called in timings.
pub(crate) const OURS: &str = "ours";
/// What Huygens' tree of the `best` preset is called.
pub(crate) const BEST: &str = "best";
/// What Huygens is compared with: column heads of the table. Packets are for camera rays alone.
///
/// There is no robust HIGH: in robust mode Embree 3.13 makes no spatial splits whatever the quality
/// (measured: the same bytes, build times and speed as MEDIUM).
pub(crate) const PEERS: [&str; 7] = [
    "robust",
    "default",
    "HIGH",
    "robust stream",
    "stream",
    "robust packets",
    "packets",
];

/// What is known of one mesh afterwards.
pub(crate) struct Measured {
    pub(crate) name: &'static str,
    pub(crate) triangles: usize,
    /// Bytes a triangle of tree and leaves: ours, Embree's robust, default and HIGH.
    pub(crate) bytes: [f64; 4],
    /// Timings by set.
    pub(crate) timings: Vec<(&'static str, Timings)>,
    /// Agreement with Embree robust and default, by closest-hit set.
    pub(crate) agreement: Vec<(&'static str, [Agreement; 2])>,
    /// Shadow rays that we call blocked and Embree (robust, default) free, and the reverse.
    pub(crate) shadows: [(usize, usize); 2],
}

/// The builds of Embree over one mesh.
struct Scenes<'d> {
    plain: Scene<'d>,
    robust: Scene<'d>,
    high: Scene<'d>,
}

impl<'d> Scenes<'d> {
    fn build(device: &'d Device, subject: &Subject) -> Result<Self, String> {
        let build = |quality, robust| {
            Scene::prepare(device, &subject.mesh, quality, robust).and_then(Scene::commit)
        };
        Ok(Self {
            plain: build(Quality::Medium, false)?,
            robust: build(Quality::Medium, true)?,
            high: build(Quality::High, false)?,
        })
    }
}

/// Measures `subject` with queues of `n` rays in so many rounds.
///
/// # Errors
/// If Embree fails, or the scene gives no rays.
pub(crate) fn measure(
    subject: &Subject,
    n: usize,
    warm_up: usize,
    rounds: usize,
    threads: usize,
) -> Result<Measured, String> {
    let device = Device::new(threads)?;
    let scenes = Scenes::build(&device, subject)?;
    let ours = Ours::build(&subject.mesh, Preset::default());
    let sets = Sets::make(subject, &ours, n, warm_up)?;
    let both = [
        (OURS, &ours),
        (BEST, &Ours::build(&subject.mesh, Preset::Best)),
    ];
    let mut timings = Vec::new();
    let mut agreement = Vec::new();
    for (name, set) in [("camera", &sets.camera), ("b1", &sets.b1), ("b2", &sets.b2)] {
        timings.push((name, closest(set, both, &scenes, rounds)));
        let queue = &set.queue;
        let found = |tracer: &dyn Closest| {
            let mut found = Found::new(queue.len());
            tracer.closest(queue, &mut found);
            found
        };
        let first = found(&ours);
        let judge = |scene| Agreement::judge(&subject.mesh, queue, &first, &found(&Single(scene)));
        agreement.push((name, [judge(&scenes.robust), judge(&scenes.plain)]));
    }
    timings.push(("sh1", occluded(&sets.sh1, both, &scenes, rounds)));
    let sh1 = &sets.sh1.queue;
    let blocked = |tracer: &dyn Occluded| {
        let mut blocked = vec![0; sh1.t_max.len()];
        tracer.occluded(sh1, &mut blocked);
        blocked
    };
    let first = blocked(&ours);
    let differ = |scene| differences(sh1.len(), &first, &blocked(&Single(scene)));
    let each = |bytes: usize| bytes as f64 / subject.mesh.triangles() as f64;
    Ok(Measured {
        name: subject.name,
        triangles: subject.mesh.triangles(),
        bytes: [
            each(ours.bytes()),
            each(scenes.robust.bytes),
            each(scenes.plain.bytes),
            each(scenes.high.bytes),
        ],
        timings,
        agreement,
        shadows: [differ(&scenes.robust), differ(&scenes.plain)],
    })
}

/// What answers queues of both kinds.
trait Both: Closest + Occluded {}

impl<T: Closest + Occluded> Both for T {}

/// Embree's forms for rays that go anywhere.
fn peers<'a>(scenes: &'a Scenes) -> [(&'static str, Box<dyn Both + 'a>); 5] {
    [
        ("robust", Box::new(Single(&scenes.robust))),
        ("default", Box::new(Single(&scenes.plain))),
        ("HIGH", Box::new(Single(&scenes.high))),
        ("robust stream", Box::new(Stream(&scenes.robust))),
        ("stream", Box::new(Stream(&scenes.plain))),
    ]
}

fn closest(set: &Set, ours: [(&'static str, &Ours); 2], scenes: &Scenes, rounds: usize) -> Timings {
    let peers = peers(scenes);
    let packets = [&scenes.robust, &scenes.plain].map(Packets);
    let mut tracers: Vec<(&str, &dyn Closest)> = Vec::new();
    tracers.extend(ours.map(|(name, ours)| (name, ours as &dyn Closest)));
    tracers.extend(
        peers
            .iter()
            .map(|(name, peer)| (*name, &**peer as &dyn Closest)),
    );
    if set.queue.coherent {
        tracers.push(("robust packets", &packets[0]));
        tracers.push(("packets", &packets[1]));
    }
    let found = RefCell::new(Found::new(set.queue.len()));
    turns(set, rounds, &tracers, |tracer, rays| {
        tracer.closest(rays, &mut found.borrow_mut());
    })
}

fn occluded(
    set: &Set,
    ours: [(&'static str, &Ours); 2],
    scenes: &Scenes,
    rounds: usize,
) -> Timings {
    let peers = peers(scenes);
    let mut tracers: Vec<(&str, &dyn Occluded)> = Vec::new();
    tracers.extend(ours.map(|(name, ours)| (name, ours as &dyn Occluded)));
    tracers.extend(
        peers
            .iter()
            .map(|(name, peer)| (*name, &**peer as &dyn Occluded)),
    );
    let blocked = RefCell::new(vec![0; set.queue.t_max.len()]);
    turns(set, rounds, &tracers, |tracer, rays| {
        tracer.occluded(rays, &mut blocked.borrow_mut());
    })
}

/// Each tracer asked about the set in turn.
fn turns<T: ?Sized>(
    set: &Set,
    rounds: usize,
    tracers: &[(&'static str, &T)],
    ask: impl Fn(&T, &Queue),
) -> Timings {
    let ask = &ask;
    let mut variants = Vec::new();
    for &(name, tracer) in tracers {
        let on = |rays| move || ask(tracer, rays);
        variants.push(Variant {
            name,
            warm_up: Box::new(on(&set.warm_up)),
            work: Box::new(on(&set.queue)),
        });
    }
    Timings::take(set.queue.len(), rounds, variants)
}
