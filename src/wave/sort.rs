//! Sort: which stage each hit goes to next.
//!
//! In: paths and their hits. Out: index lists, in the paths' order. One pass: the lists of this
//! stage are few, and a path that meets an emissive surface goes to two of them.

use super::account::Stage;
use super::plan::QueuePlan;
use super::setup::Setup;
use super::tally::{Tally, for_each_run};
use huygens_kernels::bare::{COMPLETE, called_for};
use huygens_kernels::bsdf;
use huygens_kernels::cost::Cost;
use huygens_kernels::lanes::LANES;
use huygens_kernels::medium::IN_MEDIUM;
use huygens_kernels::prefetch;
use huygens_kernels::queues::{LAST_RAY, Listed, PathHits, Paths};
use huygens_kernels::rays::NO_PRIMITIVE;

/// Bytes a path: primitive, bounces and material.
pub(crate) const READ: Cost = Cost::new(12, 0);
/// Bytes an entry of a list.
pub(crate) const WRITTEN: Cost = Cost::new(0, 4);

/// How many paths ahead a triangle's material is asked for.
const AHEAD: usize = 32;

/// Indices into the path queue, with room for one vector of padding.
pub(crate) struct IndexList {
    indices: Vec<u32>,
    len: usize,
    /// Items before the run that is being sorted.
    before: usize,
    /// Items by bounce.
    pub(crate) tally: Tally,
}

impl IndexList {
    fn new(capacity: usize) -> Self {
        Self {
            indices: vec![0; capacity + LANES],
            len: 0,
            before: 0,
            tally: Tally::default(),
        }
    }

    fn plan(&self, name: &'static str) -> QueuePlan {
        QueuePlan::list(name, self.indices.len() - LANES)
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
            material: None,
            times: None,
        }
    }

    /// The indices, padded to whole vectors by repetitions of the last one.
    pub(crate) fn padded(&self) -> &[u32] {
        &self.indices
    }

    /// The indices, without padding.
    pub(crate) fn indices(&self) -> &[u32] {
        &self.indices[..self.len]
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
    /// Paths at surfaces that scatter, by shader.
    pub(crate) scatter: Vec<IndexList>,
    /// The material that each path met, where mixtures may have to be drawn from.
    met: Option<Vec<u32>>,
    /// Whether items are counted by bounce.
    tallied: bool,
}

/// What the lists are for in this render.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wanted {
    /// Whether the sky is looked at.
    pub(crate) sky: bool,
    /// Whether emission is looked at.
    pub(crate) emission: bool,
    /// Whether only light that next-event estimation cannot have found is looked at: along rays of
    /// infinite pdf.
    pub(crate) unsampled_only: bool,
}

impl Wanted {
    /// Surfaces alone.
    pub(crate) const SURFACES: Self = Self {
        sky: false,
        emission: false,
        unsampled_only: false,
    };
}

/// Where a material's surfaces go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Route {
    /// Whether they emit.
    pub(crate) emits: bool,
    /// Their list among [`Lists::scatter`].
    pub(crate) list: u8,
}

/// Where all materials' surfaces go.
#[derive(Clone, Debug)]
pub(crate) struct Routes {
    /// By material.
    of: Vec<Route>,
    /// Where all go, if they go the same way: then nobody needs to look up a triangle's material, which
    /// in a large mesh means waiting for memory.
    only: Option<Route>,
}

impl Routes {
    /// `of` is indexed by material; with mixtures, which are drawn by it, it is always looked up.
    pub(crate) fn new(of: Vec<Route>, mixtures: bool) -> Self {
        let first = of.first().copied().filter(|_| !mixtures);
        let only = first.filter(|first| of.iter().all(|route| route == first));
        Self { of, only }
    }
}

impl Lists {
    /// The lists that a render needs; `tallied` if their items are to be counted by bounce.
    pub(crate) fn new(setup: &Setup, tallied: bool) -> Self {
        let Setup {
            capacity, wanted, ..
        } = *setup;
        let mixed = setup.mixtures.is_some();
        Self {
            tallied,
            met: mixed.then(|| vec![0; capacity]),
            sky: IndexList::new(if wanted.sky { capacity } else { 0 }),
            emission: IndexList::new(if wanted.emission { capacity } else { 0 }),
            scatter: setup
                .shaders
                .iter()
                .map(|_| IndexList::new(capacity))
                .collect(),
        }
    }

    /// Its lists, as queues.
    pub(crate) fn queues(&self, setup: &Setup) -> Vec<QueuePlan> {
        let mut queues = Vec::new();
        if setup.wanted.sky {
            queues.push(self.sky.plan("sky list"));
        }
        if setup.wanted.emission {
            queues.push(self.emission.plan("emission list"));
        }
        if let Some(met) = &self.met {
            queues.push(QueuePlan::list("materials met", met.len()));
        }
        let scatter = setup.shaders.iter().zip(&self.scatter);
        queues.extend(scatter.map(|(&shader, list)| list.plan(Stage::Scatter(shader).name())));
        queues
    }

    fn all(&mut self) -> impl Iterator<Item = &mut IndexList> {
        [&mut self.sky, &mut self.emission]
            .into_iter()
            .chain(&mut self.scatter)
    }

    /// Items by bounce, all lists together.
    pub(crate) fn tally(&mut self) -> Tally {
        let mut lists = self.all();
        let first = lists
            .next()
            .map(|list| list.tally.clone())
            .unwrap_or_default();
        lists.fold(first, |sum, list| sum.plus(&list.tally))
    }

    /// The paths at surfaces of shader number `list`.
    pub(crate) fn scatter<'a>(
        &'a self,
        list: usize,
        paths: Paths<'a>,
        hits: PathHits<'a>,
    ) -> Listed<'a> {
        Listed {
            material: self.met.as_deref(),
            ..self.scatter[list].of(paths, hits)
        }
    }

    /// Sorts the first `n` paths.
    pub(crate) fn sort(
        &mut self,
        n: usize,
        paths: Paths,
        hits: PathHits,
        setup: &Setup,
        wanted: Wanted,
    ) {
        let triangles = &setup.tables.triangles;
        let far = setup.routes.only.is_none() && prefetch::is_worth_it(triangles);
        match (COMPLETE && setup.medium_list.is_some(), far) {
            (false, false) => self.sort_with::<false, false>(n, paths, hits, setup, wanted),
            (false, true) => self.sort_with::<false, true>(n, paths, hits, setup, wanted),
            (true, false) => self.sort_with::<true, false>(n, paths, hits, setup, wanted),
            (true, true) => self.sort_with::<true, true>(n, paths, hits, setup, wanted),
        }
    }

    /// `MEDIA` where paths may have been scattered before they met anything: they go to a list of their own.
    /// `FAR` where materials are worth being asked for ahead.
    fn sort_with<const MEDIA: bool, const FAR: bool>(
        &mut self,
        n: usize,
        paths: Paths,
        hits: PathHits,
        setup: &Setup,
        wanted: Wanted,
    ) {
        let medium = setup.medium_list.unwrap_or(0);
        let routes = &setup.routes;
        let triangles = &setup.tables.triangles;
        let primitives = &hits.primitive[..n];
        self.all().for_each(IndexList::clear);
        for_each_run(&paths.bounces[..n], self.tallied, |bounce, run| {
            for list in self.all() {
                list.before = list.len;
            }
            for i in run {
                let light = !wanted.unsampled_only || paths.pdf[i] == bsdf::DELTA_PDF;
                let primitive = primitives[i];
                if FAR && let Some(&later) = primitives.get(i + AHEAD) {
                    prefetch::ask_for(triangles.material, later);
                }
                if MEDIA && primitive == IN_MEDIUM {
                    self.scatter[medium].push_if(i, paths.bounces[i] & LAST_RAY == 0);
                } else if primitive == NO_PRIMITIVE {
                    self.sky.push_if(i, wanted.sky && light);
                } else {
                    let (material, mut route) = match routes.only {
                        Some(route) => (0, route),
                        None => {
                            let material = triangles.material_of(primitive);
                            (material, routes.of[material as usize])
                        }
                    };
                    self.emission
                        .push_if(i, wanted.emission && light && route.emits);
                    if let (Some(mixtures), Some(met)) =
                        (called_for(setup.mixtures.as_ref()), &mut self.met)
                    {
                        met[i] = mixtures.draw(&paths, &hits, i, material);
                        route = routes.of[met[i] as usize];
                    }
                    let list = &mut self.scatter[usize::from(route.list)];
                    list.push_if(i, paths.bounces[i] & LAST_RAY == 0);
                }
            }
            for list in self.all() {
                list.tally.add(bounce, list.len - list.before);
            }
        });
        self.all().for_each(IndexList::pad);
    }
}
