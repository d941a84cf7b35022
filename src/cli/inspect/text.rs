//! What a scene holds, for people.

use super::contents::Contents;
use crate::cli::summary::plural;
use crate::cli::text::bytes;
use std::fmt::Write;

impl Contents {
    /// As lines of text.
    pub(crate) fn to_text(&self) -> String {
        let mut text = format!("{} ({})\n", self.name, self.file);
        let mut line = |label: &str, what: String| {
            let _ = writeln!(text, "  {label:<10} {what}");
        };
        line(
            "geometry",
            format!(
                "{}, {}",
                plural(self.triangles as u64, "triangle"),
                vertices(self.vertices)
            ),
        );
        if let (Some(min), Some(max)) = (self.bounds.min, self.bounds.max) {
            line("bounds", format!("{} to {}", list(min), list(max)));
        }
        let c = &self.camera;
        line(
            "camera",
            format!(
                "at {}, towards {}, up {}, {:.2} x {:.2} degrees",
                list(c.origin),
                list(c.forward),
                list(c.up),
                c.horizontal_degrees,
                c.vertical_degrees
            ),
        );
        line("settings", self.settings.clone());
        for m in &self.materials {
            let what = plural(m.triangles as u64, "triangle");
            line(
                "material",
                format!("{}: albedo {}, {what}", m.name, list(m.albedo)),
            );
        }
        for l in &self.lights {
            let (radiance, power) = (list(l.radiance), list(l.power.map(|p| p as f32)));
            let what = match l.triangles {
                0 => String::new(),
                n => format!(", {}", plural(n as u64, "triangle")),
            };
            let name = &l.name;
            line(
                "light",
                format!("{name}: {radiance} W/m^2/sr, {power} W{what}"),
            );
        }
        if self.lights.is_empty() {
            line("light", "none".to_owned());
        }
        for t in &self.memory {
            line(
                "memory",
                format!("{:<20} {}", t.table, bytes(t.bytes as u64)),
            );
        }
        let all: usize = self.memory.iter().map(|t| t.bytes).sum();
        line("memory", format!("{:<20} {}", "in all", bytes(all as u64)));
        line("hash", self.hash.clone());
        text
    }
}

fn vertices(n: usize) -> String {
    match n {
        1 => "1 vertex".to_owned(),
        n => format!("{n} vertices"),
    }
}

fn list(v: [f32; 3]) -> String {
    // Adding zero makes of -0, which only confuses here, 0.
    let [x, y, z] = v.map(|c| c + 0.0);
    format!("({x}, {y}, {z})")
}
