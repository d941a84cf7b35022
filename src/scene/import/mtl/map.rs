//! Texture statements of MTL: options, then a file name that may hold blanks.

use crate::scene::material::{Channel, TexelFilter, TextureUse, Wrap};

/// What a statement such as `map_Kd -s 2 2 1 -clamp on wood grain.png` says.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Map {
    pub(super) file: String,
    scale: [f32; 2],
    offset: [f32; 2],
    clamp: bool,
    /// `-bm`: of bump maps.
    pub(super) multiplier: f32,
    /// `-imfchan`.
    channel: Option<Channel>,
    /// Whether there are options that are not followed.
    pub(super) more: bool,
}

impl Map {
    /// None where no file is named.
    pub(super) fn parse(rest: &str) -> Option<Self> {
        let mut map = Self {
            file: String::new(),
            scale: [1.0; 2],
            offset: [0.0; 2],
            clamp: false,
            multiplier: 1.0,
            channel: None,
            more: false,
        };
        let mut rest = rest.trim();
        while rest.starts_with('-') {
            let (option, behind) = word(rest);
            rest = behind;
            match option.to_ascii_lowercase().as_str() {
                "-s" => map.scale = two(&mut rest, 1.0),
                "-o" => map.offset = two(&mut rest, 0.0),
                "-t" => {
                    two(&mut rest, 0.0);
                    map.more = true;
                }
                "-bm" => map.multiplier = number(&mut rest).unwrap_or(1.0),
                "-clamp" => {
                    let (on, behind) = word(rest);
                    map.clamp = on.eq_ignore_ascii_case("on");
                    rest = behind;
                }
                "-imfchan" => {
                    let (channel, behind) = word(rest);
                    map.channel = match channel {
                        "r" => Some(Channel::Red),
                        "g" => Some(Channel::Green),
                        "b" => Some(Channel::Blue),
                        "m" => Some(Channel::Alpha),
                        _ => None,
                    };
                    rest = behind;
                }
                "-mm" => {
                    number(&mut rest);
                    number(&mut rest);
                    map.more = true;
                }
                "-blendu" | "-blendv" | "-cc" | "-boost" | "-texres" | "-type" => {
                    rest = word(rest).1;
                    map.more = true;
                }
                // A file's name may begin so too.
                _ => {
                    map.file = format!("{option} {rest}").trim().to_owned();
                    return Some(map);
                }
            }
        }
        map.file = rest.to_owned();
        (!map.file.is_empty()).then_some(map)
    }

    /// As a use of the texture at `texture`; numbers are read from `channel` unless the statement
    /// names another.
    pub(super) fn texture(&self, texture: u32, channel: Channel) -> TextureUse {
        let channel = match (channel, self.channel) {
            (Channel::Colour, _) | (_, None) => channel,
            (_, Some(own)) => own,
        };
        let ([across, up], [x, y]) = (self.scale, self.offset);
        TextureUse {
            texture,
            channel,
            uv: [[across, 0.0, x], [0.0, up, y]],
            wrap: [if self.clamp {
                Wrap::Clamp
            } else {
                Wrap::Repeat
            }; 2],
            filter: TexelFilter::Linear,
        }
    }
}

/// The first word, and what is behind it.
fn word(rest: &str) -> (&str, &str) {
    rest.split_once(|c: char| c.is_ascii_whitespace())
        .map_or((rest, ""), |(word, rest)| (word, rest.trim_start()))
}

/// The number that comes first, if one does.
fn number(rest: &mut &str) -> Option<f32> {
    let (first, behind) = word(rest);
    let number = first.parse().ok().filter(|x: &f32| x.is_finite())?;
    // `1.png` is a name.
    *rest = behind;
    Some(number)
}

/// Up to three numbers, of which the third has no meaning for images.
fn two(rest: &mut &str, default: f32) -> [f32; 2] {
    let mut all = [default; 3];
    for x in &mut all {
        match number(rest) {
            Some(found) => *x = found,
            None => break,
        }
    }
    [all[0], all[1]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_and_names() {
        let map = Map::parse("-s 2 3 1 -o .5 -clamp on -mm 0 1 my wood 2.png").unwrap();
        assert_eq!(map.file, "my wood 2.png");
        assert!(map.more);
        let read = map.texture(4, Channel::Red);
        assert_eq!(read.uv, [[2.0, 0.0, 0.5], [0.0, 3.0, 0.0]]);
        assert_eq!((read.wrap, read.channel), ([Wrap::Clamp; 2], Channel::Red));
        let bump = Map::parse("-bm 0.2 -imfchan g b.png").unwrap();
        assert_eq!(bump.multiplier, 0.2);
        assert_eq!(bump.texture(0, Channel::Red).channel, Channel::Green);
        assert_eq!(bump.texture(0, Channel::Colour).channel, Channel::Colour);
        assert_eq!(Map::parse("-odd name.png").unwrap().file, "-odd name.png");
        assert_eq!(Map::parse(" plain.png ").unwrap().file, "plain.png");
        assert_eq!(Map::parse("-s 1 1 1"), None);
        assert_eq!(Map::parse(""), None);
    }
}
