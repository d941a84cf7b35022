//! What a walk through two levels asks of each query, one hit at a time.

use crate::query::{ClosestHit, Occlusion, Prepared, Query};
use crate::rays::NO_PRIMITIVE;
use crate::slabs::PAD;

/// What a query does with one hit at a time.
pub(crate) trait Ask: Query {
    /// [`Query::start`] with what is known already: of a closest hit what stands in the answers, of an
    /// occlusion whether it stands there.
    fn begin(&mut self, i: usize) -> Option<(Prepared, Self::State)>;
    /// Ray `i` of the view.
    fn ray(&self, i: usize) -> [[f32; 3]; 2];
    /// What a hit must not lie beyond.
    fn reach(state: &Self::State) -> f32;
    /// The triangle that must not be hit, or the sphere that is left.
    fn leaves(state: &Self::State) -> u32;
    /// Whether hits of `primitive` do not count, left or not.
    fn spares(state: &Self::State, primitive: u32) -> bool;
    /// Whether a hit at `t` would change the answer.
    fn wants(state: &Self::State, primitive: u32, t: f32) -> bool;
    /// Takes it.
    fn take(state: &mut Self::State, primitive: u32, t: f32, uv: impl FnOnce() -> [f32; 2]);
}

impl Ask for ClosestHit<'_, '_> {
    #[inline(always)]
    fn begin(&mut self, i: usize) -> Option<(Prepared, Self::State)> {
        let known = self.hits.primitive[i];
        let started = self.start(i);
        // Of what cannot be traced nothing else becomes known.
        self.hits.primitive[i] = known;
        let (ray, mut state) = started?;
        if known != NO_PRIMITIVE {
            let t = ray.inward(self.hits.t[i]).min(f32::MAX);
            Self::take(&mut state, known, t, || [self.hits.u[i], self.hits.v[i]]);
        }
        Some((ray, state))
    }

    #[inline(always)]
    fn ray(&self, i: usize) -> [[f32; 3]; 2] {
        [self.rays.origin, self.rays.direction].map(|columns| columns.map(|c| c[i]))
    }

    #[inline(always)]
    fn reach(state: &Self::State) -> f32 {
        state.t
    }

    #[inline(always)]
    fn leaves(state: &Self::State) -> u32 {
        state.leaves
    }

    #[inline(always)]
    fn spares(_: &Self::State, _: u32) -> bool {
        false
    }

    #[inline(always)]
    fn wants(state: &Self::State, primitive: u32, t: f32) -> bool {
        t < state.t || (t == state.t && primitive < state.primitive)
    }

    #[inline(always)]
    fn take(state: &mut Self::State, primitive: u32, t: f32, uv: impl FnOnce() -> [f32; 2]) {
        [state.u, state.v] = uv();
        state.primitive = primitive;
        state.t = t;
        state.limit = t * (1.0 + PAD);
    }
}

impl Ask for Occlusion<'_, '_> {
    #[inline(always)]
    fn begin(&mut self, i: usize) -> Option<(Prepared, Self::State)> {
        let known = self.occluded[i];
        let started = self.start(i);
        self.occluded[i] = known;
        started.filter(|_| known == 0)
    }

    #[inline(always)]
    fn ray(&self, i: usize) -> [[f32; 3]; 2] {
        [self.segments.origin, self.segments.direction].map(|columns| columns.map(|c| c[i]))
    }

    #[inline(always)]
    fn reach(state: &Self::State) -> f32 {
        state.t_max
    }

    #[inline(always)]
    fn leaves(state: &Self::State) -> u32 {
        state.excluded[0]
    }

    #[inline(always)]
    fn spares(state: &Self::State, primitive: u32) -> bool {
        primitive == state.excluded[1]
    }

    #[inline(always)]
    fn wants(state: &Self::State, _: u32, t: f32) -> bool {
        t < state.t_max
    }

    #[inline(always)]
    fn take(state: &mut Self::State, _: u32, _: f32, _: impl FnOnce() -> [f32; 2]) {
        state.occluded = 1;
    }
}
