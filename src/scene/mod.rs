//! Scenes: what a file says (`description`, read by `toml`), what it names (`import`), and the
//! tables that the kernels read (`compiled`), with `compile` between them.
//!
//! `docs/scene-format.md` describes the file format to users.

mod builder;
mod camera;
mod compile;
pub mod compiled;
mod degrees;
mod description;
mod error;
mod hash;
mod import;
mod shapes;
mod toml;
mod transform;
mod triangulate;
mod values;

pub use compiled::{FilmSpec, Filter, Material, Mesh, Perspective, Scene};
pub use error::SceneError;

/// Loads and compiles the scene at `path`: a native `.toml` scene or a bare `.obj`.
///
/// Fallbacks that were taken are in [`Scene::warnings`].
///
/// # Errors
/// Whatever is wrong with the scene or a file that it names.
pub fn load(path: &std::path::Path) -> Result<Scene, SceneError> {
    let extension = path.extension().unwrap_or_default();
    if extension.eq_ignore_ascii_case("toml") {
        compile::native(path)
    } else if extension.eq_ignore_ascii_case("obj") {
        compile::bare_obj(path)
    } else {
        let message = "expected a scene: a `.toml` or an `.obj` file";
        Err(SceneError::file(path, message))
    }
}
