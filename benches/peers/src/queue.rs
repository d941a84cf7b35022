//! Queues of rays and what they met, as columns: the form in which the wave asks.

use glam::Vec3;
use huygens_kernels::lanes::padded;
use huygens_kernels::rays::{Hits, NO_PRIMITIVE, Rays, Segments};
use std::ops::Range;

/// Rays, or segments where `t_max` is finite. Columns are as long as a whole number of vectors.
#[derive(Clone, Debug, Default)]
pub(crate) struct Queue {
    len: usize,
    /// Origins, world space.
    pub(crate) origin: [Vec<f32>; 3],
    /// Unit directions, to rounding.
    pub(crate) direction: [Vec<f32>; 3],
    /// Upper end of the ray parameter.
    pub(crate) t_max: Vec<f32>,
    /// The triangle that the ray leaves, or `NO_PRIMITIVE`.
    pub(crate) leaves: Vec<u32>,
    /// `NO_PRIMITIVE`: no light here is part of a mesh.
    reaches: Vec<u32>,
    /// Whether neighbours in the queue are neighbours in space: what Embree is told of it.
    pub(crate) coherent: bool,
}

impl Queue {
    /// An empty queue with room for `n`.
    pub(crate) fn with_capacity(n: usize) -> Self {
        let column = || Vec::with_capacity(padded(n));
        Self {
            origin: [column(), column(), column()],
            direction: [column(), column(), column()],
            t_max: column(),
            leaves: Vec::with_capacity(padded(n)),
            reaches: Vec::with_capacity(padded(n)),
            ..Self::default()
        }
    }

    /// Rays in the queue.
    pub(crate) fn len(&self) -> usize {
        self.len
    }

    /// Appends a ray.
    pub(crate) fn push(&mut self, origin: Vec3, direction: Vec3, t_max: f32, leaves: u32) {
        for axis in 0..3 {
            self.origin[axis].push(origin[axis]);
            self.direction[axis].push(direction[axis]);
        }
        self.t_max.push(t_max);
        self.leaves.push(leaves);
        self.reaches.push(NO_PRIMITIVE);
        self.len += 1;
    }

    /// Pads the columns with copies of the last ray, once all are there.
    pub(crate) fn finish(mut self) -> Self {
        let n = padded(self.len);
        let pad = |column: &mut Vec<f32>| column.resize(n, column.last().copied().unwrap_or(0.0));
        self.origin.iter_mut().for_each(pad);
        self.direction.iter_mut().for_each(pad);
        pad(&mut self.t_max);
        self.leaves.resize(n, NO_PRIMITIVE);
        self.reaches.resize(n, NO_PRIMITIVE);
        self
    }

    /// Origin of ray `i`.
    pub(crate) fn origin(&self, i: usize) -> Vec3 {
        Vec3::from_array(self.origin.each_ref().map(|column| column[i]))
    }

    /// Direction of ray `i`.
    pub(crate) fn direction(&self, i: usize) -> Vec3 {
        Vec3::from_array(self.direction.each_ref().map(|column| column[i]))
    }

    /// Where the vectors of `range` lie; it starts at a whole number of vectors.
    fn span(range: &Range<usize>) -> Range<usize> {
        range.start..range.start + padded(range.len())
    }

    /// The rays of `range` as the closest-hit seam takes them.
    pub(crate) fn rays(&self, range: Range<usize>) -> Rays<'_> {
        let span = Self::span(&range);
        Rays {
            len: range.len(),
            origin: self.origin.each_ref().map(|c| &c[span.clone()]),
            direction: self.direction.each_ref().map(|c| &c[span.clone()]),
            leaves: &self.leaves[span],
        }
    }

    /// The rays of `range` as the occlusion seam takes them.
    pub(crate) fn segments(&self, range: Range<usize>) -> Segments<'_> {
        let span = Self::span(&range);
        Segments {
            len: range.len(),
            origin: self.origin.each_ref().map(|c| &c[span.clone()]),
            direction: self.direction.each_ref().map(|c| &c[span.clone()]),
            t_max: &self.t_max[span.clone()],
            leaves: &self.leaves[span.clone()],
            reaches: &self.reaches[span],
        }
    }
}

/// Closest hits, element `i` for ray `i`; `NO_PRIMITIVE` for a miss.
#[derive(Clone, Debug, Default)]
pub(crate) struct Found {
    pub(crate) primitive: Vec<u32>,
    pub(crate) t: Vec<f32>,
    pub(crate) u: Vec<f32>,
    pub(crate) v: Vec<f32>,
}

impl Found {
    /// Room for the hits of `n` rays.
    pub(crate) fn new(n: usize) -> Self {
        let n = padded(n);
        Self {
            primitive: vec![NO_PRIMITIVE; n],
            t: vec![0.0; n],
            u: vec![0.0; n],
            v: vec![0.0; n],
        }
    }

    /// The hits of `range`, to be written.
    pub(crate) fn hits(&mut self, range: &Range<usize>) -> Hits<'_> {
        let span = Queue::span(range);
        Hits {
            primitive: &mut self.primitive[span.clone()],
            t: &mut self.t[span.clone()],
            u: &mut self.u[span.clone()],
            v: &mut self.v[span],
        }
    }
}

/// Whoever answers closest-hit queues: one variant of the comparison.
pub(crate) trait Closest {
    /// Writes the closest hit of each ray.
    fn closest(&self, rays: &Queue, found: &mut Found);
}

/// Whoever answers occlusion queues.
pub(crate) trait Occluded {
    /// Writes 1 for each ray that meets something before its `t_max`, else 0.
    fn occluded(&self, rays: &Queue, blocked: &mut [u32]);
}
