//! What a wave is assembled of: its stages and queues, as they would be in a render.

use super::account::Stage;
use super::queue::Queue;
use super::setup::Setup;
use super::tables::SceneTables;
use super::{Instruments, Wave};
use crate::effects::{Effect, Effects};
use crate::film::filter;
use crate::geometry::Geometry;
use crate::scene::Scene;
use crate::settings::Settings;
use huygens_kernels::soa::Layout;
use serde::Serialize;
use std::time::Instant;

/// The wave of a render.
#[derive(Clone, Debug, Serialize)]
pub struct Plan {
    /// What the scene calls for, and why.
    pub effects: Vec<Effect>,
    /// Stages, in the order in which they run.
    pub stages: Vec<&'static str>,
    /// Queues of one worker.
    pub queues: Vec<QueuePlan>,
}

/// A queue of the wave.
#[derive(Clone, Debug, Serialize)]
pub struct QueuePlan {
    /// What is in it.
    pub name: &'static str,
    /// Its columns.
    pub columns: Vec<&'static str>,
    /// Bytes of an item, all columns together.
    pub bytes_per_item: usize,
    /// Items that it has room for.
    pub capacity: usize,
}

/// The wave that [`super::render`] would assemble. It is told from one that was: nothing is listed that
/// would not be there, and nothing is there that is not listed.
#[must_use]
pub fn plan(scene: &Scene, geometry: &Geometry, settings: &Settings) -> Plan {
    let effects = Effects::of(scene, settings);
    let tables = SceneTables::new(scene, settings);
    let filter = filter::shared_table(scene.film.filter);
    let setup = Setup::new(scene, &effects, &tables, geometry, settings, filter);
    let wave = Wave::new(&setup, &Instruments::default(), Instant::now());
    Plan {
        stages: Stage::all()
            .filter(|&stage| setup.runs(stage))
            .map(Stage::name)
            .collect(),
        queues: wave.queues(),
        effects: effects.list,
    }
}

impl QueuePlan {
    /// A queue; none if it has no room.
    pub(super) fn of<L: Layout>(name: &'static str, queue: &Queue<L>) -> Option<Self> {
        (queue.capacity() > 0).then(|| Self {
            name,
            columns: L::COLUMNS.iter().map(|&(name, _)| name).collect(),
            bytes_per_item: L::WORDS * size_of::<u32>(),
            capacity: queue.capacity(),
        })
    }

    /// An index list.
    pub(super) fn list(name: &'static str, capacity: usize) -> Self {
        Self {
            name,
            columns: vec!["index"],
            bytes_per_item: size_of::<u32>(),
            capacity,
        }
    }
}
