//! The page: facts, advice, plots, a table, pictures.

use super::{Plot, base64, escape};
use std::fmt::Write;

const STYLE: &str = include_str!("style.css");
const SCRIPT: &str = include_str!("script.js");

/// All that a report shows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Page {
    /// Its title.
    pub title: String,
    /// Sentences under it: what it comes to, the first before all.
    pub summary: Vec<String>,
    /// What was measured, on what, how.
    pub facts: Vec<Fact>,
    /// Plots.
    pub plots: Vec<Plot>,
    /// The numbers.
    pub table: Table,
    /// What stands above the pictures.
    pub pictures_title: String,
    /// Pictures as PNG files, the reference first; none, or two at least.
    pub pictures: Vec<Picture>,
}

/// A fact: its name, and what it is.
#[derive(Clone, Debug, PartialEq)]
pub struct Fact {
    /// Its name.
    pub name: String,
    /// What it is.
    pub value: String,
    /// Whether it is something to type.
    pub code: bool,
}

/// A table that the reader can sort.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// Names of the columns, with what they mean.
    pub columns: Vec<(String, String)>,
    /// Rows, as wide as the columns.
    pub rows: Vec<Vec<Cell>>,
}

/// A cell of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct Cell {
    /// What it shows.
    pub text: String,
    /// What it is sorted by, if it is a number; unknown numbers come last.
    pub number: Option<f64>,
    /// Whether its column is one of numbers.
    pub numeric: bool,
}

impl Cell {
    /// A cell of text.
    #[must_use]
    pub fn text(text: impl Into<String>) -> Self {
        Self {
            text: text.into(),
            number: None,
            numeric: false,
        }
    }

    /// A cell with a number, written as `text`.
    #[must_use]
    pub fn number(number: Option<f64>, text: impl Into<String>) -> Self {
        Self {
            text: text.into(),
            number: number.filter(|n| n.is_finite()),
            numeric: true,
        }
    }
}

/// A picture of a strip.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Its name.
    pub name: String,
    /// Under it.
    pub caption: String,
    /// A PNG file.
    pub png: Vec<u8>,
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
}

impl Page {
    /// The page as one HTML file that fetches nothing.
    #[must_use]
    pub fn html(&self) -> String {
        let mut html = format!(
            "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <title>{0}</title>\n<link rel=\"icon\" href=\"data:,\">\n<style>\n{STYLE}</style>\n\
             </head>\n<body>\n<main>\n<h1>{0}</h1>\n",
            escape(&self.title)
        );
        self.summary(&mut html);
        self.facts(&mut html);
        self.plots(&mut html);
        self.table(&mut html);
        self.pictures(&mut html);
        let _ = write!(
            html,
            "</main>\n<div id=\"tip\" role=\"status\" hidden></div>\n<script>\n{SCRIPT}</script>\n\
             </body>\n</html>\n"
        );
        html
    }

    fn summary(&self, html: &mut String) {
        let [first, rest @ ..] = &self.summary[..] else {
            return;
        };
        let _ = writeln!(html, "<p class=\"advice\">{}</p>", escape(first));
        if rest.is_empty() {
            return;
        }
        *html += "<ul class=\"advice\">\n";
        for sentence in rest {
            let _ = writeln!(html, "<li>{}</li>", escape(sentence));
        }
        *html += "</ul>\n";
    }

    fn facts(&self, html: &mut String) {
        *html += "<dl>\n";
        for Fact { name, value, code } in &self.facts {
            let value = escape(value);
            let value = if *code {
                format!("<code>{value}</code>")
            } else {
                value
            };
            let _ = writeln!(html, "<dt>{}</dt><dd>{value}</dd>", escape(name));
        }
        *html += "</dl>\n";
    }

    fn plots(&self, html: &mut String) {
        let lines = self.plots.iter().flat_map(|p| &p.lines);
        let mut groups: Vec<&str> = lines.map(|l| l.group.as_str()).collect();
        groups.dedup();
        let mut seen = Vec::new();
        groups.retain(|g| {
            let new = !seen.contains(g);
            seen.push(g);
            new
        });
        if groups.len() > 1 {
            *html += "<p class=\"groups\" role=\"group\" aria-label=\"Show\">Show \
                      <button data-show=\"\" aria-pressed=\"true\">all</button>";
            for group in groups {
                let group = escape(group);
                let _ = write!(
                    html,
                    " <button data-show=\"{group}\" aria-pressed=\"false\">{group}</button>"
                );
            }
            *html += " <small>or a name in a legend, to hide it</small></p>\n";
        }
        for plot in &self.plots {
            let _ = writeln!(
                html,
                "<figure id=\"{}\">\n{}</figure>",
                escape(&plot.name),
                plot.svg()
            );
        }
    }

    fn table(&self, html: &mut String) {
        if self.table.rows.is_empty() {
            return;
        }
        *html += "<div class=\"wide\"><table>\n<thead><tr>";
        for (name, meaning) in &self.table.columns {
            let _ = write!(
                html,
                "<th scope=\"col\" title=\"{}\"><button>{}</button></th>",
                escape(meaning),
                escape(name)
            );
        }
        *html += "</tr></thead>\n<tbody>\n";
        for row in &self.table.rows {
            *html += "<tr>";
            for cell in row {
                let number = match (cell.numeric, cell.number) {
                    (false, _) => String::new(),
                    (true, None) => " class=\"number\" data-number=\"\"".into(),
                    (true, Some(n)) => format!(" class=\"number\" data-number=\"{n}\""),
                };
                let _ = write!(html, "<td{number}>{}</td>", escape(&cell.text));
            }
            *html += "</tr>\n";
        }
        *html += "</tbody></table></div>\n";
    }

    fn pictures(&self, html: &mut String) {
        let [reference, rest @ ..] = &self.pictures[..] else {
            return;
        };
        let source = |p: &Picture| format!("data:image/png;base64,{}", base64(&p.png));
        let _ = write!(
            html,
            "<h2>{}</h2>\n<p>Left of the slider the choice, right of it the reference.</p>\n\
             <div class=\"strips\" style=\"--reference: url({})\">\n",
            escape(&self.pictures_title),
            source(reference)
        );
        for picture in rest {
            let name = escape(&picture.name);
            let (width, height) = (picture.width, picture.height);
            let _ = writeln!(
                html,
                "<figure class=\"strip\"><div class=\"pair\" \
                 style=\"aspect-ratio: {width} / {height}\"><img alt=\"{name}\" src=\"{}\" \
                 width=\"{width}\" height=\"{height}\"><div class=\"truth\"></div></div>\
                 <input type=\"range\" min=\"0\" max=\"100\" value=\"50\" \
                 aria-label=\"{name} against the reference\">\
                 <figcaption><b>{name}</b><br>{}</figcaption></figure>",
                source(picture),
                escape(&picture.caption)
            );
        }
        *html += "</div>\n";
    }
}
