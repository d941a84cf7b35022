//! Spheres on the upper level.

use super::Filter;
use super::ask::Ask;
use crate::sphere::{self, SphereBlock};

/// Tests a ray (its place in the view, its origin, and its direction in the kernel's units) against a
/// block of spheres: of each the first hit that counts.
#[inline(always)]
pub(crate) fn roll<Q: Ask, F: Filter>(
    (id, o, d): (usize, [f32; 3], [f32; 3]),
    state: &mut Q::State,
    block: &SphereBlock,
    filter: &F,
) {
    let leaves = Q::leaves(state);
    let met = sphere::meet(block, o, d, leaves);
    for lane in 0..sphere::BLOCK {
        let primitive = block.primitive.as_array()[lane];
        // Where everything is there, nothing behind the first hit counts.
        let hits = if F::ASKS { 2 } else { 1 };
        for t in [met.t[lane], met.behind[lane]].into_iter().take(hits) {
            let near = t as f32;
            let hit = near > 0.0 && near < f32::INFINITY;
            if !hit || !Q::wants(state, primitive, near) || Q::spares(state, primitive) {
                break;
            }
            let at = || sphere::normal_at(block, lane, o, d, t);
            if F::ASKS {
                let [u, v] = at();
                if !filter.accepts(id, primitive, u, v) {
                    continue;
                }
            }
            Q::take(state, primitive, near, at);
            break;
        }
    }
}
