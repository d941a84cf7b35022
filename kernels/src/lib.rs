//! The SIMD kernels of Huygens.
//!
//! Every kernel takes plain slices (or small structs of slices) and writes slices. This crate
//! knows no scene, no file, no thread and makes no allocation. One kernel family a file; each
//! file's header states the formula and its source, the measure of each pdf, the input domain,
//! what is guaranteed of the output, and the bytes read and written an item.
//!
//! Only [`lanes`] knows how many lanes a vector has. A slice that a kernel walks in whole vectors
//! is padded to a multiple of [`lanes::LANES`]; what lies in the padding is unspecified and never
//! reaches a result.

pub mod accumulate;
#[cfg(target_arch = "x86_64")]
pub mod avx512;
pub mod bare;
pub mod bsdf;
pub mod bvh;
pub mod camera;
pub mod compact;
pub mod cost;
pub mod disk;
pub mod dispersion;
pub mod emission;
pub mod few;
pub mod filter;
pub mod flight;
pub mod gather;
pub mod hemisphere;
pub mod images;
pub mod instance;
pub mod interpolate;
pub mod lanes;
pub mod levels;
pub mod light;
pub mod look;
pub mod many;
pub mod math;
pub mod medium;
pub mod mis;
pub mod motion;
pub mod octahedral;
pub mod opacity;
pub mod order;
pub mod others;
pub mod packet;
pub mod phase;
pub mod prefetch;
pub mod query;
pub mod queues;
pub mod rays;
pub mod rng;
pub mod roulette;
pub mod sampler;
pub mod scatter;
pub mod slabs;
pub mod soa;
pub mod sphere;
pub mod sphere_light;
pub mod surface;
pub mod tables;
pub mod texture;
pub mod traverse;
pub mod triangle;
pub mod vec3;
pub mod vector;
pub mod visits;
