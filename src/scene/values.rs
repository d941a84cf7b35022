//! Numbers as scene files write them, checked while they are read, so that an error points at the
//! number itself.

use serde::de::{Deserialize, Deserializer, Error, SeqAccess, Visitor, value};
use std::fmt;
use std::marker::PhantomData;

/// Declares a type of number: its name, what it holds, what an error says was expected, and which
/// f64 values it takes. Whole numbers and fractions are both accepted.
macro_rules! number {
    ($(#[$doc:meta])* $name:ident, $expected:literal, |$x:ident| $holds:expr) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub(super) struct $name(pub(super) f64);

        impl<'de> Deserialize<'de> for $name {
            fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
                struct Read;
                impl Visitor<'_> for Read {
                    type Value = $name;
                    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                        f.write_str($expected)
                    }
                    fn visit_f64<E: Error>(self, $x: f64) -> Result<$name, E> {
                        if $holds {
                            Ok($name($x))
                        } else {
                            Err(E::custom(format_args!("found {:?}, expected {}", $x, $expected)))
                        }
                    }
                    fn visit_i64<E: Error>(self, whole: i64) -> Result<$name, E> {
                        let $x = whole as f64;
                        if $holds {
                            Ok($name($x))
                        } else {
                            Err(E::custom(format_args!("found {whole}, expected {}", $expected)))
                        }
                    }
                }
                from.deserialize_f64(Read)
            }
        }
    };
}

/// The kernels read f32: what overflows there is not finite.
const LARGEST: f64 = f32::MAX as f64;

number!(
    /// A coordinate or a component.
    Finite, "a finite number", |x| x.abs() <= LARGEST
);
number!(
    /// A reflectance.
    Unit, "a number from 0 to 1", |x| (0.0..=1.0).contains(&x)
);
number!(
    /// A radiance.
    NonNegative, "a finite number of at least 0", |x| (0.0..=LARGEST).contains(&x)
);
number!(
    /// A distance. What f32 would round to zero is not positive.
    Positive, "a finite number above 0", |x| x as f32 > 0.0 && x <= LARGEST
);
number!(
    /// A radius that may be 0. What is above 0 is so in f32 too.
    Radius, "0 or a finite number above 0", |x| x == 0.0 || (x as f32 > 0.0 && x <= LARGEST)
);
number!(
    /// A field of view in degrees.
    FieldOfView, "an angle above 0 and below 180 degrees", |x| x > 0.0 && x < 180.0
);

number!(
    /// The angle that a disc in the sky subtends, in degrees.
    Angle, "an angle of 0 to 180 degrees", |x| (0.0..=180.0).contains(&x)
);

number!(
    /// How hazy a clear sky is.
    Turbidity, "a number from 2 to 10", |x| (2.0..=10.0).contains(&x)
);

number!(
    /// The mean cosine of a phase function: within what kernels tell apart of a peak
    /// (`phase::G_LIMIT`).
    MeanCosine, "a number from -0.999 to 0.999", |x| x.abs() <= 0.999
);

/// Declares a type of whole number within u32.
macro_rules! whole {
    ($(#[$doc:meta])* $name:ident, $expected:literal, $range:expr) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq)]
        pub(super) struct $name(pub(super) u32);

        impl<'de> Deserialize<'de> for $name {
            fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
                struct Read;
                impl Visitor<'_> for Read {
                    type Value = $name;
                    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                        f.write_str($expected)
                    }
                    fn visit_i64<E: Error>(self, x: i64) -> Result<$name, E> {
                        match u32::try_from(x) {
                            Ok(small) if $range.contains(&small) => Ok($name(small)),
                            _ => Err(E::custom(format_args!("found {x}, expected {}", $expected))),
                        }
                    }
                }
                from.deserialize_i64(Read)
            }
        }
    };
}

whole!(
    /// An edge of the image in pixels.
    Pixels, "a whole number from 1 to 65535", (1..=65535)
);
whole!(
    /// Samples a pixel.
    Count, "a whole number from 1 to 4294967295", (1..=u32::MAX)
);
whole!(
    /// A seed or a depth.
    Natural, "a whole number from 0 to 4294967295", (0..=u32::MAX)
);

/// One number for all three channels or axes, or three.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct OneOrThree<N>(pub(super) [N; 3]);

impl<'de, N: Deserialize<'de> + Copy> Deserialize<'de> for OneOrThree<N> {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        struct Read<N>(PhantomData<N>);
        impl<'de, N: Deserialize<'de> + Copy> Visitor<'de> for Read<N> {
            type Value = OneOrThree<N>;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number or an array of three")
            }
            fn visit_f64<E: Error>(self, x: f64) -> Result<Self::Value, E> {
                Ok(OneOrThree(
                    [N::deserialize(value::F64Deserializer::new(x))?; 3],
                ))
            }
            fn visit_i64<E: Error>(self, x: i64) -> Result<Self::Value, E> {
                Ok(OneOrThree(
                    [N::deserialize(value::I64Deserializer::new(x))?; 3],
                ))
            }
            fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<Self::Value, A::Error> {
                let all = value::SeqAccessDeserializer::new(seq);
                Ok(OneOrThree(<[N; 3]>::deserialize(all)?))
            }
        }
        from.deserialize_any(Read(PhantomData))
    }
}
