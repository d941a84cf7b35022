//! Writes the lamps of scenes/many-lights.toml, an OBJ of a thousand little triangles:
//!
//! ```text
//! cargo run --release --example make_lights -- scenes/many-lights/lamps.obj
//! ```
//!
//! They hang anywhere in a hall of 40 x 40, more of them low than high, each facing where it happens
//! to, in five colours. The same file every time.

use std::fmt::Write;

const LAMPS: usize = 1000;
const COLOURS: usize = 5;

/// SplitMix64 (Steele, Lea, Flood, OOPSLA 2014): numbers in [0, 1).
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }
}

fn main() -> std::io::Result<()> {
    let Some(path) = std::env::args().nth(1) else {
        eprintln!("usage: make_lights FILE.obj");
        std::process::exit(2);
    };
    let mut numbers = Numbers(1);
    let mut text =
        String::from("# A thousand lamps, by examples/make_lights.rs.\nmtllib lamps.mtl\n");
    for lamp in 0..LAMPS {
        if lamp % (LAMPS / COLOURS) == 0 {
            writeln!(text, "usemtl lamp-{}", lamp / (LAMPS / COLOURS) + 1).expect("memory");
        }
        let middle = [
            40.0 * numbers.next() - 20.0,
            0.3 + 4.0 * numbers.next() * numbers.next(),
            40.0 * numbers.next() - 20.0,
        ];
        for _ in 0..3 {
            let [x, y, z] = middle.map(|m| m + 0.12 * (numbers.next() - 0.5));
            writeln!(text, "v {x:.3} {y:.3} {z:.3}").expect("memory");
        }
        text += "f -3 -2 -1\n";
    }
    std::fs::write(path, text)
}
