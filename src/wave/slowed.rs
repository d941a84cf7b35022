//! Kernels that do a tenth of their work twice: what `benches/verdicts.sh` tries the comparison of
//! `huygens bench` on. Compiled in by the feature `slowed` alone, and then at work only in the stage that
//! the environment names: `HUYGENS_SLOWED=intersect`, `sort`, `interact` or `occlude`.

use super::account::Stage;

/// How often a call of `stage` runs its kernel, which must leave the same behind when it is run again.
#[cfg(not(feature = "slowed"))]
#[inline(always)]
pub(super) const fn times(_stage: Stage) -> u32 {
    1
}

/// How often a call of `stage` runs its kernel: twice in every tenth call of the stage that is slowed.
#[cfg(feature = "slowed")]
pub(super) fn times(stage: Stage) -> u32 {
    use std::cell::Cell;
    use std::sync::OnceLock;
    static SLOWED: OnceLock<Option<String>> = OnceLock::new();
    thread_local! {
        static CALLS: Cell<u32> = const { Cell::new(0) };
    }
    let slowed = SLOWED.get_or_init(|| std::env::var("HUYGENS_SLOWED").ok());
    if slowed.as_deref() != Some(stage.name()) {
        return 1;
    }
    CALLS.set(CALLS.get().wrapping_add(1));
    if CALLS.get().is_multiple_of(10) { 2 } else { 1 }
}
