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
                "{} at {}, towards {}, up {}{}",
                c.kind,
                list(c.origin),
                list(c.forward),
                list(c.up),
                c.view()
            ),
        );
        line("settings", self.settings.clone());
        for m in &self.materials {
            let what = plural(m.triangles as u64, "triangle");
            line(
                "material",
                format!("{}: albedo {}, {what}", name(&m.name), list(m.albedo)),
            );
        }
        for l in &self.lights {
            let (radiance, power) = (list(l.radiance), list(l.power.map(|p| p as f32)));
            let what = match l.triangles {
                0 => String::new(),
                n => format!(", {}", plural(n as u64, "triangle")),
            };
            let name = name(&l.name);
            line(
                "light",
                format!("{name}: {radiance} W/m^2/sr, {power} W{what}"),
            );
        }
        if self.lights.is_empty() {
            line("light", "none".to_owned());
        }
        for e in &self.plan.effects {
            line("effect", format!("{}: {}", e.name, e.reason));
        }
        line("stages", self.plan.stages.join(", "));
        for q in &self.plan.queues {
            let columns = q.columns.join(", ");
            line(
                "queue",
                format!(
                    "{}: {} B an item, room for {} ({columns})",
                    q.name, q.bytes_per_item, q.capacity
                ),
            );
        }
        let mut row = |table: &str, size: usize, each: Option<f64>| {
            let each = each.map_or_else(String::new, |b| format!("  {b:.1} B a triangle"));
            let what = format!("{table:<20} {:>9}{each}", bytes(size as u64));
            line("memory", what);
        };
        for t in &self.memory {
            row(t.table, t.bytes, t.bytes_per_triangle);
        }
        let all = self.memory.iter().map(|t| t.bytes).sum();
        row("in all", all, None);
        if let Some(each) = self.bytes_per_triangle {
            let geometry = self
                .memory
                .iter()
                .filter(|t| t.bytes_per_triangle.is_some());
            row("by geometry", geometry.map(|t| t.bytes).sum(), Some(each));
        }
        line("hash", self.hash.clone());
        text
    }
}

/// Files may leave their materials without a name.
fn name(name: &str) -> &str {
    if name.is_empty() { "(unnamed)" } else { name }
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
