//! What paths carry besides, in queues of their own that run along with those of the paths, and that
//! are there only where a scene calls for them. No kernel that does not use them knows of them: a path
//! hands on what it carries when it scatters, and so the columns are moved with the paths, row by row.

use super::plan::QueuePlan;
use super::queue::Queue;
use crate::effects::Effects;
use huygens_kernels::compact::Kept;
use huygens_kernels::medium::OUTSIDE;
use huygens_kernels::queues::{MediumsMut, TimesMut, WavelengthsMut};
use huygens_kernels::soa::Layout;

/// Which of them a render needs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Carried {
    /// Wavelengths, where surfaces disperse light.
    pub(crate) wavelengths: bool,
    /// Media, where there are any.
    pub(crate) media: bool,
    /// Moments, where something moves.
    pub(crate) times: bool,
}

impl Carried {
    /// What some effects call for.
    pub(crate) fn new(effects: &Effects) -> Self {
        Self {
            wavelengths: effects.dispersion,
            media: effects.media,
            times: effects.motion,
        }
    }
}

/// The paths whose rows a set of extras goes with.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Along {
    /// Those under way.
    Paths,
    /// Those that have scattered.
    Scattered,
    /// Those that wait to branch.
    Waiting,
}

/// The columns that go along with one queue of paths.
pub(crate) struct Extras {
    along: Along,
    wavelengths: Option<Queue<WavelengthsMut<'static>>>,
    mediums: Option<Queue<MediumsMut<'static>>>,
    times: Option<Queue<TimesMut<'static>>>,
}

/// `each!(self, queue => expression)`: the expression for each queue that is there; with a second set
/// of the same render, for each pair.
macro_rules! each {
    ($extras:expr, $queue:ident => $run:expr) => {
        if let Some($queue) = &mut $extras.wavelengths {
            $run;
        }
        if let Some($queue) = &mut $extras.mediums {
            $run;
        }
        if let Some($queue) = &mut $extras.times {
            $run;
        }
    };
    ($extras:expr, $from:expr, ($queue:ident, $source:ident) => $run:expr) => {
        if let (Some($queue), Some($source)) = (&mut $extras.wavelengths, &$from.wavelengths) {
            $run;
        }
        if let (Some($queue), Some($source)) = (&mut $extras.mediums, &$from.mediums) {
            $run;
        }
        if let (Some($queue), Some($source)) = (&mut $extras.times, &$from.times) {
            $run;
        }
    };
}

impl Extras {
    pub(crate) fn new(carried: Carried, capacity: usize, along: Along) -> Self {
        Self {
            along,
            wavelengths: carried.wavelengths.then(|| Queue::new(capacity)),
            mediums: carried.media.then(|| Queue::new(capacity)),
            times: carried.times.then(|| Queue::new(capacity)),
        }
    }

    /// Its queues, as they are.
    pub(crate) fn queues(&self) -> impl Iterator<Item = QueuePlan> {
        let [wavelengths, mediums, times] = match self.along {
            Along::Paths => ["wavelengths", "media", "times"],
            Along::Scattered => [
                "scattered wavelengths",
                "scattered media",
                "scattered times",
            ],
            Along::Waiting => ["waiting wavelengths", "waiting media", "waiting times"],
        };
        let wavelengths = plan(wavelengths, self.wavelengths.as_ref());
        wavelengths
            .into_iter()
            .chain(plan(mediums, self.mediums.as_ref()))
            .chain(plan(times, self.times.as_ref()))
    }

    /// What the camera rays at rows `at` and on carry: all wavelengths, outside of all glass.
    pub(crate) fn start(&mut self, at: usize, n: usize) {
        if let Some(queue) = &mut self.wavelengths {
            queue.set_len(at + n);
            queue.view_mut().wavelength[at..at + n].fill(0.0);
        }
        if let Some(queue) = &mut self.mediums {
            queue.set_len(at + n);
            queue.view_mut().medium[at..at + n].fill(OUTSIDE);
        }
        // Moments are drawn when the shutter opens.
        if let Some(queue) = &mut self.times {
            queue.set_len(at + n);
        }
    }

    /// Forgets all rows.
    pub(crate) fn clear(&mut self) {
        each!(self, queue => queue.set_len(0));
    }

    /// Appends what rows of `from` carry.
    pub(crate) fn append_rows(&mut self, from: &Self, rows: &[u32]) {
        each!(self, from, (queue, source) => queue.append_rows(source, rows));
    }

    /// Appends what the `kept` lanes of `from` carry.
    pub(crate) fn append_kept(&mut self, from: &Self, kept: &[Kept]) {
        each!(self, from, (queue, source) => queue.append_kept(source, kept));
    }

    /// Wavelengths; none where nothing disperses.
    pub(crate) fn wavelengths(&self) -> &[f32] {
        match &self.wavelengths {
            Some(queue) => queue.view().wavelength,
            None => &[],
        }
    }

    /// The medium of each path; none where there are no media.
    pub(crate) fn mediums(&self) -> Option<&[u32]> {
        self.mediums.as_ref().map(|queue| queue.view().medium)
    }

    /// The medium of each path, to be written.
    pub(crate) fn mediums_mut(&mut self) -> Option<&mut [u32]> {
        self.mediums.as_mut().map(|queue| queue.view_mut().medium)
    }

    /// The moment of each path; none where nothing moves.
    pub(crate) fn times(&self) -> Option<&[f32]> {
        self.times.as_ref().map(|queue| queue.view().time)
    }

    /// The moment of each path, to be written.
    pub(crate) fn times_mut(&mut self) -> Option<&mut [f32]> {
        self.times.as_mut().map(|queue| queue.view_mut().time)
    }

    /// Wavelengths, to be written.
    pub(crate) fn wavelengths_mut(&mut self) -> Option<WavelengthsMut<'_>> {
        self.wavelengths.as_mut().map(Queue::view_mut)
    }
}

fn plan<L: Layout>(name: &'static str, queue: Option<&Queue<L>>) -> Option<QueuePlan> {
    queue.and_then(|queue| QueuePlan::of(name, queue))
}
