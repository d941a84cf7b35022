//! Adding radiance to the samples of a job.
//!
//! Each path owns one slot, and a stage adds at most once to a slot, so lanes never collide and the
//! order of a slot's additions is the order of its path's events. Values that are not finite are
//! left out and reported. Read and written: 12 bytes of the slot an item.

use crate::lanes::{LANES, Mask, Ux};
use crate::vec3::{ColumnsMut, Vec3x};

/// Adds `value` to the slots in the lanes of `mask`. Returns the lanes left out because `value` was
/// not finite there, as a bit mask: almost always 0.
#[inline(always)]
#[must_use]
pub fn add(radiance: &mut ColumnsMut, slot: Ux, value: Vec3x, mask: Mask) -> u32 {
    let finite = value.is_finite();
    let mut lanes = (mask & finite).to_bitmask();
    let slots = slot.to_array();
    while lanes != 0 {
        let lane = lanes.trailing_zeros() as usize % LANES;
        lanes &= lanes - 1;
        let at = slots[lane] as usize;
        let [r, g, b] = value.lane(lane);
        radiance[0][at] += r;
        radiance[1][at] += g;
        radiance[2][at] += b;
    }
    mask.to_bitmask() & !finite.to_bitmask()
}

/// Calls `dropped` with the slot of each lane in `lanes`.
#[inline(always)]
pub fn report(mut lanes: u32, slot: Ux, dropped: &mut impl FnMut(u32)) {
    while lanes != 0 {
        dropped(slot.as_array()[lanes.trailing_zeros() as usize % LANES]);
        lanes &= lanes - 1;
    }
}
