//! Files that are written whole or not at all.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use tempfile::NamedTempFile;

/// Image file formats, known by their extension.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// OpenEXR: linear floats.
    Exr,
    /// PNG: 8 bits, for screens.
    Png,
}

/// Why an output cannot be written.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
#[error("cannot write {path}: {problem}")]
pub struct OutputError {
    path: String,
    problem: String,
    #[help]
    help: Option<String>,
    /// Whether whoever named the output is at fault, and could have known before the render.
    pub bad_request: bool,
}

impl OutputError {
    fn request(path: &Path, problem: String, help: Option<&str>) -> Self {
        Self {
            path: path.display().to_string(),
            problem,
            help: help.map(str::to_owned),
            bad_request: true,
        }
    }

    fn failure(path: &Path, problem: &dyn std::fmt::Display) -> Self {
        Self {
            bad_request: false,
            ..Self::request(path, problem.to_string(), None)
        }
    }
}

impl Format {
    /// The format that the extension of `path` names, in either case.
    ///
    /// # Errors
    /// If it names none that is known.
    pub fn of(path: &Path) -> Result<Self, OutputError> {
        let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
        match extension.as_deref() {
            Some("exr") => Ok(Self::Exr),
            Some("png") => Ok(Self::Png),
            other => {
                let problem = other.map_or_else(
                    || "the name has no extension".to_owned(),
                    |e| format!("unknown image format .{e}"),
                );
                let help = "expected a name that ends in .exr or .png";
                Err(OutputError::request(path, problem, Some(help)))
            }
        }
    }
}

/// Checks what can be known before there is anything to write: that the folder exists and takes a
/// new file, and that `path` does not name a folder. Leaves nothing behind.
///
/// # Errors
/// Says what stands in the way.
pub fn ensure_writable(path: &Path) -> Result<(), OutputError> {
    if path.is_dir() {
        let problem = "it is a folder".to_owned();
        return Err(OutputError::request(path, problem, Some("name a file")));
    }
    if path.file_name().is_none() {
        let problem = "it names no file".to_owned();
        return Err(OutputError::request(path, problem, None));
    }
    if is_special(path) {
        return Ok(());
    }
    let folder = folder_of(path);
    if !folder.exists() {
        let problem = format!("the folder {} does not exist", folder.display());
        let help = "create it first, or name another";
        return Err(OutputError::request(path, problem, Some(help)));
    }
    if !folder.is_dir() {
        let problem = format!("{} is not a folder", folder.display());
        return Err(OutputError::request(path, problem, None));
    }
    temporary(folder).map(drop).map_err(|e| {
        let problem = format!("the folder {} takes no new file: {e}", folder.display());
        OutputError::request(path, problem, None)
    })
}

/// Writes `path` through `fill`, into a temporary file beside it that takes its place at the end.
/// If anything fails, what was at `path` is still there and the temporary file is gone.
///
/// # Errors
/// If the file cannot be made, filled, flushed to the disk or renamed.
pub fn write_atomically<E: std::fmt::Display>(
    path: &Path,
    fill: impl FnOnce(&mut BufWriter<&File>) -> Result<(), E>,
) -> Result<(), OutputError> {
    let failure = |e: &dyn std::fmt::Display| OutputError::failure(path, e);
    if is_special(path) {
        let file = File::options().write(true).open(path);
        return fill_and_flush(&file.map_err(|e| failure(&e))?, fill).map_err(|e| failure(&e));
    }
    // A link stays one: what it points to is replaced.
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    let file = temporary(folder_of(&target)).map_err(|e| failure(&e))?;
    let _pending = Pending::new(file.path());
    fill_and_flush(file.as_file(), fill).map_err(|e| failure(&e))?;
    file.as_file().sync_all().map_err(|e| failure(&e))?;
    file.persist(&target).map_err(|e| failure(&e.error))?;
    Ok(())
}

/// Removes the temporary files of all writes under way: for a process that is about to exit in
/// the middle of them.
pub fn abandon_writes() {
    if let Ok(pending) = PENDING.lock() {
        for path in pending.iter() {
            // Nobody is left to tell.
            let _ = fs::remove_file(path);
        }
    }
}

static PENDING: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// Names a temporary file to [`abandon_writes`] for as long as it lives.
struct Pending(PathBuf);

impl Pending {
    fn new(path: &Path) -> Self {
        if let Ok(mut pending) = PENDING.lock() {
            pending.push(path.to_owned());
        }
        Self(path.to_owned())
    }
}

impl Drop for Pending {
    fn drop(&mut self) {
        if let Ok(mut pending) = PENDING.lock() {
            pending.retain(|p| *p != self.0);
        }
    }
}

fn fill_and_flush<E: std::fmt::Display>(
    file: &File,
    fill: impl FnOnce(&mut BufWriter<&File>) -> Result<(), E>,
) -> Result<(), String> {
    let mut writer = BufWriter::new(file);
    fill(&mut writer).map_err(|e| e.to_string())?;
    writer.flush().map_err(|e| e.to_string())
}

/// Whether `path` is a device or a pipe, which is written to as it is.
fn is_special(path: &Path) -> bool {
    fs::metadata(path).is_ok_and(|m| !m.is_file() && !m.is_dir())
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(p) if !p.as_os_str().is_empty() => p,
        _ => Path::new("."),
    }
}

fn temporary(folder: &Path) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".huygens-").suffix(".part");
    // Temporary files are private by default; an output has the rights that any new file has.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(folder)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).expect("a folder");
        let name = |e: io::Result<fs::DirEntry>| e.expect("an entry").file_name();
        entries.map(|e| name(e).to_string_lossy().into()).collect()
    }

    #[test]
    fn a_write_that_fails_leaves_the_old_file_and_nothing_else() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.exr");
        fs::write(&path, "old").expect("written");
        let result = write_atomically(&path, |w| {
            w.write_all(&[0; 100_000])?;
            Err(io::Error::other("the disk is full"))
        });
        let message = result.expect_err("it failed").to_string();
        let expected = format!("cannot write {}: the disk is full", path.display());
        assert_eq!(message, expected);
        assert_eq!(fs::read(&path).expect("there"), b"old");
        assert_eq!(names(folder.path()), ["a.exr"]);
    }

    #[test]
    fn a_write_replaces_the_old_file() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.exr");
        fs::write(&path, "old").expect("written");
        write_atomically(&path, |w| w.write_all(b"new")).expect("written");
        assert_eq!(fs::read(&path).expect("there"), b"new");
        assert_eq!(names(folder.path()), ["a.exr"]);
    }

    #[test]
    fn the_check_leaves_nothing_behind() {
        let folder = tempfile::tempdir().expect("a folder");
        ensure_writable(&folder.path().join("a.exr")).expect("writable");
        assert!(names(folder.path()).is_empty());
    }

    #[cfg(unix)]
    #[test]
    fn outputs_have_the_rights_of_any_new_file() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().expect("a folder");
        let (ours, plain) = (folder.path().join("a"), folder.path().join("b"));
        write_atomically(&ours, |w| w.write_all(b"x")).expect("written");
        fs::write(&plain, "x").expect("written");
        let mode = |p: &Path| fs::metadata(p).expect("there").permissions().mode();
        assert_eq!(mode(&ours), mode(&plain));
    }

    #[cfg(unix)]
    #[test]
    fn a_link_is_written_through() {
        let folder = tempfile::tempdir().expect("a folder");
        let (real, link) = (folder.path().join("real"), folder.path().join("link"));
        fs::write(&real, "old").expect("written");
        std::os::unix::fs::symlink(&real, &link).expect("linked");
        write_atomically(&link, |w| w.write_all(b"new")).expect("written");
        assert_eq!(fs::read(&real).expect("there"), b"new");
        assert!(fs::symlink_metadata(&link).expect("there").is_symlink());
    }
}
