//! Dispersion: paths that meet a dispersive surface go on with one wavelength.
//!
//! A path without a wavelength is given one and weighed by what it stands for in red, green and blue
//! (`dispersion`); a path that has one keeps it. So a path is weighed once, and all surfaces that it
//! meets from there on refract it by the same wavelength.
//!
//! Throughput may be negative from here on: no colour of a single wavelength lies within sRGB.
//!
//! Bytes: [`DISPERSE`] a path.

use crate::cost::{Cost, columns};
use crate::dispersion::Spectrum;
use crate::lanes::{Fx, LANES, gather, gather_u32, load_u32, padded};
use crate::queues::{MARKS, PathsMut, WavelengthsMut};
use crate::sampler::{Apart, Sampler, apart};
use crate::vec3::Vec3x;

/// A path: its place, wavelength, throughput and identity; the first two written.
pub const DISPERSE: Cost = Cost::new(
    4 + columns::<PathsMut<'static>>(&["throughput", "pixel", "sample", "bounces"])
        + columns::<WavelengthsMut<'static>>(&["wavelength"]),
    columns::<PathsMut<'static>>(&["throughput"])
        + columns::<WavelengthsMut<'static>>(&["wavelength"]),
)
.operations(120);

/// Gives a wavelength to the paths at the first `len` places of `index` that have none. `index` is
/// padded to whole vectors by repetitions of its last place.
pub fn disperse<S: Sampler>(
    index: &[u32],
    len: usize,
    sampler: S,
    paths: &mut PathsMut,
    wavelengths: &mut WavelengthsMut,
) {
    let spectrum = Spectrum::table();
    for i in (0..padded(len)).step_by(LANES) {
        let at = load_u32(index, i);
        let old = gather(wavelengths.wavelength, at);
        let white = old.simd_eq(Fx::ZERO);
        if !white.any() {
            continue;
        }
        let bounces = gather_u32(paths.bounces, at) & !crate::lanes::Ux::splat(MARKS);
        let (pixel, sample) = (gather_u32(paths.pixel, at), gather_u32(paths.sample, at));
        let [u, ..] = sampler.draw4(pixel, sample, apart(bounces, Apart::Wavelength));
        let drawn = spectrum.sample(u);
        let throughput = paths.throughput.each_ref().map(|column| gather(column, at));
        let [x, y, z] = throughput;
        let weighed = Vec3x::new(x, y, z).product(drawn.weight);
        let (at, white) = (at.to_array(), white.to_bitmask());
        for (lane, &at) in at.iter().enumerate() {
            // What pads the list repeats its last path, whose wavelength is written by then: its lanes
            // were read before, so they write the same again.
            if white >> lane & 1 == 1 {
                wavelengths.wavelength[at as usize] = drawn.nanometres.as_array()[lane];
                for (column, value) in paths.throughput.iter_mut().zip(weighed.lane(lane)) {
                    column[at as usize] = value;
                }
            }
        }
    }
}
