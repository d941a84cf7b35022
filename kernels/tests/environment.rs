//! Environment maps: are directions drawn as their pdf says, and is the radiance that of the map?

mod common;

use common::{CORNERS, Source, Suite};
use huygens_kernels::lanes::{Fx, LANES};
use huygens_kernels::light::{Environment, UNITS};
use huygens_kernels::vec3::Vec3x;
use std::f64::consts::{PI, TAU};

/// Half a unit in the last place of 1: one rounding.
const ROUNDING: f64 = 1.0 / 16_777_216.0;

const WIDTH: usize = 10;
const HEIGHT: usize = 6;
const COLUMNS: usize = 8;
const ROWS: usize = 5;

/// A map of arbitrary texels, with arbitrary probabilities of its cells, some of them 0 and some as
/// small as can be.
struct Map {
    texels: Vec<[f32; 3]>,
    frame: [[f32; 3]; 3],
    marginal: Vec<u32>,
    conditional: Vec<u32>,
    cosines: Vec<f32>,
    density: Vec<f32>,
    /// Probability of each cell.
    probability: Vec<f64>,
}

/// Cumulated shares of [`UNITS`] for weights; the last one takes the rest.
fn cumulated(weights: &[u32]) -> Vec<u32> {
    let sum: u64 = weights.iter().map(|&w| u64::from(w)).sum();
    let share = |part: u64| (part * u64::from(UNITS) / sum) as u32;
    let mut part = 0;
    std::iter::once(0)
        .chain(weights.iter().map(|&w| {
            part += u64::from(w);
            share(part)
        }))
        .collect()
}

impl Map {
    fn new() -> Self {
        let mut source = Source(21);
        let texel = |_| std::array::from_fn(|_| source.unit() * 9.0);
        let texels = (0..WIDTH * HEIGHT).map(texel).collect();
        // Of row 2, all but one unit go to one cell; row 3 is never drawn.
        let marginal = cumulated(&[5, 9, 30, 0, 2]);
        let mut conditional = Vec::new();
        for row in 0..ROWS {
            conditional.extend(match row {
                2 => {
                    let mut steps: Vec<u32> = (0..COLUMNS as u32).collect();
                    steps.push(UNITS);
                    steps
                }
                _ => cumulated(&[3, 0, 1, 7, 2, 2, 0, 9]),
            });
        }
        let edge = |row: usize| (PI * row as f64 / ROWS as f64).cos();
        let mut probability = Vec::new();
        let mut density = Vec::new();
        for row in 0..ROWS {
            let of_row = f64::from(marginal[row + 1] - marginal[row]) / f64::from(UNITS);
            for column in 0..COLUMNS {
                let at = row * (COLUMNS + 1) + column;
                let units = conditional[at + 1] - conditional[at];
                let p = of_row * f64::from(units) / f64::from(UNITS);
                probability.push(p);
                let solid_angle = TAU / COLUMNS as f64 * (edge(row) - edge(row + 1));
                density.push((p / solid_angle) as f32);
            }
        }
        // Any rotation: here one of 3-4-5 about an axis of the map, after a swap of axes.
        let frame = [[0.6, 0.0, 0.8], [0.8, 0.0, -0.6], [0.0, 1.0, 0.0]];
        Self {
            texels,
            frame,
            marginal,
            conditional,
            cosines: (0..=ROWS).map(|row| edge(row) as f32).collect(),
            density,
            probability,
        }
    }

    fn view(&self) -> Environment<'_> {
        Environment {
            width: WIDTH as u32,
            height: HEIGHT as u32,
            texels: &self.texels,
            frame: self.frame,
            columns: COLUMNS as u32,
            rows: ROWS as u32,
            marginal: &self.marginal,
            conditional: &self.conditional,
            cosines: &self.cosines,
            density: &self.density,
        }
    }

    /// Where a direction lies on the map, in f64.
    fn place(&self, direction: [f32; 3]) -> [f64; 2] {
        let d = direction.map(f64::from);
        let [x, y, z] = self
            .frame
            .map(|axis| (0..3).map(|c| f64::from(axis[c]) * d[c]).sum::<f64>());
        let u = 0.5 + x.atan2(-z) / TAU;
        [u, (x * x + z * z).sqrt().atan2(y) / PI]
    }

    fn cell(&self, [u, v]: [f64; 2]) -> usize {
        let at = |x: f64, n: usize| ((x * n as f64) as usize).min(n - 1);
        at(v, ROWS) * COLUMNS + at(u, COLUMNS)
    }

    fn radiance(&self, [u, v]: [f64; 2]) -> [f64; 3] {
        let (x, y) = (u * WIDTH as f64 - 0.5, v * HEIGHT as f64 - 0.5);
        let texel = |i: i64, j: i64| {
            let i = i.rem_euclid(WIDTH as i64) as usize;
            let j = j.clamp(0, HEIGHT as i64 - 1) as usize;
            self.texels[j * WIDTH + i].map(f64::from)
        };
        let (i, j) = (x.floor() as i64, y.floor() as i64);
        let (dx, dy) = (x - x.floor(), y - y.floor());
        std::array::from_fn(|c| {
            let row = |j| (1.0 - dx) * texel(i, j)[c] + dx * texel(i + 1, j)[c];
            (1.0 - dy) * row(j) + dy * row(j + 1)
        })
    }
}

/// What a place may be off by: an arc tangent's few roundings, in turns, and the direction's own.
const PLACE: f64 = 16.0 * ROUNDING;

#[test]
fn directions_are_drawn_by_their_pdf_and_uniformly_within_cells() {
    const DRAWS: usize = 1 << 20;
    const PARTS: usize = 4;
    const RARE: f64 = 1e-5;
    let map = Map::new();
    let view = map.view();
    let mut source = Source(23);
    let mut cells = vec![0u64; ROWS * COLUMNS];
    let mut within = [[0u64; PARTS * PARTS]; 2];
    let mut inverse = [0.0; 2];
    for _ in 0..DRAWS / LANES {
        let [u, v, spare] = std::array::from_fn(|_| source.unit_lanes());
        let (direction, _, pdf) = view.sample(u, v, spare);
        for lane in 0..LANES {
            let at = map.place(direction.lane(lane));
            let cell = map.cell(at);
            cells[cell] += 1;
            let pdf = f64::from(pdf.as_array()[lane]);
            // Cells of a unit are drawn too rarely for a mean.
            if map.probability[cell] > RARE {
                inverse[0] += 1.0 / pdf;
                inverse[1] += 1.0 / (pdf * pdf);
            }
            // Uniform in longitude and in height over the two cells that are drawn most.
            let which = [2 * COLUMNS + COLUMNS - 1, COLUMNS + COLUMNS - 1];
            if let Some(k) = which.iter().position(|&w| w == cell) {
                let x = (at[0] * COLUMNS as f64).fract();
                let [top, bottom] =
                    [0, 1].map(|e| (PI * (cell / COLUMNS + e) as f64 / ROWS as f64).cos());
                let y = (top - (PI * at[1]).cos()) / (top - bottom);
                let part = |x: f64| ((x * PARTS as f64) as usize).min(PARTS - 1);
                within[k][part(y) * PARTS + part(x)] += 1;
            }
        }
    }
    let mut suite = Suite::default();
    let expected: Vec<f64> = map.probability.iter().map(|p| p * DRAWS as f64).collect();
    // A direction on an edge may round to the neighbour, to which the test's arithmetic gives it
    // back; cells of no probability must not be drawn but for that.
    let stray: u64 = cells
        .iter()
        .zip(&expected)
        .filter(|(_, e)| **e == 0.0)
        .map(|(c, _)| c)
        .sum();
    assert!(
        stray as f64 <= 64.0 * PLACE * DRAWS as f64,
        "{stray} strays"
    );
    let drawn = |e: &f64| *e > 0.0;
    let (counts, sizes): (Vec<u64>, Vec<f64>) = cells
        .iter()
        .zip(&expected)
        .filter(|(_, e)| drawn(e))
        .map(|(&c, &e)| (c, e))
        .unzip();
    suite.test("cells", &counts, &sizes);
    for (k, parts) in within.iter().enumerate() {
        suite.test_uniform(&format!("within cell {k}"), parts);
    }
    suite.finish();
    // The mean of 1 / pdf is the solid angle of the cells that it is taken over.
    let n = DRAWS as f64;
    let (mean, squares) = (inverse[0] / n, inverse[1] / n);
    let covered: f64 = (0..ROWS * COLUMNS)
        .filter(|&c| map.probability[c] > RARE)
        .map(|c| map.probability[c] / f64::from(map.density[c]))
        .sum();
    let error = ((squares - mean * mean) / n).sqrt();
    // One test at 1e-4: 3.9 standard errors.
    assert!((mean - covered).abs() < 3.9 * error, "{mean} for {covered}");
}

#[test]
fn a_single_unit_of_probability_is_drawn_at_every_place_of_its_cell() {
    let map = Map::new();
    let view = map.view();
    // The one number that falls into row 2's second cell; only `spare` moves it about the cell.
    let row = (f64::from(map.marginal[2] + 1) / f64::from(UNITS)) as f32;
    let mut source = Source(25);
    let mut parts = [0u64; 8];
    for _ in 0..1 << 13 {
        let spare = source.unit_lanes();
        let (direction, ..) = view.sample(Fx::splat(1.0 / UNITS as f32), Fx::splat(row), spare);
        for lane in 0..LANES {
            let at = map.place(direction.lane(lane));
            // What rounds over the cell's edge is its first or last part's.
            let part = at[0] * (8 * COLUMNS) as f64 - 8.0;
            parts[part.clamp(0.0, 7.0) as usize] += 1;
        }
    }
    let mut suite = Suite::default();
    suite.test_uniform("longitudes", &parts);
    suite.finish();
}

#[test]
fn what_is_found_is_what_was_drawn_and_what_the_map_says() {
    let map = Map::new();
    let view = map.view();
    let mut source = Source(27);
    // A place is off by PLACE, texels are up to 9 high, their slope at most that for a texel.
    let tolerance = 9.0 * (2.0 * PLACE * WIDTH as f64 + 8.0 * ROUNDING);
    let check = |radiance: [f32; 3], at: [f64; 2]| {
        for (found, twin) in radiance.into_iter().zip(map.radiance(at)) {
            assert!(
                (f64::from(found) - twin).abs() <= tolerance,
                "{found} for {twin} at {at:?}"
            );
        }
    };
    for _ in 0..1 << 13 {
        let [u, v, spare] = std::array::from_fn(|_| source.unit_lanes());
        let (direction, radiance, pdf) = view.sample(u, v, spare);
        let (found, found_pdf) = view.look_up(direction);
        for lane in 0..LANES {
            let at = map.place(direction.lane(lane));
            check(radiance.lane(lane), at);
            check(found.lane(lane), at);
            // On an edge between cells, either may be meant.
            let off = |x: f64, n: usize| {
                let x = x * n as f64;
                (x - x.round()).abs() < 2.0 * PLACE * n as f64
            };
            let edge = off(at[0], COLUMNS) || off(at[1], ROWS);
            let same = pdf.as_array()[lane] == found_pdf.as_array()[lane];
            assert!(same || edge, "{at:?}");
        }
        let any = Vec3x::splat(source.direction());
        let (found, _) = view.look_up(any);
        check(found.lane(0), map.place(any.lane(0)));
    }
}

#[test]
fn the_ends_of_the_unit_interval_and_the_poles_are_ordinary_input() {
    let map = Map::new();
    let view = map.view();
    for v in CORNERS {
        for spare in CORNERS {
            let (d, radiance, pdf) = view.sample(Fx::new(CORNERS), Fx::splat(v), Fx::splat(spare));
            assert!((d.is_finite() & radiance.is_finite() & pdf.is_finite()).all());
            assert!(
                pdf.simd_gt(Fx::ZERO).all(),
                "only cells of some probability"
            );
        }
    }
    let axes = [
        [1.0, 0.0],
        [-1.0, 0.0],
        [0.0, 1.0],
        [0.0, -1.0],
        [-0.0, -1.0],
    ];
    for [a, b] in axes {
        for direction in [[a, b, 0.0], [0.0, a, b], [b, 0.0, a]] {
            let (radiance, pdf) = view.look_up(Vec3x::splat(direction));
            assert!(
                (radiance.is_finite() & pdf.is_finite()).all(),
                "{direction:?}"
            );
        }
    }
}

#[test]
fn a_map_of_one_texel_is_constant() {
    let environment = Environment {
        width: 1,
        height: 1,
        texels: &[[1.0, 2.0, 3.0]],
        columns: 1,
        rows: 1,
        marginal: &[0, UNITS],
        conditional: &[0, UNITS],
        cosines: &[1.0, -1.0],
        density: &[(0.25 / PI) as f32],
        frame: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    };
    let mut source = Source(29);
    for _ in 0..256 {
        let [u, v, spare] = std::array::from_fn(|_| source.unit_lanes());
        let (direction, radiance, pdf) = environment.sample(u, v, spare);
        let (found, found_pdf) = environment.look_up(direction);
        assert_eq!(radiance.lane(3), [1.0, 2.0, 3.0]);
        assert_eq!(found.lane(3), [1.0, 2.0, 3.0]);
        assert_eq!(pdf.to_array(), found_pdf.to_array());
    }
}
