//! What the statistical tests share. Each test binary uses its own part of it.
#![allow(dead_code)]

pub(crate) mod agreement;
pub(crate) mod media;
pub(crate) mod picture;
pub(crate) mod scenes;
pub(crate) mod statistics;
