//! Queues answered by Embree: a ray a call, a stream of rays a call, sixteen coherent rays a call.
//!
//! All three read and write the same columns as Huygens does, and are timed with that copying in:
//! it is what a wave would pay. It is some nanoseconds of the hundreds that a ray takes.

use super::{Scene, sys};
use crate::queue::{Closest, Found, Occluded, Queue};
use sys::{RTCHit, RTCIntersectContext, RTCRay, RTCRay16, RTCRayHit, RTCRayHit16};

/// Rays in a stream: enough for Embree to sort, few enough to stay in the first caches.
const STREAM: usize = 256;
/// Rays in a packet.
const PACKET: usize = 16;

/// While it lives, denormal numbers count as zero, as Embree's manual recommends for the threads
/// that call it.
struct FlushDenormals {
    #[cfg(target_arch = "x86_64")]
    before: u32,
}

impl FlushDenormals {
    #[cfg(target_arch = "x86_64")]
    fn enter() -> Self {
        let mut before = 0u32;
        // SAFETY: stores the register MXCSR into `before`.
        unsafe { std::arch::asm!("stmxcsr [{}]", in(reg) &raw mut before) };
        // Flush to zero is bit 15, denormals are zero bit 6.
        load_mxcsr(before | 0x8040);
        Self { before }
    }

    #[cfg(not(target_arch = "x86_64"))]
    fn enter() -> Self {
        Self {}
    }
}

#[cfg(target_arch = "x86_64")]
impl Drop for FlushDenormals {
    fn drop(&mut self) {
        load_mxcsr(self.before);
    }
}

#[cfg(target_arch = "x86_64")]
fn load_mxcsr(value: u32) {
    // SAFETY: `value` is what MXCSR held before, with at most the two modes set. While they are,
    // the only Rust code that runs is this file's loops, which move floats and compute with none.
    unsafe { std::arch::asm!("ldmxcsr [{}]", in(reg) &raw const value) };
}

fn context(rays: &Queue) -> RTCIntersectContext {
    RTCIntersectContext {
        flags: if rays.coherent {
            sys::CONTEXT_COHERENT
        } else {
            sys::CONTEXT_INCOHERENT
        },
        filter: std::ptr::null(),
        inst_stack_size: 0,
        inst_id: [sys::INVALID],
        min_width_distance_factor: 0.0,
    }
}

/// Columns of exactly `n` rays, so that the loops below check no bounds.
struct Columns<'a> {
    origin: [&'a [f32]; 3],
    direction: [&'a [f32]; 3],
    t_max: &'a [f32],
}

impl<'a> Columns<'a> {
    fn new(rays: &'a Queue) -> Self {
        let n = rays.len();
        Self {
            origin: rays.origin.each_ref().map(|c| &c[..n]),
            direction: rays.direction.each_ref().map(|c| &c[..n]),
            t_max: &rays.t_max[..n],
        }
    }

    #[inline(always)]
    fn ray(&self, i: usize) -> RTCRay {
        RTCRay {
            org: self.origin.map(|c| c[i]),
            dir: self.direction.map(|c| c[i]),
            tfar: self.t_max[i],
            mask: u32::MAX,
            ..RTCRay::default()
        }
    }

    #[inline(always)]
    fn record(&self, i: usize) -> RTCRayHit {
        RTCRayHit {
            ray: self.ray(i),
            hit: RTCHit {
                prim_id: sys::INVALID,
                geom_id: sys::INVALID,
                inst_id: sys::INVALID,
                ..RTCHit::default()
            },
        }
    }
}

#[inline(always)]
fn keep(found: &mut Found, i: usize, record: &RTCRayHit) {
    // Embree's "invalid" is the kernels' `NO_PRIMITIVE`, and its u and v mean the same.
    found.primitive[i] = record.hit.prim_id;
    found.t[i] = record.ray.tfar;
    found.u[i] = record.hit.u;
    found.v[i] = record.hit.v;
}

/// `rtcIntersect1` and `rtcOccluded1`.
pub(crate) struct Single<'a>(pub(crate) &'a Scene<'a>);

impl Closest for Single<'_> {
    fn closest(&self, rays: &Queue, found: &mut Found) {
        let _mode = FlushDenormals::enter();
        let (mut context, columns) = (context(rays), Columns::new(rays));
        for i in 0..rays.len() {
            let mut record = columns.record(i);
            // SAFETY: the scene is committed; context and record are valid for the call.
            unsafe { sys::rtcIntersect1(self.0.raw, &raw mut context, &raw mut record) };
            keep(found, i, &record);
        }
    }
}

impl Occluded for Single<'_> {
    fn occluded(&self, rays: &Queue, blocked: &mut [u32]) {
        let _mode = FlushDenormals::enter();
        let (mut context, columns) = (context(rays), Columns::new(rays));
        for i in 0..rays.len() {
            let mut ray = columns.ray(i);
            // SAFETY: the scene is committed; context and ray are valid for the call.
            unsafe { sys::rtcOccluded1(self.0.raw, &raw mut context, &raw mut ray) };
            // Embree says "occluded" by minus infinity.
            blocked[i] = u32::from(ray.tfar < 0.0);
        }
    }
}

/// `rtcIntersect1M` and `rtcOccluded1M`.
pub(crate) struct Stream<'a>(pub(crate) &'a Scene<'a>);

impl Closest for Stream<'_> {
    fn closest(&self, rays: &Queue, found: &mut Found) {
        let _mode = FlushDenormals::enter();
        let (mut context, columns) = (context(rays), Columns::new(rays));
        let mut records = [RTCRayHit::default(); STREAM];
        for start in (0..rays.len()).step_by(STREAM) {
            let n = STREAM.min(rays.len() - start);
            for k in 0..n {
                records[k] = columns.record(start + k);
            }
            let stride = size_of::<RTCRayHit>();
            // SAFETY: the scene is committed; `n` records of that stride lie at the address.
            unsafe {
                sys::rtcIntersect1M(
                    self.0.raw,
                    &raw mut context,
                    records.as_mut_ptr(),
                    n as u32,
                    stride,
                );
            }
            for k in 0..n {
                keep(found, start + k, &records[k]);
            }
        }
    }
}

impl Occluded for Stream<'_> {
    fn occluded(&self, rays: &Queue, blocked: &mut [u32]) {
        let _mode = FlushDenormals::enter();
        let (mut context, columns) = (context(rays), Columns::new(rays));
        let mut stream = [RTCRay::default(); STREAM];
        for start in (0..rays.len()).step_by(STREAM) {
            let n = STREAM.min(rays.len() - start);
            for k in 0..n {
                stream[k] = columns.ray(start + k);
            }
            let stride = size_of::<RTCRay>();
            // SAFETY: the scene is committed; `n` rays of that stride lie at the address.
            unsafe {
                sys::rtcOccluded1M(
                    self.0.raw,
                    &raw mut context,
                    stream.as_mut_ptr(),
                    n as u32,
                    stride,
                );
            }
            for k in 0..n {
                blocked[start + k] = u32::from(stream[k].tfar < 0.0);
            }
        }
    }
}

/// `rtcIntersect16`: for coherent rays.
pub(crate) struct Packets<'a>(pub(crate) &'a Scene<'a>);

impl Closest for Packets<'_> {
    fn closest(&self, rays: &Queue, found: &mut Found) {
        let _mode = FlushDenormals::enter();
        let (mut context, columns) = (context(rays), Columns::new(rays));
        for start in (0..rays.len()).step_by(PACKET) {
            let n = PACKET.min(rays.len() - start);
            let span = start..start + n;
            let valid = sys::Valid16(std::array::from_fn(|k| -i32::from(k < n)));
            let mut packet = RTCRayHit16 {
                ray: RTCRay16 {
                    mask: [u32::MAX; PACKET],
                    ..RTCRay16::default()
                },
                ..RTCRayHit16::default()
            };
            for axis in 0..3 {
                packet.ray.org[axis][..n].copy_from_slice(&columns.origin[axis][span.clone()]);
                packet.ray.dir[axis][..n].copy_from_slice(&columns.direction[axis][span.clone()]);
            }
            packet.ray.tfar[..n].copy_from_slice(&columns.t_max[span.clone()]);
            packet.hit.prim_id = [sys::INVALID; PACKET];
            packet.hit.geom_id = [sys::INVALID; PACKET];
            packet.hit.inst_id = [sys::INVALID; PACKET];
            // SAFETY: the scene is committed; the packet and the mask are aligned as Embree asks.
            unsafe {
                sys::rtcIntersect16(
                    valid.0.as_ptr(),
                    self.0.raw,
                    &raw mut context,
                    &raw mut packet,
                );
            }
            found.primitive[span.clone()].copy_from_slice(&packet.hit.prim_id[..n]);
            found.t[span.clone()].copy_from_slice(&packet.ray.tfar[..n]);
            found.u[span.clone()].copy_from_slice(&packet.hit.u[..n]);
            found.v[span].copy_from_slice(&packet.hit.v[..n]);
        }
    }
}
