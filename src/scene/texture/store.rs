//! Which textures a scene wants; each file is decoded once for each way of understanding it.

use super::decode;
use super::{Texture, mip};
use rayon::prelude::*;
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// A file, and how its bytes are understood.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(in crate::scene) struct Request {
    pub(in crate::scene) path: PathBuf,
    /// Whether 8-bit colours are stored with the curve of sRGB.
    pub(in crate::scene) srgb: bool,
}

impl Request {
    /// What is wrong with the file, as far as its header tells.
    pub(in crate::scene) fn check(&self) -> Result<(), String> {
        decode::size(&self.path).map(|_| ())
    }

    /// Bytes in memory with all mip levels, by the file's header; 0 of a file that is wrong.
    pub(in crate::scene) fn bytes(&self) -> u64 {
        decode::bytes(&self.path, self.srgb).unwrap_or(0)
    }

    fn load(&self) -> Result<Texture, String> {
        let base = decode::load(&self.path, self.srgb)?;
        Ok(mip::texture(self.path.display().to_string(), base))
    }
}

/// Textures that were loaded, or why they could not be.
#[derive(Debug, Default)]
pub(in crate::scene) struct Store {
    places: HashMap<Request, usize>,
    loaded: Vec<Result<Texture, String>>,
    /// Index among the scene's textures of those in use.
    used: Vec<Option<u32>>,
    textures: Vec<Texture>,
}

impl Store {
    /// Loads what is wanted, in parallel on the current rayon pool. The result does not depend on the
    /// number of threads.
    pub(in crate::scene) fn load<'a>(wanted: impl Iterator<Item = &'a Request>) -> Self {
        let mut places = HashMap::new();
        let mut list = Vec::new();
        for request in wanted {
            places.entry(request.clone()).or_insert_with(|| {
                list.push(request);
                list.len() - 1
            });
        }
        let loaded: Vec<_> = list.par_iter().map(|request| request.load()).collect();
        Self {
            places,
            used: vec![None; loaded.len()],
            loaded,
            textures: Vec::new(),
        }
    }

    /// Index of a texture among the scene's; or why there is none.
    pub(in crate::scene) fn get(&mut self, request: &Request) -> Result<u32, String> {
        let place = self.places[request];
        if let Some(index) = self.used[place] {
            return Ok(index);
        }
        let empty = Err(String::new());
        match std::mem::replace(&mut self.loaded[place], empty) {
            Ok(texture) => {
                let index = self.textures.len() as u32;
                self.textures.push(texture);
                self.used[place] = Some(index);
                Ok(index)
            }
            Err(why) => {
                self.loaded[place] = Err(why.clone());
                Err(why)
            }
        }
    }

    /// The texture of that index.
    pub(in crate::scene) fn texture(&self, index: u32) -> &Texture {
        &self.textures[index as usize]
    }

    /// All textures that were asked for.
    pub(in crate::scene) fn finish(self) -> Vec<Texture> {
        self.textures
    }
}

/// The path that a file writes as `name`, beside the file `from`; a path of another system's
/// separators where only that exists.
pub(in crate::scene) fn beside(from: &Path, name: &str) -> PathBuf {
    let folder = from.parent().unwrap_or(Path::new(""));
    let direct = folder.join(name);
    let unixlike = folder.join(name.replace('\\', "/"));
    if !direct.exists() && unixlike.exists() {
        unixlike
    } else {
        direct
    }
}
