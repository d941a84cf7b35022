//! The few functions of Embree 3 that are called, by hand from its C headers (`rtcore_*.h` of
//! 3.13.5, built with one instance level as Debian does).

use std::ffi::{c_char, c_int, c_uint, c_void};
use std::marker::{PhantomData, PhantomPinned};

/// `RTC_INVALID_GEOMETRY_ID`: nothing was met.
pub(super) const INVALID: u32 = u32::MAX;

/// What C code owns behind a pointer.
macro_rules! opaque {
    ($($Name:ident),*) => {$(
        #[repr(C)]
        pub(super) struct $Name {
            _data: [u8; 0],
            _marker: PhantomData<(*mut u8, PhantomPinned)>,
        }
    )*};
}
opaque!(RTCDevice, RTCScene, RTCGeometry);

pub(super) const DEVICE_VERSION_MAJOR: c_int = 1;
pub(super) const DEVICE_VERSION_MINOR: c_int = 2;
pub(super) const DEVICE_VERSION_PATCH: c_int = 3;
pub(super) const DEVICE_NATIVE_RAY8: c_int = 33;
pub(super) const DEVICE_NATIVE_RAY16: c_int = 34;

pub(super) const GEOMETRY_TRIANGLE: c_int = 0;
pub(super) const BUFFER_INDEX: c_int = 0;
pub(super) const BUFFER_VERTEX: c_int = 1;
pub(super) const FORMAT_UINT3: c_int = 0x5003;
pub(super) const FORMAT_FLOAT3: c_int = 0x9003;
pub(super) const SCENE_NONE: c_int = 0;
pub(super) const SCENE_ROBUST: c_int = 1 << 2;
pub(super) const QUALITY_MEDIUM: c_int = 1;
pub(super) const QUALITY_HIGH: c_int = 2;
pub(super) const CONTEXT_INCOHERENT: c_int = 0;
pub(super) const CONTEXT_COHERENT: c_int = 1;

/// `RTCIntersectContext`. The last field is there only in some builds of the library, which then
/// ignore it.
#[repr(C)]
pub(super) struct RTCIntersectContext {
    pub(super) flags: c_int,
    pub(super) filter: *const c_void,
    pub(super) inst_stack_size: c_uint,
    pub(super) inst_id: [c_uint; 1],
    pub(super) min_width_distance_factor: f32,
}

/// `RTCRay`.
#[repr(C, align(16))]
#[derive(Clone, Copy, Default)]
pub(super) struct RTCRay {
    pub(super) org: [f32; 3],
    pub(super) tnear: f32,
    pub(super) dir: [f32; 3],
    pub(super) time: f32,
    pub(super) tfar: f32,
    pub(super) mask: u32,
    pub(super) id: u32,
    pub(super) flags: u32,
}

/// `RTCHit`.
#[repr(C, align(16))]
#[derive(Clone, Copy, Default)]
pub(super) struct RTCHit {
    pub(super) ng: [f32; 3],
    pub(super) u: f32,
    pub(super) v: f32,
    pub(super) prim_id: u32,
    pub(super) geom_id: u32,
    pub(super) inst_id: u32,
}

/// `RTCRayHit`.
#[repr(C)]
#[derive(Clone, Copy, Default)]
pub(super) struct RTCRayHit {
    pub(super) ray: RTCRay,
    pub(super) hit: RTCHit,
}

/// `RTCRay16`.
#[repr(C, align(64))]
#[derive(Clone, Copy, Default)]
pub(super) struct RTCRay16 {
    pub(super) org: [[f32; 16]; 3],
    pub(super) tnear: [f32; 16],
    pub(super) dir: [[f32; 16]; 3],
    pub(super) time: [f32; 16],
    pub(super) tfar: [f32; 16],
    pub(super) mask: [u32; 16],
    pub(super) id: [u32; 16],
    pub(super) flags: [u32; 16],
}

/// `RTCHit16`.
#[repr(C, align(64))]
#[derive(Clone, Copy, Default)]
pub(super) struct RTCHit16 {
    pub(super) ng: [[f32; 16]; 3],
    pub(super) u: [f32; 16],
    pub(super) v: [f32; 16],
    pub(super) prim_id: [u32; 16],
    pub(super) geom_id: [u32; 16],
    pub(super) inst_id: [u32; 16],
}

/// `RTCRayHit16`.
#[repr(C)]
#[derive(Clone, Copy, Default)]
pub(super) struct RTCRayHit16 {
    pub(super) ray: RTCRay16,
    pub(super) hit: RTCHit16,
}

/// The lanes of a packet that are to be traced: -1 or 0, aligned as the packet.
#[repr(C, align(64))]
pub(super) struct Valid16(pub(super) [c_int; 16]);

// From the header, 48 + 32 bytes a ray and hit, and sixteen times that a packet.
const _: () = assert!(size_of::<RTCRayHit>() == 80 && size_of::<RTCRayHit16>() == 16 * 80);

pub(super) type MemoryMonitor = extern "C" fn(*mut c_void, isize, bool) -> bool;

#[link(name = "embree3")]
unsafe extern "C" {
    pub(super) fn rtcNewDevice(config: *const c_char) -> *mut RTCDevice;
    pub(super) fn rtcReleaseDevice(device: *mut RTCDevice);
    pub(super) fn rtcGetDeviceProperty(device: *mut RTCDevice, property: c_int) -> isize;
    pub(super) fn rtcGetDeviceError(device: *mut RTCDevice) -> c_int;
    pub(super) fn rtcSetDeviceMemoryMonitorFunction(
        device: *mut RTCDevice,
        monitor: MemoryMonitor,
        user: *mut c_void,
    );

    pub(super) fn rtcNewScene(device: *mut RTCDevice) -> *mut RTCScene;
    pub(super) fn rtcReleaseScene(scene: *mut RTCScene);
    pub(super) fn rtcSetSceneFlags(scene: *mut RTCScene, flags: c_int);
    pub(super) fn rtcSetSceneBuildQuality(scene: *mut RTCScene, quality: c_int);
    pub(super) fn rtcCommitScene(scene: *mut RTCScene);

    pub(super) fn rtcNewGeometry(device: *mut RTCDevice, kind: c_int) -> *mut RTCGeometry;
    pub(super) fn rtcReleaseGeometry(geometry: *mut RTCGeometry);
    pub(super) fn rtcCommitGeometry(geometry: *mut RTCGeometry);
    pub(super) fn rtcAttachGeometry(scene: *mut RTCScene, geometry: *mut RTCGeometry) -> c_uint;
    pub(super) fn rtcSetNewGeometryBuffer(
        geometry: *mut RTCGeometry,
        buffer: c_int,
        slot: c_uint,
        format: c_int,
        byte_stride: usize,
        items: usize,
    ) -> *mut c_void;

    pub(super) fn rtcIntersect1(
        scene: *mut RTCScene,
        context: *mut RTCIntersectContext,
        record: *mut RTCRayHit,
    );
    pub(super) fn rtcIntersect16(
        valid: *const c_int,
        scene: *mut RTCScene,
        context: *mut RTCIntersectContext,
        record: *mut RTCRayHit16,
    );
    pub(super) fn rtcIntersect1M(
        scene: *mut RTCScene,
        context: *mut RTCIntersectContext,
        records: *mut RTCRayHit,
        n: c_uint,
        byte_stride: usize,
    );
    pub(super) fn rtcOccluded1(
        scene: *mut RTCScene,
        context: *mut RTCIntersectContext,
        ray: *mut RTCRay,
    );
    pub(super) fn rtcOccluded1M(
        scene: *mut RTCScene,
        context: *mut RTCIntersectContext,
        rays: *mut RTCRay,
        n: c_uint,
        byte_stride: usize,
    );
}
