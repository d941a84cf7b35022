//! Intersect and occlude: the two stages that ask the geometry.
//!
//! Intersect. In: paths. Out: hits, item by item.
//! Occlude. In: occlusion rays. Out: light added to the samples of those that met nothing.
//!
//! A ray that cannot be traced (see [`untraceable`]) is reported and carries nothing from there on.

use super::account::Stage;
use super::branch::Slots;
use super::queue::Queue;
use super::slowed;
use crate::film::SampleBuffer;
use crate::geometry::Geometry;
use huygens_kernels::emission::unoccluded;
use huygens_kernels::levels::Everything;
use huygens_kernels::opacity::{Opacities, There};
use huygens_kernels::queues::{MARKS, OcclusionMut, PathHitsMut, PathsMut, ShadowsMut};
use huygens_kernels::rays::{Hits, Rays, Segments, untraceable};

/// What rays meet.
#[derive(Clone, Copy)]
pub(crate) struct Obstacles<'a> {
    pub(crate) geometry: &'a Geometry,
    /// Where some surfaces are not wholly there.
    pub(crate) opacities: Option<&'a Opacities<'a>>,
    /// The rays' moments, where something moves.
    pub(crate) times: Option<&'a [f32]>,
}

/// Ends of the words that name a path's rays for partial opacity, beside their bounce: none that
/// mixtures use, which count from 0. Branches of one sample share the names of their occlusion rays,
/// which leaves the mean of their sum what it is.
const CLOSEST: u32 = 0xfe;
/// See [`CLOSEST`].
const OCCLUSION: u32 = 0xff;

/// Finds the closest hit of each path's ray. `lost` is called with the slot of each path whose ray
/// cannot be traced; it goes on as one that left the scene with a throughput of 0.
pub(crate) fn intersect(
    obstacles: Obstacles,
    paths: &mut Queue<PathsMut<'static>>,
    hits: &mut Queue<PathHitsMut<'static>>,
    mut lost: impl FnMut(u32),
) {
    let geometry = obstacles.geometry;
    let n = paths.len();
    let mut places = Vec::new();
    let view = paths.view();
    untraceable(n, view.origin, view.direction, |i| places.push(i));
    for i in places {
        lost(paths.view().slot[i]);
        let path = paths.view_mut();
        for c in 0..3 {
            path.throughput[c][i] = 0.0;
            path.direction[c][i] = 0.0;
        }
        path.pdf[i] = 1.0;
    }
    let view = paths.view();
    let out = hits.view_mut();
    let rays = Rays {
        len: n,
        origin: view.origin,
        direction: view.direction,
        leaves: view.leaves,
    };
    let found = Hits {
        primitive: out.primitive,
        t: out.t,
        u: out.u,
        v: out.v,
    };
    let name = |i: usize| {
        let which = !((view.bounces[i] & !MARKS) << 8 | CLOSEST);
        [view.pixel[i], view.sample[i], which]
    };
    match (obstacles.opacities, obstacles.times) {
        (None, None) => geometry.closest(rays, found),
        (None, times) => geometry.closest_among(&Everything, times, rays, found),
        (Some(opacities), times) => {
            geometry.closest_among(&There { opacities, name }, times, rays, found);
        }
    }
    hits.set_len(n);
}

/// Answers the occlusion rays and adds the light of the free ones. `lost` is called with the slot of
/// each that cannot be traced, `dropped` with that of each whose light is not finite.
pub(crate) fn occlude(
    obstacles: Obstacles,
    slots: Slots,
    shadows: &mut Queue<ShadowsMut<'static>>,
    occlusion: &mut Queue<OcclusionMut<'static>>,
    samples: &mut SampleBuffer,
    mut lost: impl FnMut(u32),
    dropped: impl FnMut(u32),
) {
    let geometry = obstacles.geometry;
    let n = shadows.len();
    let mut places = Vec::new();
    let view = shadows.view();
    untraceable(n, view.origin, view.direction, |i| places.push(i));
    for i in places {
        lost(shadows.view().slot[i]);
        for column in shadows.view_mut().radiance {
            column[i] = 0.0;
        }
    }
    let view = shadows.view();
    let segments = Segments {
        len: n,
        origin: view.origin,
        direction: view.direction,
        t_max: view.t_max,
        leaves: view.leaves,
        reaches: view.reaches,
    };
    let answers = occlusion.view_mut().occluded;
    let name = |i: usize| {
        let (x, y, sample) = slots.sample_of(view.slot[i]);
        [x | y << 16, sample, !(view.bounces[i] << 8 | OCCLUSION)]
    };
    for _ in 0..slowed::times(Stage::Occlude) {
        match (obstacles.opacities, obstacles.times) {
            (None, None) => geometry.occluded(segments, answers),
            (None, times) => geometry.occluded_among(&Everything, times, segments, answers),
            (Some(opacities), times) => {
                geometry.occluded_among(&There { opacities, name }, times, segments, answers);
            }
        }
    }
    occlusion.set_len(n);
    unoccluded(
        n,
        occlusion.view().occluded,
        view.slot,
        view.radiance,
        &mut samples.columns(),
        dropped,
    );
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{Film, Job};
    use huygens_kernels::rays::NO_PRIMITIVE;

    #[test]
    fn light_along_a_segment_that_cannot_be_traced_is_lost_and_reported() {
        let mut shadows = Queue::<ShadowsMut>::new(8);
        for i in 0..4 {
            let row = shadows.view_mut();
            for c in 0..3 {
                row.origin[c][i] = 0.0;
                row.direction[c][i] = 1.0;
                row.radiance[c][i] = 2.0;
            }
            row.t_max[i] = 1.0;
            row.leaves[i] = NO_PRIMITIVE;
            row.reaches[i] = NO_PRIMITIVE;
            row.slot[i] = 3 - i as u32;
        }
        shadows.view_mut().direction[1][2] = f32::NAN;
        shadows.set_len(4);
        let mut occlusion = Queue::new(8);
        let mut samples = SampleBuffer::new(8);
        let mut lost = Vec::new();
        let film = Film::new(1, 1, 16);
        let job = Job {
            tile_index: 0,
            tile: film.tiles()[0],
            first_sample: 0,
            samples: 1,
        };
        occlude(
            Obstacles {
                geometry: &Geometry::default(),
                opacities: None,
                times: None,
            },
            Slots::new(&job, 0..1, 1),
            &mut shadows,
            &mut occlusion,
            &mut samples,
            |slot| lost.push(slot),
            |_| panic!("nothing else is wrong"),
        );
        assert_eq!(lost, [1]);
        for column in &samples.radiance {
            assert_eq!(column[..4], [2.0, 0.0, 2.0, 2.0]);
        }
    }
}
