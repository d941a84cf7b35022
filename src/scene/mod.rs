//! Scenes: what a file says (`description`, read by `toml`), what it names (`import`), and the
//! tables that the kernels read (`compiled`), with `compile` between them and `load` for the order
//! of it all.
//!
//! `docs/scene-format.md` describes the file format to users.

mod builder;
mod camera;
mod compile;
pub mod compiled;
mod daylight;
mod degrees;
mod description;
mod error;
mod hash;
mod import;
mod instances;
mod light;
mod lights;
mod load;
pub mod material;
mod media;
mod medium;
pub(crate) mod motion;
mod placed;
mod projection;
mod shapes;
mod surfaces;
pub mod texture;
mod toml;
mod transform;
mod triangulate;
mod unsupported;
mod values;
mod ways;

pub use compiled::{Camera, Extent, FilmSpec, Filter, Lens, Mesh, Projection, Scene};
pub use error::SceneError;
pub use import::Counts;
pub(crate) use light::row_cosine;
pub use light::{Environment, Light, LightKind, Sky, Spot};
pub use load::{Parsed, Source};
pub use material::{Bsdf, Material, Textured};
pub use medium::{Fog, Medium};
pub use motion::Motion;
pub use placed::{Instance, Object, Placement, Sphere};
pub use texture::Texture;

/// Loads and compiles the scene at `path`: a native `.toml` scene, or a bare `.obj` or `.ply`. All
/// steps of [`Source`] at once.
///
/// Fallbacks that were taken are in [`Scene::warnings`].
///
/// # Errors
/// Whatever is wrong with the scene or a file that it names.
pub fn load(path: &std::path::Path) -> Result<Scene, SceneError> {
    Source::open(path)?.parse(&Default::default())?.compile()
}
