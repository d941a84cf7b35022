//! A folder of files for one test.

#![allow(dead_code, reason = "each test binary uses its part")]

use huygens::scene::{self, Scene};
use std::path::PathBuf;

/// Three vertices and a face.
pub(crate) const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

/// A temporary folder, removed at the end.
pub(crate) struct Folder(tempfile::TempDir);

impl Folder {
    /// An empty one.
    pub(crate) fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    /// Adds a file.
    pub(crate) fn with(self, name: &str, content: impl AsRef<[u8]>) -> Self {
        std::fs::write(self.path(name), content).unwrap();
        self
    }

    /// Where a file lies.
    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// The scene in the file `name`, which is right; its warnings without the folder's name.
    #[track_caller]
    pub(crate) fn scene(&self, name: &str) -> Scene {
        let mut scene = scene::load(&self.path(name)).unwrap();
        for warning in &mut scene.warnings {
            *warning = self.strip(warning);
        }
        scene
    }

    /// The scene that `text` describes.
    #[track_caller]
    pub(crate) fn scene_of(&self, text: &str) -> Scene {
        std::fs::write(self.path("s.toml"), text).unwrap();
        self.scene("s.toml")
    }

    /// The message for the file `name`, which is wrong, without the folder's name.
    #[track_caller]
    pub(crate) fn error(&self, name: &str) -> String {
        let error = scene::load(&self.path(name)).expect_err("an error");
        self.strip(&error.to_string())
    }

    fn strip(&self, message: &str) -> String {
        let folder = format!("{}{}", self.0.path().display(), std::path::MAIN_SEPARATOR);
        message.replace(&folder, "")
    }
}
