//! Nodes and triangles that rays were tested against, counted in profiling builds (feature `visits`)
//! and not there in others.
//!
//! Counts are the thread's own and grow until they are taken. A node test is one ray against the
//! eight boxes of a node (a packet's test of one is one); a triangle test is one ray, or an unused
//! lane, against one triangle.

/// Whether this build counts.
pub const COUNTED: bool = cfg!(feature = "visits");

/// Operations of a node test: eight boxes of six planes.
pub const NODE_OPERATIONS: u64 = 8 * 19;
/// Operations of a triangle test.
pub const TRIANGLE_OPERATIONS: u64 = 56;

/// What was counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Visits {
    /// Node tests.
    pub nodes: u64,
    /// Triangle tests.
    pub triangles: u64,
}

#[cfg(feature = "visits")]
thread_local! {
    static COUNTS: std::cell::Cell<Visits> = const {
        std::cell::Cell::new(Visits { nodes: 0, triangles: 0 })
    };
}

/// Adds to the thread's counts.
#[inline(always)]
pub(crate) fn add(nodes: usize, triangles: usize) {
    #[cfg(feature = "visits")]
    COUNTS.with(|counts| {
        let so_far = counts.get();
        counts.set(Visits {
            nodes: so_far.nodes + nodes as u64,
            triangles: so_far.triangles + triangles as u64,
        });
    });
    #[cfg(not(feature = "visits"))]
    let _ = (nodes, triangles);
}

/// The thread's counts since they were last taken: zeros where nothing is counted.
#[must_use]
pub fn take() -> Visits {
    #[cfg(feature = "visits")]
    return COUNTS.take();
    #[cfg(not(feature = "visits"))]
    Visits::default()
}
