//! Numbers for scripts: JSON files.

use huygens::film::output::{OutputError, write_atomically};
use serde::Serialize;
use std::io::Write;
use std::path::Path;

/// Writes `value` to `path`, atomically, for people to read too.
pub(crate) fn write(path: &Path, value: &impl Serialize) -> Result<(), OutputError> {
    write_atomically(path, |to| -> std::io::Result<()> {
        serde_json::to_writer_pretty(&mut *to, value)?;
        to.write_all(b"\n")
    })
}
