//! One number at a time: what a traversal asks for between two triangles.

use super::{TexelFilter, Textures, Wrap};

impl Textures<'_> {
    /// The number at `uv` of texture use `which`, of the whole image: bit for bit what
    /// [`Textures::sample`] gives for a footprint of 0.
    ///
    /// # Panics
    /// If there is no such texture use.
    #[must_use]
    pub fn number(&self, which: u32, uv: [f32; 2]) -> f32 {
        let read = &self.uses[which as usize];
        let texture = &self.textures[read.texture as usize];
        let level = &texture.levels[0];
        let middle = match read.filter {
            TexelFilter::Linear => 0.5,
            TexelFilter::Nearest => 0.0,
        };
        let [across, up] = [0, 1].map(|axis| {
            let [a, b, c] = read.uv[axis];
            let x = a.mul_add(uv[0], b.mul_add(uv[1], c));
            let x = if x.is_finite() { x } else { 0.0 };
            Span::new(x, level.size[axis], read.wrap[axis], middle)
        });
        let texel = |row: usize, column: usize| {
            let index = up.texel[row] * level.size[0] + across.texel[column];
            texture.texel(level.first, index as usize, read.channel)[0]
        };
        if middle == 0.0 {
            return texel(0, 0);
        }
        let between = |a: f32, b: f32, share: f32| (b - a).mul_add(share, a);
        let low = between(texel(0, 0), texel(0, 1), across.fraction);
        let high = between(texel(1, 0), texel(1, 1), across.fraction);
        between(low, high, up.fraction)
    }
}

/// As `super::Span`, in one lane.
struct Span {
    texel: [u32; 2],
    fraction: f32,
}

impl Span {
    fn new(x: f32, size: u32, wrap: Wrap, middle: f32) -> Self {
        let inside = match wrap {
            Wrap::Repeat => x - x.floor(),
            Wrap::Mirror => {
                let half = x * 0.5;
                let turn = half - half.floor();
                1.0 - (turn + turn - 1.0).abs()
            }
            Wrap::Clamp => x.clamp(0.0, 1.0),
        };
        let size = size as f32;
        let place = inside * size - middle;
        let first = place.floor();
        let last = size - 1.0;
        let fold = |i: f32| {
            let (under, over) = match wrap {
                Wrap::Repeat => (last, 0.0),
                Wrap::Mirror | Wrap::Clamp => (0.0, last),
            };
            let i = if i < 0.0 { under } else { i };
            (if i > last { over } else { i }) as u32
        };
        Self {
            texel: [fold(first), fold(first + 1.0)],
            fraction: place - first,
        }
    }
}
