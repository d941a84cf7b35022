//! Mip levels: each texel of the next level is the mean over the texels that it covers, in linear
//! light. An odd row of `2 m + 1` texels goes to `m`, each of which covers `2 + 1/m` of them
//! (S. Guthe, P. Heckbert, "Non-Power-of-Two Mipmap Creation", NVIDIA 2005). Where opacity varies,
//! colours weigh as much as they are opaque.

use super::decode::Base;
use super::{MipLevel, TexelFormat, Texture};
use huygens_kernels::texture::{self, Channel, DECODE};
use rayon::prelude::*;

/// Red, green, blue, opacity.
type Texel = [f32; 4];

/// The texture of an image, with all levels down to one texel.
pub(super) fn texture(name: String, base: Base) -> Texture {
    let mut levels = vec![base.level()];
    let mut words = base.words;
    let (format, srgb) = (base.format, base.srgb);
    let mut range = [f32::INFINITY, f32::NEG_INFINITY];
    let mut last: Option<Vec<Texel>> = None;
    let mut size = base.size;
    {
        let view = view(&words, format, srgb, &levels);
        let colours = (0..size[0] as usize * size[1] as usize).into_par_iter();
        let each = colours.map(|i| view.texel(0, i, Channel::Colour));
        let spans = each.map(|c| (c[0].min(c[1]).min(c[2]), c[0].max(c[1]).max(c[2])));
        let none = || (f32::INFINITY, f32::NEG_INFINITY);
        let (low, high) = spans.reduce(none, |a, b| (a.0.min(b.0), a.1.max(b.1)));
        range = [range[0].min(low), range[1].max(high)];
    }
    while size != [1, 1] {
        let next = size.map(|n| (n / 2).max(1));
        let texels = match &last {
            Some(texels) => halve(size, next, |i| texels[i]),
            None => {
                let view = view(&words, format, srgb, &levels);
                halve(size, next, |i| whole(&view, i))
            }
        };
        levels.push(MipLevel {
            size: next,
            first: words.len() as u32,
        });
        append(&mut words, &texels, format, srgb);
        last = Some(texels);
        size = next;
    }
    words.shrink_to_fit();
    Texture {
        name,
        format,
        srgb,
        levels,
        words,
        range,
    }
}

fn view<'a>(
    words: &'a [u32],
    format: TexelFormat,
    srgb: bool,
    levels: &'a [MipLevel],
) -> texture::Texture<'a> {
    texture::Texture {
        words,
        format,
        srgb,
        levels,
    }
}

/// Texel `i` of the whole image.
fn whole(view: &texture::Texture<'_>, i: usize) -> Texel {
    let [r, g, b] = view.texel(0, i, Channel::Colour);
    let [alpha, ..] = match view.format {
        TexelFormat::Rgba8 => view.texel(0, i, Channel::Alpha),
        _ => [1.0; 3],
    };
    [r, g, b, alpha]
}

/// Which texels of a row of `from` texel `i` of one of `to` covers, and what each weighs.
fn covered(from: u32, to: u32, i: u32) -> impl Iterator<Item = (u32, f32)> + Clone {
    let weights = if from == to {
        [1.0, 0.0, 0.0]
    } else if from.is_multiple_of(2) {
        [0.5, 0.5, 0.0]
    } else {
        [to - i, to, i + 1].map(|w| w as f32 / from as f32)
    };
    let first = if from == to { i } else { 2 * i };
    (first..).zip(weights).filter(|&(_, w)| w > 0.0)
}

/// The next level.
fn halve(from: [u32; 2], to: [u32; 2], texel: impl Fn(usize) -> Texel + Sync) -> Vec<Texel> {
    let row = |y: u32| {
        let texel = &texel;
        (0..to[0]).map(move |x| {
            let (mut sum, mut plain, mut alpha) = ([0.0; 3], [0.0; 3], 0.0);
            for (v, up) in covered(from[1], to[1], y) {
                for (u, across) in covered(from[0], to[0], x) {
                    let [r, g, b, a] = texel(v as usize * from[0] as usize + u as usize);
                    let weight = up * across;
                    for (c, value) in [r, g, b].into_iter().enumerate() {
                        sum[c] += weight * a * value;
                        plain[c] += weight * value;
                    }
                    alpha += weight * a;
                }
            }
            let [r, g, b] = if alpha > 0.0 {
                sum.map(|s| s / alpha)
            } else {
                plain
            };
            [r, g, b, alpha]
        })
    };
    let rows: Vec<Vec<Texel>> = (0..to[1])
        .into_par_iter()
        .map(|y| row(y).collect())
        .collect();
    rows.concat()
}

/// Texels as words behind the others.
fn append(words: &mut Vec<u32>, texels: &[Texel], format: TexelFormat, srgb: bool) {
    let byte = |x: f32| nearest(&DECODE[usize::from(srgb)], x);
    match format {
        TexelFormat::Rgba8 => words.extend(texels.iter().map(|&[r, g, b, a]| {
            u32::from_le_bytes([byte(r), byte(g), byte(b), nearest(&DECODE[0], a)])
        })),
        TexelFormat::Grey8 => words.extend(texels.chunks(4).map(|four| {
            let mut bytes = [0; 4];
            for (to, from) in bytes.iter_mut().zip(four) {
                *to = byte(from[0]);
            }
            u32::from_le_bytes(bytes)
        })),
        TexelFormat::Rgb32 => {
            words.extend(
                texels
                    .iter()
                    .flat_map(|t| [t[0], t[1], t[2]].map(f32::to_bits)),
            );
        }
        TexelFormat::Grey32 => words.extend(texels.iter().map(|t| t[0].to_bits())),
    }
}

/// The byte whose value is nearest.
fn nearest(table: &[f32; 256], x: f32) -> u8 {
    let above = table.partition_point(|&value| value < x).min(255);
    let below = above.saturating_sub(1);
    if x - table[below] < table[above] - x {
        below as u8
    } else {
        above as u8
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey(size: [u32; 2], texels: &[u8], srgb: bool) -> Texture {
        let words = texels.chunks(4).map(|four| {
            let mut bytes = [0; 4];
            bytes[..four.len()].copy_from_slice(four);
            u32::from_le_bytes(bytes)
        });
        let base = Base {
            size,
            format: TexelFormat::Grey8,
            srgb,
            words: words.collect(),
        };
        texture("grey".to_owned(), base)
    }

    #[test]
    fn every_byte_is_its_own_nearest() {
        for table in &DECODE {
            for byte in 0..=255u8 {
                assert_eq!(nearest(table, table[usize::from(byte)]), byte);
            }
            assert_eq!((nearest(table, -1.0), nearest(table, 2.0)), (0, 255));
        }
    }

    /// Whatever the size, weights are those of an even cover, and the last level is the mean.
    #[test]
    fn each_texel_weighs_the_same() {
        for n in 2..40u32 {
            let m = n / 2;
            let mut weight = vec![0.0; n as usize];
            for i in 0..m {
                let of: Vec<(u32, f32)> = covered(n, m, i).collect();
                let sum: f32 = of.iter().map(|&(_, w)| w).sum();
                assert!((sum - 1.0).abs() <= 4.0 * f32::EPSILON);
                for (at, w) in of {
                    weight[at as usize] += f64::from(w);
                }
            }
            let each = f64::from(m) / f64::from(n);
            for w in weight {
                assert!((w - each).abs() <= 4.0 * f64::from(f32::EPSILON), "{n}");
            }
        }
    }

    #[test]
    fn means_are_those_of_light_not_of_bytes() {
        let half = grey([2, 1], &[0, 255], true);
        assert_eq!(half.levels.len(), 2);
        // Half the light is byte 188 with the curve of sRGB, 128 without it.
        assert_eq!(half.words[half.levels[1].first as usize], 188);
        let half = grey([2, 1], &[0, 255], false);
        assert!([127, 128].contains(&half.words[half.levels[1].first as usize]));
        assert_eq!(half.range, [0.0, 1.0]);
        let odd = grey([3, 5], &[90; 15], true);
        assert_eq!(odd.levels.len(), 3);
        assert_eq!(odd.mean(), [DECODE[1][90]; 3]);
    }

    #[test]
    fn what_is_transparent_does_not_stain_the_rest() {
        let base = Base {
            size: [2, 1],
            format: TexelFormat::Rgba8,
            srgb: false,
            words: vec![0xff00_00ff, 0x0000_ff00],
        };
        let texture = texture("cut-out".to_owned(), base);
        let [r, g, b, a] = texture.words[texture.levels[1].first as usize].to_le_bytes();
        assert_eq!((r, g, b), (255, 0, 0));
        assert!([127, 128].contains(&a));
    }
}
