//! The roofline of S. Williams, A. Waterman, D. Patterson, "Roofline: An Insightful Visual
//! Performance Model for Multicore Architectures" (CACM 52(4), 2009): operations a second over
//! operations a byte, both logarithmic, under the roofs that bandwidth and arithmetic set.
//!
//! Bytes are those of queues and tables, as the kernels declare them, so a kernel far below its roof is
//! bound by something else: latency, mispredicted branches, integer work, or its tree.

use super::Row;
use super::limits::Limits;
use std::fmt::Write;

/// A kernel's place.
#[derive(Clone, Copy, Debug)]
struct Point<'a> {
    name: &'a str,
    /// Operations a byte.
    intensity: f64,
    /// 10^9 operations a second.
    rate: f64,
}

/// The kernels whose operations are known and that did something.
fn points(rows: &[Row]) -> Vec<Point<'_>> {
    let point = |row: &'_ Row| {
        let (operations, rate) = (row.operations?, row.gigaoperations_per_second?);
        (operations > 0.0 && row.bytes > 0.0 && rate > 0.0)
            .then_some((operations / row.bytes, rate))
    };
    let named = |row| point(row).map(|(intensity, rate)| (row, intensity, rate));
    let known = rows.iter().filter_map(named);
    known
        .map(|(row, intensity, rate)| Point {
            name: row.name,
            intensity,
            rate,
        })
        .collect()
}

/// Logarithmic axes: the decades that hold all points and the ridges.
struct Axes {
    x: [f64; 2],
    y: [f64; 2],
}

impl Axes {
    fn new(limits: &Limits, points: &[Point]) -> Self {
        let ridge = [limits.near, limits.far].map(|b| limits.gigaoperations / b);
        let xs = points.iter().map(|p| p.intensity).chain(ridge);
        let ys = points.iter().map(|p| p.rate).chain([limits.gigaoperations]);
        let span = |values: &mut dyn Iterator<Item = f64>| {
            let (lo, hi) = values.fold((f64::INFINITY, 0.0), |(lo, hi): (f64, f64), v| {
                (lo.min(v), hi.max(v))
            });
            [lo.log10().floor(), (hi * 1.5).log10().ceil()]
        };
        Self {
            x: span(&mut { xs }),
            y: span(&mut { ys }),
        }
    }

    /// Where a place lies, each from 0 to 1, from the lower left.
    fn place(&self, intensity: f64, rate: f64) -> [f64; 2] {
        let along = |v: f64, [lo, hi]: [f64; 2]| (v.log10() - lo) / (hi - lo);
        [along(intensity, self.x), along(rate, self.y)]
    }
}

/// The letter of a kernel in the terminal's chart.
#[must_use]
pub fn letter(index: usize) -> char {
    char::from(b'a' + (index % 26) as u8)
}

/// A chart for terminals, `width` by `height` characters, and the legend of its letters.
#[must_use]
pub fn text(limits: &Limits, rows: &[Row], width: usize, height: usize) -> String {
    let points = points(rows);
    let axes = Axes::new(limits, &points);
    let mut cells = vec![vec![' '; width]; height];
    let cell = |[x, y]: [f64; 2]| {
        let column = (x * (width - 1) as f64).round() as usize;
        let row = ((1.0 - y) * (height - 1) as f64).round();
        (row >= 0.0 && (row as usize) < height && column < width).then_some((row as usize, column))
    };
    for column in 0..width {
        let x = axes.x[0] + (axes.x[1] - axes.x[0]) * column as f64 / (width - 1) as f64;
        let intensity = 10f64.powf(x);
        for (bandwidth, mark) in [(limits.far, '.'), (limits.near, '-')] {
            let roof = limits.gigaoperations.min(bandwidth * intensity);
            if let Some((row, column)) = cell(axes.place(intensity, roof)) {
                cells[row][column] = mark;
            }
        }
    }
    for (i, point) in points.iter().enumerate() {
        if let Some((row, column)) = cell(axes.place(point.intensity, point.rate)) {
            cells[row][column] = letter(i);
        }
    }
    let mut out = format!(
        "Gop/s, 10^{} to 10^{}, over operations a byte, 10^{} to 10^{}\n",
        axes.y[0], axes.y[1], axes.x[0], axes.x[1]
    );
    for row in cells {
        let _ = writeln!(out, "  |{}", row.into_iter().collect::<String>().trim_end());
    }
    let _ = writeln!(out, "  +{}", "-".repeat(width));
    for (i, p) in points.iter().enumerate() {
        let _ = writeln!(
            out,
            "  {} {:<20} {:7.2} op/B {:8.2} Gop/s, {:3.0}% of its roof",
            letter(i),
            p.name,
            p.intensity,
            p.rate,
            100.0 * p.rate / limits.roof(p.intensity)
        );
    }
    out
}

/// The chart as an SVG document.
#[must_use]
pub fn svg(limits: &Limits, rows: &[Row], title: &str) -> String {
    let points = points(rows);
    let axes = Axes::new(limits, &points);
    let (width, height, left, top) = (760.0, 480.0, 70.0, 40.0);
    let at = |intensity: f64, rate: f64| {
        let [x, y] = axes.place(intensity, rate);
        (left + x * width, top + (1.0 - y) * height)
    };
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\" \
         font-family=\"sans-serif\" font-size=\"13\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n\
         <text x=\"{left}\" y=\"24\" font-size=\"16\">{}</text>\n",
        width + left + 30.0,
        height + top + 50.0,
        escape(title)
    );
    let decades = |[lo, hi]: [f64; 2]| (lo as i32..=hi as i32).map(|d| 10f64.powi(d));
    for x in decades(axes.x) {
        let (px, _) = at(x, 1.0);
        let _ = writeln!(
            out,
            "<line x1=\"{px:.1}\" y1=\"{top}\" x2=\"{px:.1}\" y2=\"{:.1}\" stroke=\"#ddd\"/>\
             <text x=\"{px:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{x}</text>",
            top + height,
            top + height + 18.0
        );
    }
    for y in decades(axes.y) {
        let (_, py) = at(1.0, y);
        let _ = writeln!(
            out,
            "<line x1=\"{left}\" y1=\"{py:.1}\" x2=\"{:.1}\" y2=\"{py:.1}\" stroke=\"#ddd\"/>\
             <text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{y}</text>",
            left + width,
            left - 6.0,
            py + 4.0
        );
    }
    let _ = writeln!(
        out,
        "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">operations a byte (f32; bytes of queues \
         and tables)</text>\n<text transform=\"translate(18 {:.1}) rotate(-90)\" \
         text-anchor=\"middle\">10^9 operations a second, one core</text>",
        left + width / 2.0,
        top + height + 38.0,
        top + height / 2.0
    );
    for (bandwidth, name, colour) in [
        (limits.far, "memory", "#c33"),
        (limits.near, "second-level cache", "#36c"),
    ] {
        let ridge = limits.gigaoperations / bandwidth;
        // From the lower or left edge, whichever the slope meets first.
        let start = 10f64.powf(axes.x[0]).max(10f64.powf(axes.y[0]) / bandwidth);
        let line = [start, ridge, 10f64.powf(axes.x[1])]
            .map(|x| at(x, limits.gigaoperations.min(bandwidth * x)));
        let path = line.map(|(x, y)| format!("{x:.1},{y:.1}")).join(" ");
        let (x, y) = line[0];
        let _ = writeln!(
            out,
            "<polyline points=\"{path}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"2\"/>\
             <text x=\"{:.1}\" y=\"{:.1}\" fill=\"{colour}\">{name}, {bandwidth:.0} GB/s</text>",
            x + 8.0,
            y - 8.0
        );
    }
    let (_, y) = at(1.0, limits.gigaoperations);
    let _ = writeln!(
        out,
        "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{:.0} Gop/s</text>",
        left + width - 4.0,
        y - 6.0,
        limits.gigaoperations
    );
    for p in &points {
        let (x, y) = at(p.intensity, p.rate);
        let _ = writeln!(
            out,
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"5\" fill=\"#222\"/>\
             <text x=\"{:.1}\" y=\"{:.1}\">{}</text>",
            x + 8.0,
            y + 4.0,
            escape(p.name)
        );
    }
    out.push_str("</svg>\n");
    out
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wave::StageStats;

    const LIMITS: Limits = Limits {
        gigaoperations: 80.0,
        near: 40.0,
        far: 10.0,
    };

    fn rows() -> Vec<Row> {
        let stage = |name, operations, bytes_read| StageStats {
            name,
            items_in: 1,
            seconds: 1e-9,
            operations,
            bytes_read,
            ..StageStats::default()
        };
        let stages = [
            stage("generate", 40, 10),
            stage("a < b", 4, 8),
            stage("intersect", 0, 8),
        ];
        stages
            .iter()
            .map(|s| Row::new(s, 1.0, [false; 8]))
            .collect()
    }

    #[test]
    fn the_chart_shows_what_is_known_against_its_roof() {
        let text = text(&LIMITS, &rows(), 60, 12);
        assert!(
            text.contains("a generate                4.00 op/B    40.00 Gop/s,  50% of its roof")
        );
        assert!(
            text.contains("b a < b                   0.50 op/B     4.00 Gop/s,  20% of its roof")
        );
        assert!(!text.contains("intersect"), "its operations are unknown");
        assert_eq!(text.lines().filter(|l| l.starts_with("  |")).count(), 12);
    }

    #[test]
    fn the_svg_is_well_formed_as_far_as_tags_go() {
        let svg = svg(&LIMITS, &rows(), "x & y");
        assert!(svg.contains("x &amp; y") && svg.contains("a &lt; b"));
        assert_eq!(svg.matches("<circle").count(), 2);
        assert_eq!(svg.matches("<text").count(), svg.matches("</text>").count());
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
    }
}
