//! Values of materials that an image may vary.

use super::said::{self, ColorSpace, Image, Value};
use super::slots::Problem;
use crate::scene::degrees;
use crate::scene::error::SceneError;
use crate::scene::import::Imported;
use crate::scene::material::{Channel, Material, Relief, TexelFilter, TextureUse, Textured, Wrap};
use crate::scene::texture::{Request, Store, beside};
use crate::scene::toml::SceneFile;
use crate::scene::values::{Finite, NonNegative, OneOrThree, Unit};
use std::ops::Range;
use toml::Spanned;

/// A texture that a scene file names, and where.
#[derive(Debug)]
pub(in crate::scene) struct Wanted {
    pub(in crate::scene) request: Request,
    span: Range<usize>,
}

/// A value in a scene file that becomes numbers.
pub(super) trait Parameter: Copy {
    /// What it becomes.
    type Number: Copy;
    /// Whether an image of it is read as colours.
    const COLOUR: bool;
    /// Largest factor of an image.
    const LARGEST: f64;
    fn number(self) -> Self::Number;
    fn of_factor(factor: [f32; 3]) -> Self::Number;
}

macro_rules! parameter {
    ($type:ty, $number:ty, $largest:expr, |$x:ident| $from:expr, |$f:ident| $of:expr) => {
        impl Parameter for $type {
            type Number = $number;
            const COLOUR: bool = size_of::<$number>() > 4;
            const LARGEST: f64 = $largest;
            fn number(self) -> $number {
                let $x = self;
                $from
            }
            fn of_factor($f: [f32; 3]) -> $number {
                $of
            }
        }
    };
}
parameter!(Unit, f32, 1.0, |x| x.0 as f32, |f| f[0]);
parameter!(Finite, f32, 1.0, |x| x.0 as f32, |f| f[0]);
parameter!(
    OneOrThree<Unit>,
    [f32; 3],
    1.0,
    |x| x.0.map(|c| c.0 as f32),
    |f| f
);
parameter!(
    OneOrThree<NonNegative>,
    [f32; 3],
    f64::INFINITY,
    |x| x.0.map(|c| c.0 as f32),
    |f| f
);

/// Collects what materials want of images.
#[derive(Debug)]
pub(super) struct Images<'f> {
    file: &'f SceneFile,
    pub(super) wanted: Vec<Wanted>,
    pub(super) warnings: Vec<String>,
}

impl<'f> Images<'f> {
    pub(super) fn new(file: &'f SceneFile) -> Self {
        Self {
            file,
            wanted: Vec::new(),
            warnings: Vec::new(),
        }
    }

    /// A number or colour.
    pub(super) fn value<N: Parameter>(
        &mut self,
        said: &Option<Spanned<Value<N>>>,
        default: N::Number,
    ) -> Result<Textured<N::Number>, SceneError> {
        self.textured(said, default, Channel::Red)
    }

    /// An opacity: of an image, its alpha channel.
    pub(super) fn opacity(
        &mut self,
        said: &Option<Spanned<Value<Unit>>>,
    ) -> Result<Textured<f32>, SceneError> {
        self.textured(said, 1.0, Channel::Alpha)
    }

    /// A roughness, limited to its range.
    pub(super) fn roughness(
        &mut self,
        said: &Option<Spanned<Value<Finite>>>,
        default: f32,
    ) -> Result<Textured<f32>, SceneError> {
        let mut value = self.textured(said, default, Channel::Red)?;
        if let Some(said) = said
            && let Value::Plain(number) = said.get_ref()
        {
            let number = Spanned::new(said.span(), *number);
            value.factor = self.limited(&number, 0.0, 1.0);
        }
        Ok(value)
    }

    /// A number within its range, with a warning where it was not.
    pub(super) fn limited(&mut self, said: &Spanned<Finite>, low: f64, high: f64) -> f32 {
        let found = said.get_ref().0;
        let limited = found.clamp(low, high);
        if limited != found {
            let message = format!(
                "found {found:?}, expected a number from {low} to {high}; {limited} is taken"
            );
            let place = self.file.error(said.span(), message);
            self.warnings.push(place.to_string());
        }
        limited as f32
    }

    /// The texture of a normal or bump map.
    pub(super) fn relief(&mut self, image: &Image, kind: Relief) -> Result<TextureUse, SceneError> {
        if let Some(factor) = &image.factor {
            let message = "is for values, expected `strength`";
            return Err(self.file.error(factor.span(), message));
        }
        match (kind, &image.channel) {
            (Relief::Normals, Some(channel)) => {
                let message = "a normal map has no use for one channel";
                Err(self.file.error(channel.span(), message))
            }
            (Relief::Normals, None) => self.texture(image, false, Channel::Colour),
            (Relief::Bump, _) => self.texture(image, false, Channel::Red),
        }
    }

    fn textured<N: Parameter>(
        &mut self,
        said: &Option<Spanned<Value<N>>>,
        default: N::Number,
        channel: Channel,
    ) -> Result<Textured<N::Number>, SceneError> {
        let image = match said.as_ref().map(Spanned::get_ref) {
            None => return Ok(Textured::constant(default)),
            Some(Value::Plain(plain)) => return Ok(Textured::constant(plain.number())),
            Some(Value::Image(image)) => image,
        };
        if let Some(strength) = &image.strength {
            let message = "is for normal and bump maps, expected `factor`";
            return Err(self.file.error(strength.span(), message));
        }
        let channel = if N::COLOUR { Channel::Colour } else { channel };
        if let (Some(said), true) = (&image.channel, N::COLOUR) {
            let message = "a colour has no use for one channel";
            return Err(self.file.error(said.span(), message));
        }
        let factor = match &image.factor {
            None => [1.0; 3],
            Some(said) => {
                let factor = said.get_ref().0.map(|c| c.0);
                let single = N::COLOUR || factor == [factor[0]; 3];
                if !single || factor.iter().any(|&c| c > N::LARGEST) {
                    let expected = match (N::COLOUR, N::LARGEST) {
                        (false, _) => "a number from 0 to 1",
                        (true, _) => "a colour from 0 to 1",
                    };
                    let message = format!("found {factor:?}, expected {expected}");
                    return Err(self.file.error(said.span(), message));
                }
                factor.map(|c| c as f32)
            }
        };
        Ok(Textured {
            factor: N::of_factor(factor),
            texture: Some(self.texture(image, N::COLOUR, channel)?),
        })
    }

    /// Asks for a texture: a colour's bytes are stored with the curve of sRGB unless the file says
    /// otherwise.
    fn texture(
        &mut self,
        image: &Image,
        colour: bool,
        channel: Channel,
    ) -> Result<TextureUse, SceneError> {
        let space = image.color_space.as_ref().map(|s| *s.get_ref());
        let path = beside(&self.file.path, image.file.get_ref());
        let request = Request {
            srgb: space.map_or(colour, |s| s == ColorSpace::Srgb),
            path,
        };
        let known = self.wanted.iter().position(|w| w.request == request);
        let texture = match known {
            Some(known) => known,
            None => {
                let span = image.file.span();
                request.check().map_err(|why| {
                    let message = format!("{}: {why}", request.path.display());
                    self.file.error(span.clone(), message)
                })?;
                self.wanted.push(Wanted { request, span });
                self.wanted.len() - 1
            }
        };
        Ok(TextureUse {
            texture: texture as u32,
            channel: image
                .channel
                .as_ref()
                .map_or(channel, |c| match c.get_ref() {
                    said::Channel::R => Channel::Red,
                    said::Channel::G => Channel::Green,
                    said::Channel::B => Channel::Blue,
                    said::Channel::A => Channel::Alpha,
                }),
            uv: self.placed(image)?,
            wrap: image.wrap.map_or([Wrap::Repeat; 2], |w| {
                w.0.map(|w| match w {
                    said::Wrap::Repeat => Wrap::Repeat,
                    said::Wrap::Mirror => Wrap::Mirror,
                    said::Wrap::Clamp => Wrap::Clamp,
                })
            }),
            filter: match image.filter {
                said::Filter::Linear => TexelFilter::Linear,
                said::Filter::Nearest => TexelFilter::Nearest,
            },
        })
    }

    /// Scaled, then turned, then moved.
    fn placed(&self, image: &Image) -> Result<[[f32; 3]; 2], SceneError> {
        let scale = image.scale.as_ref();
        let [across, up] = scale.map_or([1.0; 2], |s| s.get_ref().0.map(|x| x.0));
        if let (Some(said), true) = (scale, across == 0.0 || up == 0.0) {
            let message = "found 0, expected how often the image repeats";
            return Err(self.file.error(said.span(), message));
        }
        let angle = image.rotate.map_or(0.0, |a| a.0);
        let (sin, cos) = degrees::sin_cos(angle);
        let [x, y] = image.offset.map_or([0.0; 2], |o| o.map(|x| x.0));
        let rows = [[across * cos, -up * sin, x], [across * sin, up * cos, y]];
        Ok(rows.map(|row| row.map(|x| x as f32)))
    }
}

/// Replaces the places of `wanted` textures in `materials` by indices among the scene's textures.
///
/// # Errors
/// A texture that could not be loaded, or that holds what a material cannot have.
pub(in crate::scene) fn bind(
    file: &SceneFile,
    materials: &mut [Material],
    wanted: &[Wanted],
    store: &mut Store,
    warnings: &mut Vec<String>,
) -> Result<(), SceneError> {
    for material in materials {
        for mut slot in material.textures_mut() {
            let wanted = &wanted[slot.texture() as usize];
            let wrong = |why: String| {
                let message = format!("{}: {why}", wanted.request.path.display());
                file.error(wanted.span.clone(), message)
            };
            let index = store.get(&wanted.request).map_err(wrong)?;
            match slot.problem(store.texture(index)) {
                Some(Problem::Negative(found)) => {
                    let what = slot.what();
                    let message = format!("holds {found}, expected {what} of at least 0");
                    return Err(wrong(message));
                }
                Some(Problem::AboveOne(found)) => {
                    let what = slot.what();
                    let message = format!("holds {found} as {what}; above 1 it makes light");
                    warnings.push(wrong(message).to_string());
                }
                None => {}
            }
            slot.set(index);
        }
    }
    Ok(())
}

/// The same for the materials of a file of geometry: what is wrong with a texture is a warning, and
/// the texture is left out.
pub(in crate::scene) fn bind_imported(imported: &mut Imported, store: &mut Store) {
    let wanted = std::mem::take(&mut imported.textures);
    for material in &mut imported.materials {
        let name = material.name.clone();
        for mut slot in material.textures_mut() {
            let request = &wanted[slot.texture() as usize];
            let found =
                store
                    .get(request)
                    .and_then(|index| match slot.problem(store.texture(index)) {
                        Some(Problem::Negative(found)) => Err(format!("holds {found}")),
                        _ => Ok(index),
                    });
            match found {
                Ok(index) => slot.set(index),
                Err(why) => {
                    imported.warnings.push(format!(
                        "{}: {why}; material `{name}` goes without its {}",
                        request.path.display(),
                        slot.what()
                    ));
                    slot.remove();
                }
            }
        }
    }
}
