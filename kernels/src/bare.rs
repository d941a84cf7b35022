//! Builds without what only some scenes call for: the feature `bare`, there to measure what it costs all
//! other scenes that the rest is compiled in (`benches/effects`).
//!
//! What stays: a pinhole, triangles, plain diffuse surfaces, emission, a sky of one gradient, next-event
//! estimation by power or along a tree.

/// False in such a build.
pub const COMPLETE: bool = cfg!(not(feature = "bare"));

/// `what` a scene may call for; in a bare build nothing, so that the compiler leaves out all that it would
/// be for.
#[inline(always)]
#[must_use]
pub fn called_for<T>(what: Option<T>) -> Option<T> {
    if COMPLETE { what } else { None }
}
