//! Timelines as Chrome's trace events, which Perfetto and chrome://tracing open.
//!
//! Format: "Trace Event Format", the JSON object form: complete events (`ph` `X`) with `ts` and
//! `dur` in microseconds, a thread (row) a worker, named by metadata events (`ph` `M`).

use crate::wave::Timeline;
use serde_json::json;
use std::io::{self, Write};

/// Writes the timelines of the workers of one render, a row each. `name` is that of the process.
///
/// # Errors
/// What the writer says.
pub fn write(to: &mut impl Write, name: &str, timelines: &[Timeline]) -> io::Result<()> {
    to.write_all(b"{\"displayTimeUnit\":\"ns\",\"traceEvents\":[\n")?;
    let process = json!({
        "name": "process_name", "ph": "M", "pid": 1, "tid": 0, "args": {"name": name}
    });
    write!(to, "{process}")?;
    for (worker, timeline) in timelines.iter().enumerate() {
        let thread = json!({
            "name": "thread_name", "ph": "M", "pid": 1, "tid": worker + 1,
            "args": {"name": format!("worker {}", worker + 1)}
        });
        write!(to, ",\n{thread}")?;
        for slice in &timeline.slices {
            let event = json!({
                "name": slice.stage, "cat": "stage", "ph": "X", "pid": 1, "tid": worker + 1,
                "ts": slice.start * 1e6, "dur": slice.seconds * 1e6,
                "args": {"items": slice.items}
            });
            write!(to, ",\n{event}")?;
        }
        if timeline.left_out > 0 {
            let end = timeline.slices.last().map_or(0.0, |s| s.start + s.seconds);
            let event = json!({
                "name": format!("{} calls left out", timeline.left_out), "cat": "stage", "ph": "i",
                "s": "t", "pid": 1, "tid": worker + 1, "ts": end * 1e6
            });
            write!(to, ",\n{event}")?;
        }
    }
    to.write_all(b"\n]}\n")
}
