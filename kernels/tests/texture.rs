//! Texture look-up against its formulas in f64.

use huygens_kernels::lanes::{Fx, LANES, Ux};
use huygens_kernels::texture::{
    Channel, DECODE, MipLevel, NO_TEXTURE, TexelFilter, TexelFormat, Texture, TextureUse, Textures,
    Wrap,
};
use proptest::prelude::*;

/// Half a unit in the last place of 1: one rounding.
const ROUNDING: f64 = 1.0 / 16_777_216.0;

/// Texels that no neighbour repeats, for all levels of an image of 8 by 4.
fn image(format: TexelFormat) -> (Vec<u32>, Vec<MipLevel>) {
    let mut words = vec![7; 5];
    let mut levels = Vec::new();
    for size in [[8u32, 4], [4, 2], [2, 1], [1, 1]] {
        let first = words.len() as u32;
        levels.push(MipLevel { size, first });
        let count = size[0] * size[1];
        let mut state = 12345 + count;
        let mut next = || {
            state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
            state ^ state >> 15
        };
        match format {
            TexelFormat::Rgba8 => words.extend((0..count).map(|_| next())),
            TexelFormat::Grey8 => words.extend((0..count.div_ceil(4)).map(|_| next())),
            TexelFormat::Grey32 => {
                words.extend((0..count).map(|_| (next() as f32 * 1e-8).to_bits()));
            }
            TexelFormat::Rgb32 => {
                words.extend((0..3 * count).map(|_| (next() as f32 * 1e-8).to_bits()));
            }
        }
    }
    (words, levels)
}

fn srgb(share: f64) -> f64 {
    if share <= 0.04045 {
        share / 12.92
    } else {
        ((share + 0.055) / 1.055).powf(2.4)
    }
}

/// Texel (`x`, `y`) of a level, as its format says.
fn texel(texture: &Texture, level: usize, x: i64, y: i64, channel: Channel) -> [f64; 3] {
    let MipLevel { size, first } = texture.levels[level];
    let index = (y * i64::from(size[0]) + x) as usize;
    let first = first as usize;
    let byte = |word: usize, i: usize| f64::from(texture.words[word] >> (8 * i) & 255) / 255.0;
    let colour = |x: f64| if texture.srgb { srgb(x) } else { x };
    let rgba = match texture.format {
        TexelFormat::Rgba8 => {
            let at = |i| byte(first + index, i);
            [colour(at(0)), colour(at(1)), colour(at(2)), at(3)]
        }
        TexelFormat::Grey8 => {
            let grey = colour(byte(first + index / 4, index % 4));
            [grey, grey, grey, 1.0]
        }
        TexelFormat::Rgb32 => {
            let at = |i| f64::from(f32::from_bits(texture.words[first + 3 * index + i]));
            [at(0), at(1), at(2), 1.0]
        }
        TexelFormat::Grey32 => {
            let grey = f64::from(f32::from_bits(texture.words[first + index]));
            [grey, grey, grey, 1.0]
        }
    };
    match channel {
        Channel::Colour => [rgba[0], rgba[1], rgba[2]],
        Channel::Red => [rgba[0]; 3],
        Channel::Green => [rgba[1]; 3],
        Channel::Blue => [rgba[2]; 3],
        Channel::Alpha => [rgba[3]; 3],
    }
}

/// Index of a texel that may lie beyond the image.
fn wrapped(i: i64, size: u32, wrap: Wrap) -> i64 {
    let n = i64::from(size);
    match wrap {
        Wrap::Repeat => i.rem_euclid(n),
        Wrap::Clamp => i.clamp(0, n - 1),
        Wrap::Mirror => {
            let i = i.rem_euclid(2 * n);
            i.min(2 * n - 1 - i)
        }
    }
}

fn level_at(texture: &Texture, read: &TextureUse, level: usize, uv: [f64; 2]) -> [f64; 3] {
    let size = texture.levels[level].size;
    let at = |x, y| {
        let x = wrapped(x, size[0], read.wrap[0]);
        let y = wrapped(y, size[1], read.wrap[1]);
        texel(texture, level, x, y, read.channel)
    };
    let place = [0, 1].map(|i| uv[i] * f64::from(size[i]));
    if read.filter == TexelFilter::Nearest {
        return at(place[0].floor() as i64, place[1].floor() as i64);
    }
    let place = place.map(|x| x - 0.5);
    let [x, y] = place.map(|x| x.floor() as i64);
    let [fx, fy] = place.map(|x| x - x.floor());
    let mix = |a: [f64; 3], b: [f64; 3], f: f64| [0, 1, 2].map(|c| a[c] + f * (b[c] - a[c]));
    let low = mix(at(x, y), at(x + 1, y), fx);
    let high = mix(at(x, y + 1), at(x + 1, y + 1), fx);
    mix(low, high, fy)
}

/// The look-up by its formulas.
fn twin(texture: &Texture, read: &TextureUse, uv: [f64; 2], width: f64) -> [f64; 3] {
    let m = read.uv.map(|row| row.map(f64::from));
    let at = m.map(|[a, b, c]| a * uv[0] + b * uv[1] + c);
    if read.filter == TexelFilter::Nearest {
        return level_at(texture, read, 0, at);
    }
    let determinant = m[0][0] * m[1][1] - m[0][1] * m[1][0];
    let [w, h] = texture.levels[0].size.map(f64::from);
    let texels = width * (determinant.abs() * w * h).sqrt();
    let last = texture.levels.len() - 1;
    let lambda = texels.log2().clamp(0.0, last as f64);
    let below = lambda.floor();
    let fine = level_at(texture, read, below as usize, at);
    let coarse = level_at(texture, read, (below as usize + 1).min(last), at);
    [0, 1, 2].map(|c| fine[c] + (lambda - below) * (coarse[c] - fine[c]))
}

const FORMATS: [TexelFormat; 4] = [
    TexelFormat::Rgba8,
    TexelFormat::Grey8,
    TexelFormat::Rgb32,
    TexelFormat::Grey32,
];
const CHANNELS: [Channel; 5] = [
    Channel::Colour,
    Channel::Red,
    Channel::Green,
    Channel::Blue,
    Channel::Alpha,
];
const WRAPS: [Wrap; 3] = [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp];

fn sample(texture: Texture, read: TextureUse, uv: [f32; 2], width: f32) -> [f32; 3] {
    let textures = Textures {
        textures: &[texture],
        uses: &[read],
    };
    let value = textures.sample(Ux::splat(0), uv.map(Fx::splat), Fx::splat(width));
    value.lane(LANES - 1)
}

fn number(texture: Texture, read: TextureUse, uv: [f32; 2]) -> f32 {
    let textures = Textures {
        textures: &[texture],
        uses: &[read],
    };
    textures.number(0, uv)
}

#[test]
fn bytes_are_decoded_to_the_nearest_float() {
    for byte in 0..256 {
        let share = byte as f64 / 255.0;
        assert_eq!(DECODE[0][byte], share as f32);
        // Both curves are computed in f64: they may round apart where the true value lies between.
        let error = (f64::from(DECODE[1][byte]) - srgb(share)).abs();
        assert!(error <= ROUNDING * srgb(share) * (1.0 + 1e-6), "{byte}");
    }
}

proptest! {
    #[test]
    fn any_look_up_is_that_of_the_formulas(
        (format, channel, wrap) in (0usize..4, 0usize..5, (0usize..3, 0usize..3)),
        (srgb, nearest) in any::<(bool, bool)>(),
        uv in [-3.0f32..3.0, -3.0f32..3.0],
        m in prop::array::uniform2(prop::array::uniform3(-2.0f32..2.0)),
        width in 0.0f32..2.0,
    ) {
        let format = FORMATS[format];
        let (words, levels) = image(format);
        let texture = Texture { words: &words, format, srgb, levels: &levels };
        let read = TextureUse {
            texture: 0,
            channel: CHANNELS[channel],
            uv: m,
            wrap: [WRAPS[wrap.0], WRAPS[wrap.1]],
            filter: if nearest { TexelFilter::Nearest } else { TexelFilter::Linear },
        };
        let at = uv.map(f64::from);
        // (u, v) are sums of three terms of at most 6, each rounded once, twice more in the image,
        // so that a place is off by 20 roundings of 6 texels of 8 at most; lambda by the logarithm's
        // (4 roundings of values up to 6) and its argument's (8 roundings). Texels differ by 43 at
        // most.
        let place = 8.0 * 6.0 * 20.0 * ROUNDING;
        if nearest {
            let edge = |i: usize| {
                let x = m[i].map(f64::from);
                let x = x[0] * at[0] + x[1] * at[1] + x[2];
                let x = x * f64::from(levels[0].size[i]);
                (x - x.round()).abs()
            };
            prop_assume!(edge(0) > place && edge(1) > place);
        }
        let bound = 43.0 * (4.0 * place + 64.0 * ROUNDING);
        let expected = twin(&texture, &read, at, f64::from(width));
        let found = sample(texture, read, uv, width);
        for c in 0..3 {
            let error = (f64::from(found[c]) - expected[c]).abs();
            prop_assert!(error <= bound, "{found:?} {expected:?}");
        }
        let [first, ..] = sample(texture, read, uv, 0.0);
        prop_assert_eq!(number(texture, read, uv).to_bits(), first.to_bits());
    }
}

#[test]
fn lanes_have_textures_of_their_own() {
    let images = FORMATS.map(image);
    let textures: Vec<Texture> = images
        .iter()
        .zip(FORMATS)
        .map(|((words, levels), format)| Texture {
            words,
            format,
            srgb: true,
            levels,
        })
        .collect();
    let uses: Vec<TextureUse> = (0..4)
        .map(|texture| TextureUse {
            texture,
            channel: Channel::Colour,
            uv: TextureUse::IDENTITY,
            wrap: [WRAPS[texture as usize % 3]; 2],
            filter: TexelFilter::Linear,
        })
        .collect();
    let which = [0, 3, NO_TEXTURE, 1, 2, 2, NO_TEXTURE, 0];
    let u: [f32; LANES] = std::array::from_fn(|lane| 0.37 * lane as f32 - 1.0);
    let width: [f32; LANES] = std::array::from_fn(|lane| 0.05 * lane as f32);
    let all = Textures {
        textures: &textures,
        uses: &uses,
    };
    let found = all.sample(Ux::new(which), [Fx::new(u), Fx::splat(0.3)], Fx::new(width));
    for lane in 0..LANES {
        let alone = match which[lane] {
            NO_TEXTURE => [1.0; 3],
            i => {
                let read = TextureUse {
                    texture: 0,
                    ..uses[i as usize]
                };
                sample(textures[i as usize], read, [u[lane], 0.3], width[lane])
            }
        };
        assert_eq!(found.lane(lane), alone, "lane {lane}");
    }
}

/// The middle of a texel is that texel; whatever the coordinates, a texel is found.
#[test]
fn odd_coordinates_stay_within_the_image() {
    let (words, levels) = image(TexelFormat::Grey32);
    let texture = Texture {
        words: &words,
        format: TexelFormat::Grey32,
        srgb: false,
        levels: &levels,
    };
    for wrap in WRAPS {
        for filter in [TexelFilter::Linear, TexelFilter::Nearest] {
            let read = TextureUse {
                texture: 0,
                channel: Channel::Red,
                uv: TextureUse::IDENTITY,
                wrap: [wrap; 2],
                filter,
            };
            let middle = sample(texture, read, [5.5 / 8.0, 2.5 / 4.0], 0.0);
            assert_eq!(
                f64::from(middle[0]),
                texel(&texture, 0, 5, 2, Channel::Red)[0]
            );
            let odd = [
                0.0,
                -0.0,
                1.0,
                -1.0,
                2.0,
                -1e-10,
                1.0 - ROUNDING as f32,
                1e10,
                -1e30,
                f32::MAX,
                f32::MIN_POSITIVE,
                f32::INFINITY,
                f32::NEG_INFINITY,
                f32::NAN,
            ];
            for u in odd {
                for v in odd {
                    for width in [0.0, 1e-30, 1.0, 1e30, f32::INFINITY, f32::NAN] {
                        let [x, ..] = sample(texture, read, [u, v], width);
                        assert!((0.0..=43.0).contains(&x), "{u} {v} {width}: {x}");
                    }
                    let [x, ..] = sample(texture, read, [u, v], 0.0);
                    assert_eq!(number(texture, read, [u, v]), x, "{u} {v}");
                }
            }
        }
    }
}
