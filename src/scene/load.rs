//! From a file's name to a scene, step by step: what is cheap and can fail comes first, so that a
//! mistake is found before gigabytes are read.

use super::compile;
use super::compiled::{FilmSpec, Scene};
use super::description::Description;
use super::error::{SceneError, io_message};
use super::import::panorama::{self, Pixels};
use super::import::{Counts, Format, Imported};
use super::lights;
use super::shapes::Shapes;
use super::surfaces::{self, Surfaces};
use super::texture::{Request, Store};
use super::toml::SceneFile;
use crate::settings::Preset;
use rayon::prelude::*;
use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicU64;

/// A scene that is opened: its own file is read and checked as far as that goes without the files
/// of geometry that it names. They are known to be there, and how large they are.
#[derive(Debug)]
pub struct Source {
    pub(super) path: PathBuf,
    pub(super) native: Option<Native>,
    /// Each once, in the order of their first mention.
    pub(super) files: Vec<GeometryFile>,
    /// The sky's map, if it has one.
    sky: Option<PathBuf>,
}

/// A native scene's own file.
#[derive(Debug)]
pub(super) struct Native {
    file: SceneFile,
    said: Description,
    surfaces: Surfaces,
}

/// A file of geometry.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct GeometryFile {
    pub(super) path: PathBuf,
    pub(super) format: Format,
    /// Bytes.
    size: u64,
    /// Shapes that name it.
    pub(super) uses: usize,
}

/// A scene whose files are read: all that is left is to compile it.
#[derive(Debug)]
pub struct Parsed {
    source: Source,
    /// Of each of the source's files.
    imported: Vec<Imported>,
    store: Store,
    sky: Option<Pixels>,
}

impl Source {
    /// Opens the scene at `path`: a native `.toml` scene, or a bare `.obj` or `.ply`.
    ///
    /// # Errors
    /// Whatever is wrong with the scene's own file, and files that it names and that are not there.
    pub fn open(path: &Path) -> Result<Self, SceneError> {
        let extension = path.extension().unwrap_or_default();
        if extension.eq_ignore_ascii_case("toml") {
            return Self::native(path);
        }
        let Some(format) = Format::of(path) else {
            let message = "expected a scene: a `.toml`, an `.obj` or a `.ply` file";
            return Err(SceneError::file(path, message));
        };
        let file = GeometryFile::new(path, format).map_err(|e| SceneError::io(path, &e))?;
        Ok(Self {
            path: path.to_owned(),
            native: None,
            files: vec![file],
            sky: None,
        })
    }

    fn native(path: &Path) -> Result<Self, SceneError> {
        let file = SceneFile::read(path)?;
        let said = file.parse()?;
        let mut files: Vec<GeometryFile> = Vec::new();
        let media: Vec<&str> = said.media.keys().map(String::as_str).collect();
        let surfaces = surfaces::compile(&file, &said.materials, &media)?;
        let shapes = Shapes::new(&file, &surfaces.materials, &[], Vec::new());
        shapes.check_instances(&said)?;
        for shape in said.all_shapes() {
            shapes.check(shape)?;
            let Some((name, format)) = shape.get_ref().file() else {
                continue;
            };
            let path = file.beside(name.get_ref());
            match files
                .iter_mut()
                .find(|f| f.path == path && f.format == format)
            {
                Some(known) => known.uses += 1,
                // A file that is not there is the scene file's mistake; one that is wrong is not.
                None => files.push(GeometryFile::new(&path, format).map_err(|e| {
                    let message = format!("{}: {}", path.display(), io_message(&e));
                    file.error(name.span(), message)
                })?),
            }
        }
        compile::check(&file, &said)?;
        let sky = lights::map_file(&file, &said)?;
        Ok(Self {
            sky,
            path: path.to_owned(),
            native: Some(Native {
                file,
                said,
                surfaces,
            }),
            files,
        })
    }

    /// Bytes that [`Source::parse`] will read.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        self.files.iter().map(|f| f.size).sum()
    }

    /// The film that the scene asks for.
    #[must_use]
    pub fn film(&self) -> FilmSpec {
        compile::film(self.native.as_ref().map(|native| &native.said.film))
    }

    /// The preset of the tree that the scene asks for.
    #[must_use]
    pub fn bvh(&self) -> Preset {
        let said = self
            .native
            .as_ref()
            .and_then(|native| native.said.settings.bvh);
        said.unwrap_or_default()
    }

    /// Vertices, triangles, spheres and instances that the compiled scene will have, those of objects
    /// once, by the headers of its files and a
    /// look through those that have none, without keeping anything: exact, but for vertices that no
    /// triangle uses and triangles of zero area, which loading leaves out; for vertices that are split
    /// where corners of an OBJ file disagree about normals or texture coordinates, which are not
    /// foreseen; and for polygons of PLY files with further lists, of which it is an upper bound.
    ///
    /// # Errors
    /// A file that cannot be read, or a header that is wrong.
    pub fn counts(&self) -> Result<Counts, SceneError> {
        let count = |file: &GeometryFile| {
            let (one, textures) = file.format.count(&file.path)?;
            let times = file.uses as u64;
            let counts = Counts {
                vertices: one.vertices.saturating_mul(times),
                triangles: one.triangles.saturating_mul(times),
                ..Counts::default()
            };
            Ok((counts, textures))
        };
        type Count = Result<(Counts, Vec<Request>), SceneError>;
        let counts: Vec<Count> = self.files.par_iter().map(count).collect();
        let inline = self.native.iter();
        let inline = inline.flat_map(|native| native.said.all_shapes());
        let mut all = inline
            .map(|shape| shape.get_ref().counts())
            .fold(Counts::default(), |a, b| a + b);
        let instances = self.native.iter().flat_map(|native| &native.said.instances);
        all.instances = instances.map(|i| u64::from(i.get_ref().copies())).sum();
        let textures = self.native.iter().flat_map(|n| &n.surfaces.wanted);
        let mut textures: HashSet<Request> = textures.map(|w| w.request.clone()).collect();
        for counts in counts {
            let (counts, more) = counts?;
            all = all + counts;
            textures.extend(more);
        }
        let bytes = textures.iter().map(Request::bytes);
        all.texture_bytes = bytes.fold(0, u64::saturating_add);
        Ok(all)
    }

    /// Reads the files of geometry, then the textures, in parallel, each once, on the current rayon
    /// pool; `read` grows by the bytes of geometry read. The result does not depend on the number of threads.
    ///
    /// # Errors
    /// What is wrong with the first of them that is wrong.
    pub fn parse(self, read: &AtomicU64) -> Result<Parsed, SceneError> {
        let load = |file: &GeometryFile| file.format.load(&file.path, read);
        let loaded: Vec<Result<Imported, SceneError>> = self.files.par_iter().map(load).collect();
        let mut imported = loaded.into_iter().collect::<Result<Vec<_>, _>>()?;
        let own = self.native.iter().flat_map(|n| &n.surfaces.wanted);
        let own = own.map(|wanted| &wanted.request);
        let wanted = own.chain(imported.iter().flat_map(Imported::wanted));
        let mut store = Store::load(wanted);
        for imported in &mut imported {
            surfaces::bind_imported(imported, &mut store);
        }
        let sky = self.sky.as_deref().map(panorama::load).transpose()?;
        Ok(Parsed {
            sky,
            source: self,
            imported,
            store,
        })
    }
}

impl Parsed {
    /// Makes the tables that the kernels read, on the current rayon pool.
    ///
    /// # Errors
    /// What can only be told with the geometry at hand: a material that a file does not have, a
    /// vertex that its transformation takes out of range.
    pub fn compile(self) -> Result<Scene, SceneError> {
        let Source {
            path,
            native,
            files,
            ..
        } = self.source;
        match native {
            Some(native) => compile::native(
                &native.file,
                &native.said,
                &files,
                self.imported,
                native.surfaces,
                self.store,
                self.sky,
            ),
            None => compile::bare(&path, self.imported, self.store),
        }
    }
}

impl GeometryFile {
    fn new(path: &Path, format: Format) -> std::io::Result<Self> {
        let file = std::fs::File::open(path)?;
        Ok(Self {
            path: path.to_owned(),
            format,
            size: file.metadata()?.len(),
            uses: 1,
        })
    }
}
