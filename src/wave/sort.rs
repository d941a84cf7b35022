//! Sort: which stage each hit goes to next.
//!
//! In: paths and their hits. Out: index lists, in the paths' order. One pass: the lists of this
//! stage are few, and a path that meets an emissive surface goes to two of them.

use super::tally::{Tally, for_each_run};
use huygens_kernels::cost::Cost;
use huygens_kernels::lanes::LANES;
use huygens_kernels::queues::{LAST_RAY, Listed, PathHits, Paths};
use huygens_kernels::rays::NO_PRIMITIVE;

/// Bytes a path: primitive, bounces and material.
pub(crate) const READ: Cost = Cost::new(12, 0);
/// Bytes an entry of a list.
pub(crate) const WRITTEN: Cost = Cost::new(0, 4);

/// Indices into the path queue, with room for one vector of padding.
pub(crate) struct IndexList {
    indices: Vec<u32>,
    len: usize,
    /// Items by bounce.
    pub(crate) tally: Tally,
}

impl IndexList {
    fn new(capacity: usize) -> Self {
        Self {
            indices: vec![0; capacity + LANES],
            len: 0,
            tally: Tally::default(),
        }
    }

    /// Items.
    pub(crate) fn len(&self) -> usize {
        self.len
    }

    /// The listed paths, padded to whole vectors by repetitions of the last one.
    pub(crate) fn of<'a>(&'a self, paths: Paths<'a>, hits: PathHits<'a>) -> Listed<'a> {
        Listed {
            index: &self.indices,
            len: self.len,
            paths,
            hits,
        }
    }

    fn clear(&mut self) {
        self.len = 0;
        self.tally = Tally::default();
    }

    /// Writes `index` behind the last item, to be counted or overwritten: no branch.
    #[inline(always)]
    fn push_if(&mut self, index: usize, wanted: bool) {
        self.indices[self.len] = index as u32;
        self.len += usize::from(wanted);
    }

    fn pad(&mut self) {
        if self.len > 0 {
            let last = self.indices[self.len - 1];
            self.indices[self.len..self.len + LANES].fill(last);
        }
    }
}

/// Where hits go.
pub(crate) struct Lists {
    /// Paths that left the scene, if the sky shines.
    pub(crate) sky: IndexList,
    /// Paths at surfaces that emit.
    pub(crate) emission: IndexList,
    /// Paths at surfaces that scatter.
    pub(crate) scatter: IndexList,
}

/// What the lists are for in this render.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wanted {
    /// Whether the sky is looked at.
    pub(crate) sky: bool,
    /// Whether emission is looked at.
    pub(crate) emission: bool,
    /// Whether it is looked at only straight from the camera.
    pub(crate) camera_only: bool,
}

impl Lists {
    pub(crate) fn new(capacity: usize) -> Self {
        Self {
            sky: IndexList::new(capacity),
            emission: IndexList::new(capacity),
            scatter: IndexList::new(capacity),
        }
    }

    /// Items by bounce, all lists together.
    pub(crate) fn tally(&self) -> Tally {
        self.sky
            .tally
            .clone()
            .plus(&self.emission.tally)
            .plus(&self.scatter.tally)
    }

    /// Sorts the first `n` paths. `emits` is indexed by material.
    pub(crate) fn sort(
        &mut self,
        n: usize,
        paths: Paths,
        hits: PathHits,
        material: &[u32],
        emits: &[bool],
        wanted: Wanted,
    ) {
        let lists = [&mut self.sky, &mut self.emission, &mut self.scatter];
        lists.into_iter().for_each(IndexList::clear);
        for_each_run(&paths.bounces[..n], |bounce, run| {
            let before = [self.sky.len, self.emission.len, self.scatter.len];
            let light = !wanted.camera_only || bounce == 0;
            for i in run {
                let primitive = hits.primitive[i];
                if primitive == NO_PRIMITIVE {
                    self.sky.push_if(i, wanted.sky && light);
                } else {
                    let emitting = emits[material[primitive as usize] as usize];
                    self.emission
                        .push_if(i, wanted.emission && light && emitting);
                    self.scatter.push_if(i, paths.bounces[i] & LAST_RAY == 0);
                }
            }
            let lists = [&mut self.sky, &mut self.emission, &mut self.scatter];
            for (list, before) in lists.into_iter().zip(before) {
                list.tally.add(bounce, list.len - before);
            }
        });
        let lists = [&mut self.sky, &mut self.emission, &mut self.scatter];
        lists.into_iter().for_each(IndexList::pad);
    }
}
