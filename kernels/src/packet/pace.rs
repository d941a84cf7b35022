//! When to try packets.

/// Twice the rays that must enter a leaf on average for a packet to pay.
const ENOUGH_LANES: u32 = 3;
/// Groups of eight rays that are not tried after a packet that did not pay: at first, and at most.
const SHORT_WAIT: u32 = 16;
const LONG_WAIT: u32 = 64;

/// Whether packets pay: where a pixel covers many triangles, its rays part ways however alike their
/// directions are, and most lanes of a packet idle in most leaves.
#[derive(Default)]
pub(super) struct Pace {
    /// Of the last packets, the older the less.
    recent: UseOfLanes,
    /// Groups of rays to leave to flight before the next packet is tried.
    wait: u32,
    /// How many to leave next time.
    next: u32,
}

impl Pace {
    #[inline(always)]
    pub(super) fn try_packet(&mut self) -> bool {
        let go = self.wait == 0;
        self.wait -= u32::from(!go);
        go
    }

    /// Waits after packets that did not pay, and twice as long each time in a row.
    #[inline(always)]
    pub(super) fn learn(&mut self, lanes: UseOfLanes) {
        let recent = &mut self.recent;
        recent.leaves += lanes.leaves;
        recent.inside += lanes.inside;
        if 2 * recent.inside < ENOUGH_LANES * recent.leaves {
            self.wait = self.next.clamp(SHORT_WAIT, LONG_WAIT);
            self.next = 2 * self.wait;
            *recent = UseOfLanes::default();
        } else {
            self.next = 0;
            recent.leaves -= recent.leaves / 4;
            recent.inside -= recent.inside / 4;
        }
    }
}

/// Leaves that a packet came to, and rays that entered them.
#[derive(Clone, Copy, Default)]
pub(crate) struct UseOfLanes {
    pub(crate) leaves: u32,
    pub(crate) inside: u32,
}
