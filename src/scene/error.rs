//! What is wrong with a scene, and where.

use std::fmt;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A scene that cannot be loaded.
///
/// `Display` is one line, `file:line:column: what was found, what was expected`, with as much of
/// the position as is known. As a [`miette::Diagnostic`] it also shows the place in the file.
#[derive(Clone)]
pub struct SceneError(Box<Inner>);

#[derive(Clone)]
struct Inner {
    path: PathBuf,
    /// Line and column, from 1; a column of 0 is unknown.
    position: Option<(usize, usize)>,
    message: String,
    /// Text of the file and the bytes of it that are wrong.
    source: Option<(Arc<str>, Range<usize>)>,
}

impl SceneError {
    /// An error about a whole file.
    pub fn file(path: &Path, message: impl Into<String>) -> Self {
        Self(Box::new(Inner {
            path: path.to_owned(),
            position: None,
            message: message.into(),
            source: None,
        }))
    }

    /// An error about line `line` (from 1) of a file.
    pub fn line(path: &Path, line: usize, message: impl Into<String>) -> Self {
        let mut error = Self::file(path, message);
        error.0.position = Some((line, 0));
        error
    }

    /// An error about the bytes `span` of a file whose text is at hand.
    pub fn span(
        path: &Path,
        text: &Arc<str>,
        span: Range<usize>,
        message: impl Into<String>,
    ) -> Self {
        let start = text.floor_char_boundary(span.start);
        let end = text.ceil_char_boundary(span.end.max(start));
        let before = &text[..start];
        let line = before.matches('\n').count() + 1;
        let column = before.chars().rev().take_while(|&c| c != '\n').count() + 1;
        let mut error = Self::file(path, message);
        error.0.position = Some((line, column));
        error.0.source = Some((text.clone(), start..end));
        error
    }

    /// An error of the operating system about a file.
    pub fn io(path: &Path, error: &std::io::Error) -> Self {
        Self::file(path, io_message(error))
    }

    /// The file that is wrong.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.0.path
    }

    /// The line that is wrong, from 1, where there is one.
    #[must_use]
    pub fn line_number(&self) -> Option<usize> {
        self.0.position.map(|(line, _)| line)
    }

    /// What is wrong, without the place.
    #[must_use]
    pub fn message(&self) -> &str {
        &self.0.message
    }
}

/// The common failures in words that do not depend on the operating system.
pub(super) fn io_message(error: &std::io::Error) -> String {
    use std::io::ErrorKind::{InvalidData, IsADirectory, NotFound, PermissionDenied};
    match error.kind() {
        NotFound => "no such file".to_owned(),
        IsADirectory => "is a folder, expected a file".to_owned(),
        PermissionDenied => "permission denied".to_owned(),
        InvalidData => "not valid UTF-8 text".to_owned(),
        _ => format!("cannot be read: {error}"),
    }
}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.0.path.display())?;
        match self.0.position {
            Some((line, 0)) => write!(f, ":{line}")?,
            Some((line, column)) => write!(f, ":{line}:{column}")?,
            None => {}
        }
        write!(f, ": {}", self.0.message)
    }
}

impl fmt::Debug for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "SceneError({self})")
    }
}

impl std::error::Error for SceneError {}

impl miette::Diagnostic for SceneError {
    fn source_code(&self) -> Option<&dyn miette::SourceCode> {
        let (text, _) = self.0.source.as_ref()?;
        Some(text)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = miette::LabeledSpan> + '_>> {
        let (_, span) = self.0.source.as_ref()?;
        let label = miette::LabeledSpan::new_primary_with_span(None, span.clone());
        Some(Box::new(std::iter::once(label)))
    }
}
