//! How paths go on and end, as scene files say it.

use crate::settings::Settings;
use serde::de::{Deserialize, Deserializer, Error, SeqAccess, Unexpected, Visitor};
use std::fmt;

/// How readily paths end at random: a boolean, or a word of the command line's `--roulette`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Roulette {
    pub(super) on: bool,
    /// [`Settings::survival`].
    pub(super) survival: f32,
}

impl From<bool> for Roulette {
    fn from(on: bool) -> Self {
        let survival = Settings::default().survival;
        Self { on, survival }
    }
}

impl<'de> Deserialize<'de> for Roulette {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        struct Read;
        impl Visitor<'_> for Read {
            type Value = Roulette;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("true, false, \"on\", \"off\" or \"aggressive\"")
            }
            fn visit_bool<E: Error>(self, on: bool) -> Result<Roulette, E> {
                Ok(on.into())
            }
            fn visit_str<E: Error>(self, word: &str) -> Result<Roulette, E> {
                match word {
                    "on" => Ok(true.into()),
                    "off" => Ok(false.into()),
                    "aggressive" => Ok(Roulette {
                        on: true,
                        survival: Settings::AGGRESSIVE,
                    }),
                    _ => Err(E::invalid_value(Unexpected::Str(word), &self)),
                }
            }
        }
        from.deserialize_any(Read)
    }
}

/// Ways on from the first surfaces: [`Settings::split`]. One number, or an array.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Split(pub(super) Vec<u32>);

impl Split {
    fn checked<E: Error>(numbers: Vec<i64>) -> Result<Self, E> {
        let found = format!("{numbers:?}");
        let wrong = || {
            E::custom(format_args!(
                "found {found}, expected at most {} whole numbers from 1 whose product is at most {}",
                Settings::MOST_SPLITS,
                Settings::MOST_BRANCHES
            ))
        };
        let natural = |n: i64| u32::try_from(n).ok().filter(|n| *n > 0);
        let all: Option<Vec<u32>> = numbers.into_iter().map(natural).collect();
        let all = all.filter(|all| all.len() <= Settings::MOST_SPLITS);
        let all = all.ok_or_else(wrong)?;
        let product = all.iter().map(|&n| u64::from(n));
        let product = product.fold(1u64, u64::saturating_mul);
        if product > Settings::MOST_BRANCHES.into() {
            return Err(wrong());
        }
        Ok(Self(all))
    }
}

impl<'de> Deserialize<'de> for Split {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        struct Read;
        impl<'de> Visitor<'de> for Read {
            type Value = Split;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a whole number, or an array of them")
            }
            fn visit_i64<E: Error>(self, n: i64) -> Result<Split, E> {
                Split::checked(vec![n])
            }
            fn visit_seq<A: SeqAccess<'de>>(self, mut all: A) -> Result<Split, A::Error> {
                let mut numbers = Vec::new();
                while let Some(n) = all.next_element()? {
                    numbers.push(n);
                }
                Split::checked(numbers)
            }
        }
        from.deserialize_any(Read)
    }
}
