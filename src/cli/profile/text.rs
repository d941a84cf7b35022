//! A profile for people.

use super::Profile;
use crate::cli::text::si;
use huygens::profile::roofline;
use std::fmt::Write;

/// Rows of the chart of bounces.
const BOUNCES: usize = 16;

impl Profile {
    /// The whole report.
    pub(super) fn text(&self) -> String {
        let mut out = format!("{}\n  settings {}\n", self.scene, self.settings);
        let per_second = |n: u64| si(n as f64 / self.seconds);
        let _ = writeln!(
            out,
            "  render   {:.2} s on {} threads, waves of {}: {}samples/s, {}rays/s",
            self.seconds,
            self.threads,
            self.wave,
            per_second(self.samples),
            per_second(self.rays)
        );
        let l = &self.limits;
        let _ = writeln!(
            out,
            "  one core {:.0} Gop/s, {:.0} GB/s from its cache, {:.0} GB/s from memory\n",
            l.gigaoperations, l.near, l.far
        );
        self.kernels(&mut out);
        self.counters(&mut out);
        self.queues(&mut out);
        out.push_str("\nroofline of one core: -- out of its cache, .. out of memory\n");
        out.push_str(&roofline::text(l, &self.kernels, 64, 16));
        if !self.visits_counted {
            out.push_str(
                "  what traversal computes depends on the rays: build with --features visits to \
                 count it\n",
            );
        }
        out
    }

    fn kernels(&self, out: &mut String) {
        let _ = writeln!(
            out,
            "{:<20} {:>6} {:>9} {:>11} {:>6} {:>8} {:>7} {:>7} {:>7} {:>7}",
            "kernel",
            "share",
            "ns/item",
            "items/s",
            "lanes",
            "B/item",
            "GB/s",
            "Gop/s",
            "nodes",
            "tris"
        );
        let known = |value: Option<f64>| value.map_or("-".to_owned(), |v| format!("{v:.2}"));
        for r in &self.kernels {
            let _ = writeln!(
                out,
                "{:<20} {:>5.1}% {:>9.2} {:>11} {:>5.1}% {:>8.1} {:>7.2} {:>7} {:>7} {:>7}",
                r.name,
                100.0 * r.share,
                r.nanoseconds,
                si(r.per_second),
                100.0 * r.occupancy,
                r.bytes,
                r.gigabytes_per_second,
                known(r.gigaoperations_per_second),
                known(r.nodes),
                known(r.triangles),
            );
        }
        let accounted: f64 = self.kernels.iter().map(|r| r.seconds).sum();
        let _ = writeln!(
            out,
            "these are {:.1}% of the workers' {:.2} s",
            100.0 * accounted / self.worker_seconds,
            self.worker_seconds
        );
    }

    fn counters(&self, out: &mut String) {
        let closed = self
            .counters
            .iter()
            .filter_map(|(n, why)| Some((n, why.as_ref()?)));
        let closed: Vec<_> = closed.collect();
        if closed.len() < self.counters.len() {
            let names: Vec<_> = self
                .counters
                .iter()
                .filter(|(_, why)| why.is_none())
                .collect();
            let _ = write!(out, "\n{:<20}", "an item");
            for (name, _) in &names {
                let _ = write!(out, " {name:>17}");
            }
            let ipc = ["cycles", "instructions"]
                .iter()
                .all(|n| self.counters[n].is_none());
            let _ = writeln!(out, "{}", if ipc { "    IPC" } else { "" });
            for r in &self.kernels {
                let _ = write!(out, "{:<20}", r.name);
                for (name, _) in &names {
                    let count = r.counted.get(*name).copied().unwrap_or_default();
                    let _ = write!(out, " {count:>17.4}");
                }
                let ratio = r.counted.get("instructions").zip(r.counted.get("cycles"));
                if let Some((instructions, cycles)) = ratio {
                    let _ = write!(out, " {:>6.2}", instructions / cycles);
                }
                out.push('\n');
            }
        }
        if let Some((_, why)) = closed.first() {
            let names: Vec<&str> = closed.iter().map(|(name, _)| **name).collect();
            let _ = writeln!(out, "not to be read here: {} ({why})", names.join(", "));
        }
    }

    fn queues(&self, out: &mut String) {
        let most = self
            .bounces
            .iter()
            .map(|b| b.rays)
            .max()
            .unwrap_or(0)
            .max(1);
        out.push_str("\nrays by bounce (# closest hit, and occlusion rays cast there)\n");
        for (i, b) in self.bounces.iter().enumerate().take(BOUNCES) {
            let _ = writeln!(
                out,
                "{i:>4} {:<40} {:>11} {:>11}",
                "#".repeat((40 * b.rays).div_ceil(most) as usize),
                si(b.rays as f64),
                si(b.shadow_rays as f64)
            );
        }
        let deeper = self.bounces.iter().skip(BOUNCES);
        let rays: u64 = deeper.map(|b| b.rays).sum();
        if rays > 0 {
            let _ = writeln!(out, "deeper: {}", si(rays as f64));
        }
    }
}
