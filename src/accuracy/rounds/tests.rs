//! The estimate and the allocation by hand.

use super::*;

/// A block of one pixel after `samples` samples in rounds of 4, of which one has variance `v`.
fn block(v: f64, samples: u32) -> Block {
    let tile = Tile {
        x: 0,
        y: 0,
        width: 1,
        height: 1,
    };
    let mean = Mean {
        value: 1.0,
        squares: v * f64::from(samples / 4 - 1),
    };
    Block {
        tile,
        pixels: vec![[mean; 3]],
        rounds: samples / 4,
        samples,
    }
}

#[test]
fn the_noisiest_go_on_first() {
    let blocks = [block(1.0, 32), block(4.0, 32), block(0.0, 32)];
    // As it is: sqrt((1/32 / (1.01 - 1/32) + 4/32 / (1.01 - 4/32)) / 3) = 0.24.
    let relative = |v: f64| v / 32.0 / (1.01 - v / 32.0);
    let expected = ((relative(1.0) + relative(4.0)) / 3.0).sqrt();
    assert!((error(&blocks) - expected).abs() < 1e-12);
    assert_eq!(wanted(&blocks, 0.3), [false; 3]);
    assert_eq!(wanted(&blocks, 0.2), [false, true, false]);
    assert_eq!(wanted(&blocks, 0.01), [true, true, false]);
    // In proportion: twice the deviation has twice the samples already.
    assert_eq!(
        wanted(&[block(1.0, 32), block(4.0, 64)], 0.05),
        [true, true]
    );
    assert_eq!(
        wanted(&[block(1.0, 320), block(4.0, 64)], 0.15),
        [false, true]
    );
}

#[test]
fn rounds_of_different_sizes_are_weighed() {
    let tile = block(0.0, 4).tile;
    let mut block = Block::new(tile);
    block.add(&[[1.0; 3]], 4);
    block.add(&[[4.0; 3]], 8);
    let mean = block.pixels[0][0];
    assert_eq!((mean.value, block.samples), (3.0, 12));
    // 4 (1 - 3)^2 + 8 (4 - 3)^2, over 2 - 1.
    assert!((block.of_sample(&mean) - 24.0).abs() < 1e-12);
}
