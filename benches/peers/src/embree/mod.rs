//! Embree: devices and scenes, owned; `cast` asks them for rays.

mod cast;
mod sys;

pub(crate) use cast::{Packets, Single, Stream};

use huygens::scene::Mesh;
use std::ffi::{CString, c_int, c_void};
use std::sync::atomic::{AtomicI64, Ordering};

/// An Embree device.
pub(crate) struct Device {
    raw: *mut sys::RTCDevice,
    /// Bytes that it holds, as it tells its monitor. Boxed, since Embree keeps the address.
    bytes: Box<AtomicI64>,
}

/// Adds to the device's count of bytes; never objects.
extern "C" fn monitor(counter: *mut c_void, bytes: isize, _post: bool) -> bool {
    // SAFETY: `Device::new` registers this function with the address of its boxed counter, which
    // lives until after the device is released.
    let counter = unsafe { &*counter.cast::<AtomicI64>() };
    counter.fetch_add(bytes as i64, Ordering::Relaxed);
    true
}

impl Device {
    /// A device whose builds use `threads` threads.
    pub(crate) fn new(threads: usize) -> Result<Self, String> {
        let config = CString::new(format!("threads={threads}")).map_err(|e| e.to_string())?;
        // SAFETY: `config` is a C string, and Embree copies what it needs of it.
        let raw = unsafe { sys::rtcNewDevice(config.as_ptr()) };
        if raw.is_null() {
            return Err("Embree makes no device on this machine".to_owned());
        }
        let bytes = Box::new(AtomicI64::new(0));
        let counter = (&raw const *bytes).cast_mut().cast();
        // SAFETY: `raw` is a device; `monitor` expects this counter, which outlives the device.
        unsafe { sys::rtcSetDeviceMemoryMonitorFunction(raw, monitor, counter) };
        Ok(Self { raw, bytes })
    }

    fn property(&self, property: c_int) -> isize {
        // SAFETY: `raw` is a device.
        unsafe { sys::rtcGetDeviceProperty(self.raw, property) }
    }

    /// Version and widest native packets, for people.
    pub(crate) fn describe(&self) -> String {
        let lanes = [sys::DEVICE_NATIVE_RAY16, sys::DEVICE_NATIVE_RAY8]
            .map(|property| self.property(property) == 1);
        let isa = match lanes {
            [true, _] => "AVX-512 kernels",
            [_, true] => "AVX kernels",
            _ => "SSE kernels",
        };
        let version = [
            sys::DEVICE_VERSION_MAJOR,
            sys::DEVICE_VERSION_MINOR,
            sys::DEVICE_VERSION_PATCH,
        ]
        .map(|property| self.property(property).to_string());
        format!("Embree {} ({isa})", version.join("."))
    }

    fn check(&self, what: &str) -> Result<(), String> {
        // SAFETY: `raw` is a device.
        match unsafe { sys::rtcGetDeviceError(self.raw) } {
            0 => Ok(()),
            code => Err(format!("Embree could not {what}: error {code}")),
        }
    }

    fn bytes(&self) -> i64 {
        self.bytes.load(Ordering::Relaxed)
    }
}

impl Drop for Device {
    fn drop(&mut self) {
        // SAFETY: `raw` is a device that this value alone owns; scenes borrow it, so none is left.
        unsafe { sys::rtcReleaseDevice(self.raw) };
    }
}

/// Effort of the build: Embree's default, or with spatial splits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Quality {
    Medium,
    High,
}

/// A scene of one triangle mesh.
pub(crate) struct Scene<'d> {
    device: &'d Device,
    raw: *mut sys::RTCScene,
    geometry: *mut sys::RTCGeometry,
    /// Bytes of the tree and its leaves; 0 until committed.
    pub(crate) bytes: usize,
}

impl<'d> Scene<'d> {
    /// Copies the mesh into Embree's buffers; [`Scene::commit`] builds.
    pub(crate) fn prepare(
        device: &'d Device,
        mesh: &Mesh,
        quality: Quality,
        robust: bool,
    ) -> Result<Self, String> {
        let flags = [sys::SCENE_NONE, sys::SCENE_ROBUST][usize::from(robust)];
        let effort = match quality {
            Quality::Medium => sys::QUALITY_MEDIUM,
            Quality::High => sys::QUALITY_HIGH,
        };
        // SAFETY: `device.raw` is a device, and scene and geometry come from it.
        let scene = unsafe {
            let raw = sys::rtcNewScene(device.raw);
            sys::rtcSetSceneFlags(raw, flags);
            sys::rtcSetSceneBuildQuality(raw, effort);
            Self {
                device,
                raw,
                geometry: sys::rtcNewGeometry(device.raw, sys::GEOMETRY_TRIANGLE),
                bytes: 0,
            }
        };
        scene.fill(sys::BUFFER_VERTEX, sys::FORMAT_FLOAT3, &mesh.vertices)?;
        scene.fill(sys::BUFFER_INDEX, sys::FORMAT_UINT3, &mesh.indices)?;
        Ok(scene)
    }

    fn fill<T: Copy>(&self, buffer: c_int, format: c_int, rows: &[[T; 3]]) -> Result<(), String> {
        let stride = size_of::<[T; 3]>();
        // SAFETY: `geometry` is a geometry, and the formats that are passed here have this stride.
        let data = unsafe {
            sys::rtcSetNewGeometryBuffer(self.geometry, buffer, 0, format, stride, rows.len())
        };
        self.device.check("allocate a mesh")?;
        if data.is_null() {
            return Err("Embree could not allocate a mesh".to_owned());
        }
        // SAFETY: Embree has just allocated `rows.len()` items of `stride` bytes there, aligned to
        // at least 16 bytes; nothing else knows of them yet.
        unsafe { std::ptr::copy_nonoverlapping(rows.as_ptr(), data.cast(), rows.len()) };
        Ok(())
    }

    /// Builds.
    pub(crate) fn commit(mut self) -> Result<Self, String> {
        let before = self.device.bytes();
        // SAFETY: `geometry` has its buffers, and both belong to one device.
        unsafe {
            sys::rtcCommitGeometry(self.geometry);
            sys::rtcAttachGeometry(self.raw, self.geometry);
            sys::rtcCommitScene(self.raw);
        }
        self.device.check("build")?;
        self.bytes = (self.device.bytes() - before).max(0) as usize;
        Ok(self)
    }
}

impl Drop for Scene<'_> {
    fn drop(&mut self) {
        // SAFETY: both are owned by this value alone, but for the reference that an attached
        // geometry's scene keeps of it and gives back when it is released.
        unsafe {
            sys::rtcReleaseGeometry(self.geometry);
            sys::rtcReleaseScene(self.raw);
        }
    }
}
