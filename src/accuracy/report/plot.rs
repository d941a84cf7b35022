//! A plot with logarithmic axes, as SVG.

use super::escape;
use std::fmt::Write;

/// A plot with logarithmic axes. Points without a logarithm are left out.
#[derive(Clone, Debug, PartialEq)]
pub struct Plot {
    /// A short word for file names and links.
    pub name: String,
    /// Above it.
    pub title: String,
    /// Along the axes: to the right, upwards.
    pub axes: [String; 2],
    /// What is drawn.
    pub lines: Vec<Line>,
    /// Slopes of dashed lines through the leftmost highest point, for comparison.
    pub guides: Vec<f64>,
}

/// A line through marks.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// In the legend.
    pub name: String,
    /// Which lines are shown and hidden together.
    pub group: String,
    /// In order.
    pub marks: Vec<Mark>,
}

/// A point of a line.
#[derive(Clone, Debug, PartialEq)]
pub struct Mark {
    /// To the right, upwards.
    pub at: [f64; 2],
    /// What the pointer shows there.
    pub tip: String,
}

const WIDTH: f64 = 960.0;
const PLOT: [f64; 2] = [660.0, 420.0];
const LEFT: f64 = 74.0;
const TOP: f64 = 36.0;
/// Between two lines of the legend.
const LEGEND: f64 = 17.0;

/// One axis: from values to a place on it.
struct Axis {
    low: f64,
    high: f64,
}

impl Axis {
    fn over(values: impl Iterator<Item = f64>) -> Self {
        let logs = values.map(f64::log10);
        let (low, high) = logs.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
            (low.min(v), high.max(v))
        });
        // A margin of a twentieth, and something to see of a single value.
        let margin = (0.05 * (high - low)).max(0.05);
        Self {
            low: low - margin,
            high: high + margin,
        }
    }

    /// From 0 to 1 along the axis.
    fn place(&self, value: f64) -> f64 {
        (value.log10() - self.low) / (self.high - self.low)
    }

    /// Values to mark: powers of ten, with 2 and 5 times those where there are few.
    fn ticks(&self) -> Vec<f64> {
        let steps: &[f64] = if self.high - self.low > 3.0 {
            &[1.0]
        } else {
            &[1.0, 2.0, 5.0]
        };
        let decades = self.low.floor() as i32..=self.high.ceil() as i32;
        decades
            .flat_map(|d| steps.iter().map(move |s| s * 10f64.powi(d)))
            .filter(|v| (0.0..=1.0).contains(&self.place(*v)))
            .collect()
    }
}

impl Plot {
    /// The plot as an SVG element, which is also a file of its own.
    #[must_use]
    pub fn svg(&self) -> String {
        let drawable = |m: &&Mark| m.at.iter().all(|v| *v > 0.0 && v.is_finite());
        let marks = || self.lines.iter().flat_map(|l| &l.marks).filter(drawable);
        let legend = TOP + LEGEND * (self.lines.len() + self.guides.len() + 1) as f64;
        let height = (TOP + PLOT[1] + 56.0).max(legend);
        let mut svg = format!(
            "<svg class=\"plot\" xmlns=\"http://www.w3.org/2000/svg\" \
             viewBox=\"0 0 {WIDTH} {height}\" role=\"img\" aria-label=\"{0}\" \
             font-family=\"system-ui, sans-serif\" font-size=\"12\">\n\
             <rect width=\"{WIDTH}\" height=\"{height}\" fill=\"#fff\"/>\n\
             <text x=\"{LEFT}\" y=\"20\" font-size=\"15\" font-weight=\"600\">{0}</text>\n",
            escape(&self.title)
        );
        if marks().next().is_none() {
            svg += "<text x=\"74\" y=\"60\">nothing to draw yet</text>\n</svg>\n";
            return svg;
        }
        let x = Axis::over(marks().map(|m| m.at[0]));
        let y = Axis::over(marks().map(|m| m.at[1]));
        let place = |at: [f64; 2]| {
            [
                LEFT + x.place(at[0]) * PLOT[0],
                TOP + (1.0 - y.place(at[1])) * PLOT[1],
            ]
        };
        self.frame(&mut svg, &x, &y);
        let corner = [
            marks().map(|m| m.at[0]).fold(f64::INFINITY, f64::min),
            marks().map(|m| m.at[1]).fold(0.0, f64::max),
        ];
        for (index, slope) in self.guides.iter().enumerate() {
            let far = 10f64.powf(x.high);
            let end = place([far, corner[1] * (far / corner[0]).powf(*slope)]);
            let start = place(corner);
            // Cut where it leaves the plot.
            let cut = ((TOP + PLOT[1] - start[1]) / (end[1] - start[1])).clamp(0.0, 1.0);
            let end = [0, 1].map(|i| start[i] + cut * (end[i] - start[i]));
            let row = TOP + LEGEND * (self.lines.len() + index) as f64 + 8.0;
            let _ = writeln!(
                svg,
                "<g stroke=\"#777\" stroke-dasharray=\"5 4\"><line x1=\"{:.1}\" y1=\"{:.1}\" \
                 x2=\"{:.1}\" y2=\"{:.1}\"/><line x1=\"756\" y1=\"{row}\" x2=\"776\" \
                 y2=\"{row}\"/></g><text x=\"782\" y=\"{}\">slope {slope}</text>",
                start[0],
                start[1],
                end[0],
                end[1],
                row + 4.0
            );
        }
        for (index, line) in self.lines.iter().enumerate() {
            let marks: Vec<&Mark> = line.marks.iter().filter(drawable).collect();
            draw(&mut svg, index, line, &marks, place);
        }
        svg += "</svg>\n";
        svg
    }

    /// Axes, ticks and their names.
    fn frame(&self, svg: &mut String, x: &Axis, y: &Axis) {
        let (right, bottom) = (LEFT + PLOT[0], TOP + PLOT[1]);
        for tick in x.ticks() {
            let at = LEFT + x.place(tick) * PLOT[0];
            let _ = writeln!(
                svg,
                "<line x1=\"{at:.1}\" y1=\"{TOP}\" x2=\"{at:.1}\" y2=\"{bottom}\" \
                 stroke=\"#e4e4e4\"/><text x=\"{at:.1}\" y=\"{}\" text-anchor=\"middle\">{}</text>",
                bottom + 17.0,
                number(tick)
            );
        }
        for tick in y.ticks() {
            let at = TOP + (1.0 - y.place(tick)) * PLOT[1];
            let _ = writeln!(
                svg,
                "<line x1=\"{LEFT}\" y1=\"{at:.1}\" x2=\"{right}\" y2=\"{at:.1}\" \
                 stroke=\"#e4e4e4\"/><text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
                LEFT - 7.0,
                at + 4.0,
                number(tick)
            );
        }
        let middle = TOP + 0.5 * PLOT[1];
        let _ = writeln!(
            svg,
            "<rect x=\"{LEFT}\" y=\"{TOP}\" width=\"{}\" height=\"{}\" fill=\"none\" \
             stroke=\"#444\"/>\n<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n\
             <text x=\"16\" y=\"{middle}\" text-anchor=\"middle\" \
             transform=\"rotate(-90 16 {middle})\">{}</text>",
            PLOT[0],
            PLOT[1],
            LEFT + 0.5 * PLOT[0],
            bottom + 40.0,
            escape(&self.axes[0]),
            escape(&self.axes[1])
        );
    }
}

/// One line with its marks and its place in the legend.
fn draw(
    svg: &mut String,
    index: usize,
    line: &Line,
    marks: &[&Mark],
    place: impl Fn([f64; 2]) -> [f64; 2],
) {
    // Hues apart by the golden angle: neighbours in the legend differ, however many there are.
    let hue = (index as f64 * 137.508) % 360.0;
    let colour = format!("hsl({hue:.0} 70% 38%)");
    let dash = ["", " stroke-dasharray=\"7 3\"", " stroke-dasharray=\"2 3\""][index / 8 % 3];
    let path: Vec<String> = marks
        .iter()
        .map(|m| place(m.at))
        .map(|[x, y]| format!("{x:.1},{y:.1}"))
        .collect();
    let row = TOP + LEGEND * index as f64 + 8.0;
    let _ = write!(
        svg,
        "<g class=\"line\" data-name=\"{0}\" data-group=\"{1}\" fill=\"{colour}\" \
         stroke=\"{colour}\"><g class=\"drawn\"><polyline fill=\"none\" stroke-width=\"1.8\"{dash} \
         points=\"{2}\"/>",
        escape(&line.name),
        escape(&line.group),
        path.join(" ")
    );
    for mark in marks {
        let [x, y] = place(mark.at);
        let tip = escape(&mark.tip);
        let _ = write!(
            svg,
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3.4\" tabindex=\"0\" data-tip=\"{tip}\">\
             <title>{tip}</title></circle>"
        );
    }
    let _ = writeln!(
        svg,
        "</g><g class=\"key\" tabindex=\"0\"><line x1=\"756\" y1=\"{row}\" x2=\"776\" y2=\"{row}\" \
         stroke-width=\"1.8\"{dash}/><circle cx=\"766\" cy=\"{row}\" r=\"3.4\"/><text x=\"782\" \
         y=\"{}\" stroke=\"none\" fill=\"#222\">{}</text></g></g>",
        row + 4.0,
        escape(&line.name)
    );
}

/// A tick's number: plain where that is short.
fn number(value: f64) -> String {
    let exponent = value.log10().floor() as i32;
    if (-3..=4).contains(&exponent) {
        let decimals = usize::try_from(-exponent).unwrap_or(0);
        format!("{value:.decimals$}")
    } else {
        format!("{value:.0e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plot(marks: &[[f64; 2]]) -> Plot {
        let mark = |&at: &[f64; 2]| Mark {
            at,
            tip: format!("{at:?}"),
        };
        Plot {
            name: "p".into(),
            title: "a < b".into(),
            axes: ["x".into(), "y".into()],
            lines: vec![Line {
                name: "one".into(),
                group: "g".into(),
                marks: marks.iter().map(mark).collect(),
            }],
            guides: vec![-0.5],
        }
    }

    #[test]
    fn marks_lie_where_their_logarithms_say() {
        let svg = plot(&[[1.0, 1.0], [10.0, 0.1], [100.0, 0.01]]).svg();
        let centres: Vec<Vec<f64>> = svg
            .split("<circle cx=\"")
            .skip(1)
            .filter(|c| c.contains("data-tip"))
            .map(|c| {
                let parts: Vec<&str> = c.split('"').collect();
                vec![parts[0].parse().expect("x"), parts[2].parse().expect("y")]
            })
            .collect();
        assert_eq!(centres.len(), 3);
        // Equal steps to the right and downwards, to the tenth that is written.
        for axis in 0..2 {
            let steps = [1, 2].map(|i| centres[i][axis] - centres[i - 1][axis]);
            assert!(
                steps[0] > 0.0 && (steps[0] - steps[1]).abs() < 0.21,
                "{steps:?}"
            );
        }
        assert!(svg.contains("a &lt; b") && !svg.contains("a < b"));
        assert!(svg.contains("slope -0.5"));
    }

    #[test]
    fn what_has_no_logarithm_is_left_out() {
        let svg = plot(&[[1.0, 0.0], [f64::NAN, 1.0], [2.0, 3.0]]).svg();
        assert_eq!(svg.matches("data-tip").count(), 1);
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
        let nothing = plot(&[[0.0, 1.0]]).svg();
        assert!(nothing.contains("nothing to draw") && nothing.ends_with("</svg>\n"));
    }

    #[test]
    fn ticks_are_short() {
        let numbers = [1e-6, 0.002, 0.5, 1.0, 50.0, 20_000.0, 1e6].map(number);
        assert_eq!(numbers, ["1e-6", "0.002", "0.5", "1", "50", "20000", "1e6"]);
    }
}
