//! Which path cast an occlusion ray: asked only where rays take more from their paths than kernels
//! give them.

use huygens_kernels::lanes::padded;
use huygens_kernels::queues::Listed;

/// Writes to `rows` the rows of a list that cast the occlusion rays of these slots, padded to whole
/// vectors. Rays are in the order of their rows, at most one a row, and no two paths share a slot.
pub(crate) fn rows_of(listed: Listed, slots: &[u32], rows: &mut Vec<u32>) {
    let Listed { index, paths, .. } = listed;
    rows.clear();
    let mut row = 0;
    for &slot in slots {
        while paths.slot[index[row] as usize] != slot {
            row += 1;
        }
        rows.push(row as u32);
        row += 1;
    }
    rows.resize(padded(rows.len()), 0);
}
