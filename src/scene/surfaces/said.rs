//! What a scene file says of a material, key by key.

use crate::scene::values::{Finite, NonNegative, OneOrThree, Positive, Unit};
use serde::de::{Deserialize, Deserializer, Error, MapAccess, SeqAccess, Visitor, value};
use std::fmt;
use std::marker::PhantomData;
use toml::Spanned;

/// `[materials.NAME]`: the keys of all kinds together; `compile` refuses those that the kind has no
/// use for.
#[derive(Debug, Default, serde::Deserialize)]
#[serde(deny_unknown_fields, default)]
#[serde(expecting = "a table such as { albedo = 0.5 }")]
pub(in crate::scene) struct Material {
    pub(super) kind: Option<Spanned<Kind>>,
    pub(super) emission: Option<Spanned<Value<OneOrThree<NonNegative>>>>,
    pub(super) emission_strength: Option<Spanned<NonNegative>>,
    pub(super) two_sided: bool,
    pub(super) alpha: Option<Spanned<Value<Unit>>>,
    pub(super) alpha_cutoff: Option<Spanned<Unit>>,
    pub(super) normal_map: Option<Spanned<Image>>,
    pub(super) bump_map: Option<Spanned<Image>>,

    pub(super) albedo: Option<Spanned<Value<OneOrThree<Unit>>>>,
    pub(super) roughness: Option<Spanned<Value<Finite>>>,
    pub(super) metal: Option<Spanned<String>>,
    pub(super) eta: Option<Spanned<OneOrThree<Positive>>>,
    pub(super) k: Option<Spanned<OneOrThree<NonNegative>>>,
    pub(super) tint: Option<Spanned<Value<OneOrThree<Unit>>>>,
    pub(super) anisotropy: Option<Spanned<Finite>>,
    pub(super) ior: Option<Spanned<Positive>>,
    pub(super) thin: Option<Spanned<bool>>,
    pub(super) reflection_tint: Option<Spanned<Value<OneOrThree<Unit>>>>,
    pub(super) transmission_tint: Option<Spanned<Value<OneOrThree<Unit>>>>,
    pub(super) abbe: Option<Spanned<Positive>>,
    pub(super) cauchy: Option<Spanned<TwoOrThree>>,
    pub(super) sellmeier: Option<Spanned<[[Finite; 3]; 2]>>,
    pub(super) interior: Option<Spanned<String>>,
    pub(super) exterior: Option<Spanned<String>>,
    pub(super) base_color: Option<Spanned<Value<OneOrThree<Unit>>>>,
    pub(super) metallic: Option<Spanned<Value<Unit>>>,
    pub(super) specular: Option<Spanned<Value<Unit>>>,
    pub(super) specular_color: Option<Spanned<Value<OneOrThree<NonNegative>>>>,
    pub(super) transmission: Option<Spanned<Value<Unit>>>,
    pub(super) clearcoat: Option<Spanned<Value<Unit>>>,
    pub(super) clearcoat_roughness: Option<Spanned<Value<Finite>>>,
    pub(super) sheen_color: Option<Spanned<Value<OneOrThree<Unit>>>>,
    pub(super) sheen_roughness: Option<Spanned<Value<Finite>>>,
    pub(super) compensation: Option<Spanned<bool>>,
    pub(super) materials: Option<Spanned<[Spanned<String>; 2]>>,
    pub(super) amount: Option<Spanned<Value<Unit>>>,
}

/// Kinds of materials.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Kind {
    #[default]
    Diffuse,
    Conductor,
    Dielectric,
    Principled,
    Mix,
}

/// A texture of a scene file.
#[derive(Debug, serde::Deserialize)]
#[serde(deny_unknown_fields)]
#[serde(expecting = "a table such as { file = \"image.png\" }")]
pub(super) struct Image {
    pub(super) file: Spanned<String>,
    #[serde(default)]
    pub(super) factor: Option<Spanned<OneOrThree<NonNegative>>>,
    #[serde(default)]
    pub(super) strength: Option<Spanned<Finite>>,
    #[serde(default)]
    pub(super) channel: Option<Spanned<Channel>>,
    #[serde(default)]
    pub(super) color_space: Option<Spanned<ColorSpace>>,
    #[serde(default)]
    pub(super) scale: Option<Spanned<OneOrTwo>>,
    #[serde(default)]
    pub(super) rotate: Option<Finite>,
    #[serde(default)]
    pub(super) offset: Option<[Finite; 2]>,
    #[serde(default)]
    pub(super) wrap: Option<Wraps>,
    #[serde(default)]
    pub(super) filter: Filter,
}

/// Which channel of an image a number is.
#[derive(Clone, Copy, Debug, PartialEq, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Channel {
    R,
    G,
    B,
    A,
}

/// How the bytes of an image are understood.
#[derive(Clone, Copy, Debug, PartialEq, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum ColorSpace {
    Srgb,
    Linear,
}

/// What lies beyond an image.
#[derive(Clone, Copy, Debug, PartialEq, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Wrap {
    Repeat,
    Mirror,
    Clamp,
}

/// What lies between texels.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Filter {
    #[default]
    Linear,
    Nearest,
}

/// One number or word for both axes of an image, or two.
#[derive(Clone, Copy, Debug)]
pub(super) struct Two<T>(pub(super) [T; 2]);
pub(super) type OneOrTwo = Two<Finite>;
pub(super) type Wraps = Two<Wrap>;

impl<'de, T: Deserialize<'de> + Copy> Deserialize<'de> for Two<T> {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        struct Read<T>(PhantomData<T>);
        impl<'de, T: Deserialize<'de> + Copy> Visitor<'de> for Read<T> {
            type Value = Two<T>;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("one value or an array of two")
            }
            fn visit_f64<E: Error>(self, x: f64) -> Result<Self::Value, E> {
                Ok(Two([T::deserialize(value::F64Deserializer::new(x))?; 2]))
            }
            fn visit_i64<E: Error>(self, x: i64) -> Result<Self::Value, E> {
                Ok(Two([T::deserialize(value::I64Deserializer::new(x))?; 2]))
            }
            fn visit_str<E: Error>(self, word: &str) -> Result<Self::Value, E> {
                Ok(Two([T::deserialize(value::StrDeserializer::new(word))?; 2]))
            }
            fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<Self::Value, A::Error> {
                let all = value::SeqAccessDeserializer::new(seq);
                Ok(Two(<[T; 2]>::deserialize(all)?))
            }
        }
        from.deserialize_any(Read(PhantomData))
    }
}

/// Two numbers or three; the third is 0 where there are two.
#[derive(Clone, Copy, Debug)]
pub(super) struct TwoOrThree(pub(super) [f64; 3]);

impl<'de> Deserialize<'de> for TwoOrThree {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let all = Vec::<Finite>::deserialize(from)?;
        match all[..] {
            [a, b] => Ok(Self([a.0, b.0, 0.0])),
            [a, b, c] => Ok(Self([a.0, b.0, c.0])),
            _ => {
                let found = all.len();
                let message = format!("found {found} numbers, expected two or three");
                Err(D::Error::custom(message))
            }
        }
    }
}

/// A number or colour, or an image of it.
#[derive(Debug)]
pub(super) enum Value<N> {
    Plain(N),
    Image(Box<Image>),
}

impl<'de, N: Deserialize<'de>> Deserialize<'de> for Value<N> {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        struct Read<N>(PhantomData<N>);
        impl<'de, N: Deserialize<'de>> Visitor<'de> for Read<N> {
            type Value = Value<N>;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number, a colour where one is meant, or an image { file = ... }")
            }
            fn visit_f64<E: Error>(self, x: f64) -> Result<Self::Value, E> {
                N::deserialize(value::F64Deserializer::new(x)).map(Value::Plain)
            }
            fn visit_i64<E: Error>(self, x: i64) -> Result<Self::Value, E> {
                N::deserialize(value::I64Deserializer::new(x)).map(Value::Plain)
            }
            fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<Self::Value, A::Error> {
                N::deserialize(value::SeqAccessDeserializer::new(seq)).map(Value::Plain)
            }
            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Self::Value, A::Error> {
                let image = Image::deserialize(value::MapAccessDeserializer::new(map))?;
                Ok(Value::Image(Box::new(image)))
            }
        }
        from.deserialize_any(Read(PhantomData))
    }
}
