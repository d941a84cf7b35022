//! Materials of a scene file: what it says of them (`said`), compiled (`compile`), with the textures
//! that they name (`images`).

mod compile;
mod glass;
mod images;
mod said;
mod slots;

pub(super) use compile::{Surfaces, compile};
pub(super) use images::{bind, bind_imported};
pub(super) use said::Material;
