//! Reads a native scene file. Every error knows its place: syntax, type, range and unknown keys
//! while the text is read, and through [`SceneFile::error`] all that is found wrong later.

use super::description::Description;
use super::error::SceneError;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use toml::de::{DeTable, DeValue};

/// A scene file's path and text, to point into.
#[derive(Debug)]
pub(super) struct SceneFile {
    pub(super) path: PathBuf,
    text: Arc<str>,
}

impl SceneFile {
    pub(super) fn read(path: &Path) -> Result<Self, SceneError> {
        let text = std::fs::read_to_string(path).map_err(|e| SceneError::io(path, &e))?;
        Ok(Self {
            path: path.to_owned(),
            text: text.into(),
        })
    }

    /// The path that the scene file writes as `name`.
    pub(super) fn beside(&self, name: &str) -> PathBuf {
        self.path.parent().unwrap_or(Path::new("")).join(name)
    }

    /// An error about the bytes `span`, named by the key that they belong to.
    pub(super) fn error(&self, span: Range<usize>, message: impl AsRef<str>) -> SceneError {
        let message = match key_path(&self.text, &span) {
            Some(key) => format!("{key}: {}", message.as_ref()),
            None => message.as_ref().to_owned(),
        };
        SceneError::span(&self.path, &self.text, span, message)
    }

    /// What the file says.
    pub(super) fn parse(&self) -> Result<Description, SceneError> {
        let table = match DeTable::parse(&self.text) {
            Ok(table) => table,
            Err(e) => {
                let message = format!("not valid TOML: {}", e.message());
                return Err(self.at_span(e.span(), message));
            }
        };
        drop(table);
        toml::from_str(&self.text).map_err(|e| self.explain(&e))
    }

    fn at_span(&self, span: Option<Range<usize>>, message: String) -> SceneError {
        match span {
            Some(span) => SceneError::span(&self.path, &self.text, span, message),
            None => SceneError::file(&self.path, message),
        }
    }

    /// serde's error in the words of a scene file.
    fn explain(&self, error: &toml::de::Error) -> SceneError {
        let message = error.message();
        let Some(span) = error.span() else {
            return SceneError::file(&self.path, message);
        };
        let Some(unknown) = Unknown::parse(message) else {
            return self.error(span, plain_words(message));
        };
        let hint = suggest(unknown.found, &unknown.expected);
        if unknown.is_key {
            let inside = key_path(&self.text, &span)
                .and_then(|path| path.rsplit_once('.').map(|(table, _)| table.to_owned()));
            let place = inside.map_or_else(String::new, |table| format!(" in `{table}`"));
            let message = format!("unknown key `{}`{place}, {hint}", unknown.found);
            SceneError::span(&self.path, &self.text, span, message)
        } else {
            self.error(span, format!("unknown value `{}`, {hint}", unknown.found))
        }
    }
}

/// serde's other messages: "found ..., expected ..." like those of this crate.
fn plain_words(message: &str) -> String {
    [
        ("missing field ", "missing key "),
        ("invalid type: ", "found "),
        ("invalid value: ", "found "),
        ("invalid length ", "found an array of length "),
    ]
    .iter()
    .find_map(|(theirs, ours)| Some(format!("{ours}{}", message.strip_prefix(theirs)?)))
    .unwrap_or_else(|| message.to_owned())
}

/// serde's message about a name that it does not know: "unknown field `a`, expected one of `b`,
/// `c`". The names between back-quotes are all that is read of it.
struct Unknown<'a> {
    is_key: bool,
    found: &'a str,
    expected: Vec<&'a str>,
}

impl<'a> Unknown<'a> {
    fn parse(message: &'a str) -> Option<Self> {
        let is_key = message.starts_with("unknown field ");
        if !is_key && !message.starts_with("unknown variant ") {
            return None;
        }
        let (head, tail) = message.split_once(", ")?;
        Some(Self {
            is_key,
            found: head.split_once('`')?.1.strip_suffix('`')?,
            expected: tail.split('`').skip(1).step_by(2).collect(),
        })
    }
}

/// "did you mean `x`?" for a near miss, otherwise all that is possible.
///
/// Near is a Damerau-Levenshtein distance of at most a third of the word, the rule that rustc and
/// cargo use too.
pub(super) fn suggest(found: &str, expected: &[&str]) -> String {
    let limit = found.chars().count().max(3) / 3;
    let nearest = expected
        .iter()
        .map(|name| (strsim::damerau_levenshtein(found, name), name))
        .min();
    match nearest {
        Some((distance, name)) if distance <= limit => format!("did you mean `{name}`?"),
        Some(_) => format!("expected {}", list(expected)),
        None => "expected none".to_owned(),
    }
}

/// "`a`", "`a` or `b`", "`a`, `b` or `c`".
fn list(names: &[&str]) -> String {
    let quoted: Vec<String> = names.iter().map(|n| format!("`{n}`")).collect();
    match quoted.split_last() {
        Some((last, [])) => last.clone(),
        Some((last, rest)) => format!("{} or {last}", rest.join(", ")),
        None => String::new(),
    }
}

/// The dotted key whose name or value holds `span`, such as `film.width` or `shapes[2].obj`.
fn key_path(text: &str, span: &Range<usize>) -> Option<String> {
    let table = DeTable::parse(text).ok()?;
    in_table(table.get_ref(), span)
}

fn in_table(table: &DeTable<'_>, span: &Range<usize>) -> Option<String> {
    table.iter().find_map(|(key, value)| {
        let name: &str = key.get_ref();
        let inner = in_value(value, span);
        if inner.is_none() && !holds(&key.span(), span) {
            return None;
        }
        let inner = inner.unwrap_or_default();
        let dot = if inner.is_empty() || inner.starts_with('[') {
            ""
        } else {
            "."
        };
        Some(format!("{name}{dot}{inner}"))
    })
}

/// Path below a value; empty where the value itself is meant.
fn in_value(value: &toml::Spanned<DeValue<'_>>, span: &Range<usize>) -> Option<String> {
    let inner = match value.get_ref() {
        DeValue::Table(table) => in_table(table, span),
        // Elements that are tables are named by their index; numbers in an array speak for
        // themselves.
        DeValue::Array(array) => array.iter().enumerate().find_map(|(i, element)| {
            let inner = in_value(element, span)?;
            Some(match element.get_ref() {
                DeValue::Table(_) if inner.is_empty() => format!("[{i}]"),
                DeValue::Table(_) => format!("[{i}].{inner}"),
                _ => inner,
            })
        }),
        _ => None,
    };
    inner.or_else(|| holds(&value.span(), span).then(String::new))
}

fn holds(outer: &Range<usize>, inner: &Range<usize>) -> bool {
    outer.start <= inner.start && inner.end <= outer.end
}
