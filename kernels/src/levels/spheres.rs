//! Spheres on the upper level.

use super::{Ask, Filter, Slot};
use crate::sphere::{self, SphereBlock};

/// Tests a block of spheres: of each the first hit that counts.
#[inline(always)]
pub(super) fn roll<Q: Ask, F: Filter>(slot: &mut Slot<Q::State>, block: &SphereBlock, filter: &F) {
    let leaves = Q::leaves(&slot.state);
    let (o, d) = (slot.origin, slot.direction);
    let met = sphere::meet(block, o, d, leaves);
    for lane in 0..sphere::BLOCK {
        let primitive = block.primitive.as_array()[lane];
        // Where everything is there, nothing behind the first hit counts.
        let hits = if F::ASKS { 2 } else { 1 };
        for t in [met.t[lane], met.behind[lane]].into_iter().take(hits) {
            let near = t as f32;
            let hit = near > 0.0 && near < f32::INFINITY;
            if !hit || !Q::wants(&slot.state, primitive, near) || Q::spares(&slot.state, primitive)
            {
                break;
            }
            let at = || sphere::normal_at(block, lane, o, d, t);
            if F::ASKS {
                let [u, v] = at();
                if !filter.accepts(slot.id, primitive, u, v) {
                    continue;
                }
            }
            Q::take(&mut slot.state, primitive, near, at);
            break;
        }
    }
}
