//! The BSDF kernels: do sample, evaluate and pdf agree, with each other and with f64; do they keep
//! energy and reciprocity; do the ends of their domains stay finite?

#[path = "../common/mod.rs"]
mod common;
mod harness;

mod conductor;
mod dielectric;
mod diffuse;
mod fresnel;
mod twin;
