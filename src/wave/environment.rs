//! What directions are drawn from on an environment map: the luminance in each cell of it.

use super::tables::luminance;
use crate::scene::Environment;
use crate::scene::row_cosine;
use huygens_kernels::light::{self, UNITS};
use std::f64::consts::TAU;

/// The most cells across, and half as many down: finer ones would leave the cache and gain little,
/// since a cell of that size spans 0.18 degrees.
const MOST: usize = 2048;

/// Tables of `huygens_kernels::light::Environment`.
#[derive(Debug)]
pub(crate) struct EnvironmentTables {
    columns: usize,
    rows: usize,
    marginal: Vec<u32>,
    conditional: Vec<u32>,
    cosines: Vec<f32>,
    density: Vec<f32>,
}

impl EnvironmentTables {
    /// The tables of a map that is not black. A cell's weight is the integral of the luminance over
    /// it, to the accuracy of a texel's height: whatever it is, cells that shine at all have one.
    pub(crate) fn new(map: &Environment) -> Self {
        let (width, height) = (map.width as usize, map.height as usize);
        let (columns, rows) = (width.min(MOST), height.min(MOST / 2));
        let (across, down) = (overlaps(width, columns), overlaps(height, rows));
        let mut weight = vec![0.0f64; columns * rows];
        let mut line = vec![0.0f64; width];
        let mut coarse = vec![0.0f64; columns];
        for y in 0..height {
            // Bilinear interpolation spreads a texel's light over its neighbours: an eighth of a
            // row's integral over its own height belongs to each of the rows beside it.
            let row = |y: usize| &map.texels[y * width..][..width];
            let [above, below] = [y.saturating_sub(1), (y + 1).min(height - 1)];
            for (x, l) in line.iter_mut().enumerate() {
                let at = |y| luminance(row(y)[x]);
                *l = 0.75 * at(y) + 0.125 * (at(above) + at(below));
            }
            coarse.fill(0.0);
            for x in 0..width {
                let [left, right] = [(x + width - 1) % width, (x + 1) % width];
                let l = 0.75 * line[x] + 0.125 * (line[left] + line[right]);
                across[x].add(&mut coarse, l);
            }
            let height_of = row_cosine(y, height) - row_cosine(y + 1, height);
            for (cell, share) in down[y].parts() {
                let cells = &mut weight[cell * columns..][..columns];
                for (cell, l) in cells.iter_mut().zip(&coarse) {
                    *cell += height_of * share * l;
                }
            }
        }
        Self::from_weights(columns, rows, &weight)
    }

    fn from_weights(columns: usize, rows: usize, weight: &[f64]) -> Self {
        let lines = || weight.chunks_exact(columns);
        let sums: Vec<f64> = lines().map(|line| line.iter().sum()).collect();
        let marginal = in_units(&sums);
        let mut conditional = Vec::with_capacity(rows * (columns + 1));
        let mut density = Vec::with_capacity(rows * columns);
        let share = |units: u32| f64::from(units) / f64::from(UNITS);
        for (row, line) in lines().enumerate() {
            let bounds = in_units(line);
            let of_row = share(marginal[row + 1] - marginal[row]);
            let height = row_cosine(row, rows) - row_cosine(row + 1, rows);
            let solid_angle = TAU / columns as f64 * height;
            density.extend(
                bounds
                    .windows(2)
                    .map(|b| (of_row * share(b[1] - b[0]) / solid_angle) as f32),
            );
            conditional.extend(bounds);
        }
        Self {
            columns,
            rows,
            marginal,
            conditional,
            cosines: (0..=rows).map(|r| row_cosine(r, rows) as f32).collect(),
            density,
        }
    }

    /// The view that kernels take.
    pub(crate) fn view<'a>(&'a self, map: &'a Environment) -> light::Environment<'a> {
        light::Environment {
            width: map.width,
            height: map.height,
            texels: &map.texels,
            frame: map.frame,
            columns: self.columns as u32,
            rows: self.rows as u32,
            marginal: &self.marginal,
            conditional: &self.conditional,
            cosines: &self.cosines,
            density: &self.density,
        }
    }
}

/// Cumulated probabilities in proportion to `weights` (>= 0), in whole [`UNITS`]: at least one unit
/// for each that is positive, none for the others, however far apart they are. At most 2^16 weights.
/// Where all are 0 the last one takes all, for a distribution that is never asked.
fn in_units(weights: &[f64]) -> Vec<u32> {
    let total: f64 = weights.iter().sum();
    let positive = weights.iter().filter(|&&w| w > 0.0).count() as u32;
    let free = f64::from(UNITS - positive);
    let units = |w: f64| 1 + (w / total * free) as u32;
    let mut shares: Vec<u32> = weights
        .iter()
        .map(|&w| if w > 0.0 { units(w) } else { 0 })
        .collect();
    // Rounding down has left less than a unit of each, which the largest hardly notices.
    let largest = (0..weights.len()).max_by(|&a, &b| weights[a].total_cmp(&weights[b]));
    let spent: u32 = shares.iter().sum();
    if let Some(largest) = largest {
        shares[largest] += UNITS - spent;
    }
    let mut sum = 0;
    let sums = shares.iter().map(|&s| {
        sum += s;
        sum
    });
    std::iter::once(0).chain(sums).collect()
}

/// The one or two cells that a texel overlaps, and how much of it lies in the first one.
#[derive(Clone, Copy, Debug)]
struct Overlap {
    first: usize,
    share: f64,
    cells: usize,
}

impl Overlap {
    /// Cells and shares, the second share perhaps 0.
    fn parts(self) -> [(usize, f64); 2] {
        let second = (self.first + 1).min(self.cells - 1);
        [(self.first, self.share), (second, 1.0 - self.share)]
    }

    fn add(self, cells: &mut [f64], value: f64) {
        for (cell, share) in self.parts() {
            cells[cell] += share * value;
        }
    }
}

/// Where each of `texels` lies among `cells <= texels` of the same extent together.
fn overlaps(texels: usize, cells: usize) -> Vec<Overlap> {
    let overlap = |texel: usize| {
        // In units of a cell's texel-th part, so that all is exact.
        let (start, end) = (texel * cells, (texel + 1) * cells);
        let first = start / texels;
        let edge = (first + 1) * texels;
        let within = end.min(edge) - start;
        Overlap {
            first,
            share: within as f64 / cells as f64,
            cells,
        }
    };
    (0..texels).map(overlap).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_cell_that_shines_can_be_drawn_and_no_other() {
        for weights in [
            vec![1.0, 0.0, 1e-300, 3.0, 1e300],
            vec![0.0, 0.0, 5.0],
            vec![1.0; 2048],
            (0..2048).map(|k| 1.5f64.powi(-k)).collect(),
        ] {
            let bounds = in_units(&weights);
            assert_eq!((bounds[0], bounds[weights.len()]), (0, UNITS));
            let total: f64 = weights.iter().sum();
            for (w, b) in weights.iter().zip(bounds.windows(2)) {
                let units = f64::from(b[1] - b[0]);
                assert_eq!(*w > 0.0, units > 0.0, "{w}");
                // A unit for each of the positive ones is set aside, and what rounding leaves goes
                // to the largest.
                let n = weights.len() as f64;
                assert!(
                    (units - w / total * f64::from(UNITS)).abs() <= n + 1.0,
                    "{w}"
                );
            }
        }
        assert_eq!(in_units(&[0.0, 0.0]), [0, 0, UNITS]);
    }

    #[test]
    fn texels_are_shared_out_whole() {
        for (texels, cells) in [(5, 5), (7, 3), (4096, 2048), (1, 1), (2049, 2048)] {
            let mut got = vec![0.0; cells];
            for overlap in overlaps(texels, cells) {
                assert!((0.0..=1.0).contains(&overlap.share));
                overlap.add(&mut got, 1.0);
            }
            for share in got {
                let expected = texels as f64 / cells as f64;
                // A few thousand roundings of numbers up to 1 each.
                assert!((share - expected).abs() < 1e-12 * expected);
            }
        }
    }

    #[test]
    fn wherever_the_map_shines_there_is_a_pdf() {
        // One bright texel in the dark: it shines as far as halfway to its neighbours' far edges.
        let (width, height) = (8, 6);
        let mut texels = vec![[0.0f32; 3]; width * height];
        texels[2 * width] = [0.0, 0.0, 7.0];
        let map = Environment {
            width: width as u32,
            height: height as u32,
            texels,
            frame: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        };
        let tables = EnvironmentTables::new(&map);
        for y in 0..height {
            for x in 0..width {
                let near = (1..=3).contains(&y) && [7, 0, 1].contains(&x);
                let pdf = tables.density[y * width + x];
                assert_eq!(pdf > 0.0, near, "({x}, {y})");
            }
        }
        // It integrates to 1.
        let solid = |y| TAU / width as f64 * (row_cosine(y, height) - row_cosine(y + 1, height));
        let sum: f64 = (0..width * height)
            .map(|k| f64::from(tables.density[k]) * solid(k / width))
            .sum();
        // Nine densities, rounded to f32 once each.
        assert!((sum - 1.0).abs() <= f64::from(f32::EPSILON));
    }
}
