//! A scene as the kernels read it: flat tables, world space, linear Rec. 709 colours.

use super::light::{Light, Sky};
use super::material::Material;
use super::medium::{Fog, Medium};
use super::motion::Motion;
use super::placed::{Instance, Object, Sphere};
use super::texture::Texture;
use crate::settings::Settings;
use serde::{Deserialize, Serialize};

/// A compiled scene.
#[derive(Clone, Debug)]
pub struct Scene {
    /// For people: the scene's title or its file's stem.
    pub name: String,
    /// BLAKE3 of everything that the image depends on in the scene (not of the file's layout).
    pub hash: [u8; 32],
    /// The camera.
    pub camera: Camera,
    /// How it moves while the shutter is open, if it does, about where it stands when that opens.
    pub camera_motion: Option<Motion>,
    /// The film.
    pub film: FilmSpec,
    /// All triangles but those of objects.
    pub mesh: Mesh,
    /// Spheres.
    pub spheres: Vec<Sphere>,
    /// What instances copy.
    pub objects: Vec<Object>,
    /// Copies of objects. All triangles, spheres and triangles of copies together can be numbered
    /// with 32 bits, and one to spare.
    pub instances: Vec<Instance>,
    /// Materials, indexed by [`Mesh::material`].
    pub materials: Vec<Material>,
    /// Textures, indexed by [`super::material::TextureUse::texture`].
    pub textures: Vec<Texture>,
    /// The sky around the scene, if there is one.
    pub sky: Option<Sky>,
    /// Lights that are no surfaces.
    pub lights: Vec<Light>,
    /// Media, whether anything is filled with them or not.
    pub media: Vec<Medium>,
    /// What fills the space outside of all glass, if anything does.
    pub fog: Option<Fog>,
    /// Settings of the scene's file over the defaults.
    pub settings: Settings,
    /// Fallbacks taken while loading, each once, in the order met.
    pub warnings: Vec<String>,
}

/// Triangles in world space. All vertices are finite, all indices valid, no triangle has two equal
/// vertices' positions on a line (zero area).
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// Vertex positions, scene units.
    pub vertices: Vec<[f32; 3]>,
    /// Vertex indices of each triangle; counter-clockwise seen from its front.
    pub indices: Vec<[u32; 3]>,
    /// Material index of each triangle.
    pub material: Vec<u32>,
    /// Shading normals of the first so many vertices, octahedral
    /// (two 16-bit numbers, of a map of the sphere to a square), or [`Mesh::NO_NORMAL`]. Empty where no vertex has any. A
    /// triangle of which a corner has none is flat.
    pub normals: Vec<u32>,
    /// Texture coordinates of the first so many vertices; NaN where a vertex has none. Empty where
    /// no vertex has any.
    pub uvs: Vec<[f32; 2]>,
}

impl Mesh {
    /// What stands in [`Mesh::normals`] for a vertex without one: no normal is stored so.
    pub const NO_NORMAL: u32 = 0x8000_8000;

    /// Texture coordinates of a vertex without any.
    pub const NO_UV: [f32; 2] = [f32::NAN; 2];

    /// Number of triangles.
    #[must_use]
    pub fn triangles(&self) -> usize {
        self.indices.len()
    }

    /// The three corners of triangle `i`.
    #[must_use]
    pub fn corners(&self, i: usize) -> [[f32; 3]; 3] {
        self.indices[i].map(|v| self.vertices[v as usize])
    }
}

/// A camera: where it stands, how it is turned, and how it projects.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Where it stands: centre of projection, middle of the lens or of the plane of parallel rays.
    pub origin: [f32; 3],
    /// Unit vector towards the scene.
    pub forward: [f32; 3],
    /// Unit vector to the right of the image.
    pub right: [f32; 3],
    /// Unit vector to the top of the image.
    pub up: [f32; 3],
    /// How it projects.
    pub projection: Projection,
}

/// From the film to rays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// Rays from one point, or through one lens. The extent is that of the image at distance 1: half
    /// the width is the tangent of half the horizontal field of view.
    Perspective {
        /// Half of the image, at distance 1.
        extent: Extent,
        /// The lens; without one, the camera is a pinhole.
        lens: Option<Lens>,
    },
    /// Parallel rays.
    Orthographic {
        /// Half of the image, in scene units.
        extent: Extent,
    },
    /// All directions, equirectangular: longitude across, with `forward` in the middle; latitude
    /// down, with `up` at the upper edge.
    Panorama,
}

impl Projection {
    /// Half the image, where it has a width and a height.
    pub fn extent_mut(&mut self) -> Option<&mut Extent> {
        match self {
            Self::Perspective { extent, .. } | Self::Orthographic { extent } => Some(extent),
            Self::Panorama => None,
        }
    }
}

/// Half of an image's width and height; both positive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent {
    /// Half the width.
    pub half_width: f32,
    /// Half the height.
    pub half_height: f32,
}

/// A thin, round lens across the view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    /// Its radius in scene units, positive.
    pub radius: f32,
    /// Distance of the plane of focus from the lens, along the view, in scene units; positive.
    pub focus: f32,
}

/// Image size and pixel filter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilmSpec {
    /// Pixels across, 1..=65535.
    pub width: u32,
    /// Pixels down, 1..=65535.
    pub height: u32,
    /// Pixel filter.
    pub filter: Filter,
}

/// Pixel reconstruction filters, separable, realised by filter importance sampling (M. Ernst,
/// M. Stamminger, G. Greiner, "Filter Importance Sampling", RT 2006): a sample's position is drawn
/// from the filter and weighs 1 in its own pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Filter {
    /// One pixel wide.
    Box,
    /// Linear fall-off to radius 1.
    Tent,
    /// Standard deviation 0.5, cut at radius 1.5.
    Gaussian,
    /// Four-term Blackman-Harris window of radius 1.65.
    BlackmanHarris,
}
