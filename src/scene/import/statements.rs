//! The lines of OBJ and MTL files: text of any encoding, continued lines, comments.

use std::borrow::Cow;
use std::io::{self, Read};

/// Text of a file, whatever bytes it holds: only ASCII carries meaning in OBJ and MTL, and names
/// that are not UTF-8 are told apart well enough by what replaces them.
pub(super) fn text(bytes: &[u8]) -> Cow<'_, str> {
    String::from_utf8_lossy(bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes))
}

/// Statements with the number of their first line: continued lines joined, comments cut off.
pub(super) fn statements(text: &str) -> impl Iterator<Item = (usize, Cow<'_, str>)> {
    let mut lines = text.lines().enumerate();
    std::iter::from_fn(move || {
        let (number, line) = lines.next()?;
        let mut whole = Cow::Borrowed(line.trim_end());
        while let Some(head) = whole.strip_suffix('\\') {
            let Some((_, next)) = lines.next() else {
                whole = Cow::Owned(head.to_owned());
                break;
            };
            whole = Cow::Owned(format!("{head} {}", next.trim_end()));
        }
        // A '#' starts a comment where a word could start: names may hold one inside.
        let bytes = whole.as_bytes();
        let starts = |at: usize| at == 0 || bytes[at - 1].is_ascii_whitespace();
        let cut = (0..bytes.len()).find(|&at| bytes[at] == b'#' && starts(at));
        if let Some(cut) = cut {
            whole = match whole {
                Cow::Borrowed(s) => Cow::Borrowed(&s[..cut]),
                Cow::Owned(s) => Cow::Owned(s[..cut].to_owned()),
            };
        }
        Some((number + 1, whole))
    })
}

/// A statement's keyword and the rest of it.
pub(super) fn split(statement: &str) -> (&str, &str) {
    let trimmed = statement.trim();
    trimmed
        .split_once(|c: char| c.is_ascii_whitespace())
        .map_or((trimmed, ""), |(word, rest)| (word, rest.trim()))
}

/// A file in pieces of whole statements, so that it need never be in memory as a whole.
#[derive(Debug)]
pub(super) struct Pieces<R> {
    reader: R,
    size: usize,
    /// What has been read beyond the last piece.
    rest: Vec<u8>,
}

impl<R: Read> Pieces<R> {
    /// Pieces of at most `size` bytes, or of one statement where that is longer.
    pub(super) fn new(reader: R, size: usize) -> Self {
        Self {
            reader,
            size,
            rest: Vec::new(),
        }
    }

    /// The next piece; none at the end.
    pub(super) fn next(&mut self) -> io::Result<Option<Vec<u8>>> {
        let mut piece = std::mem::take(&mut self.rest);
        let mut wanted = self.size.max(piece.len() + 1);
        loop {
            let more = wanted - piece.len();
            piece.reserve_exact(more);
            let read = (&mut self.reader)
                .take(more as u64)
                .read_to_end(&mut piece)?;
            if read < more {
                return Ok((!piece.is_empty()).then_some(piece));
            }
            if let Some(end) = last_end(&piece) {
                self.rest = piece.split_off(end);
                return Ok(Some(piece));
            }
            wanted *= 2;
        }
    }
}

/// Just behind the last line end that surely ends a statement: the line is not continued, as far as
/// its last ASCII character tells.
fn last_end(piece: &[u8]) -> Option<usize> {
    let ends = |at: usize| {
        let last = piece[..at].trim_ascii_end().last();
        piece[at] == b'\n' && last.is_none_or(|&c| c != b'\\' && c.is_ascii())
    };
    (0..piece.len()).rfind(|&at| ends(at)).map(|at| at + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_hold_whole_statements_and_lose_nothing() {
        let text = "v 1 2 3\n# a \\\nf 1 \\ \r\n 2 3\n\n\nusemtl \u{e9}\nf 3 2 1\nlast";
        let whole: Vec<String> = statements(text).map(|(_, s)| s.into_owned()).collect();
        for size in 1..text.len() + 2 {
            let mut pieces = Pieces::new(text.as_bytes(), size);
            let (mut bytes, mut parts) = (Vec::new(), Vec::new());
            while let Some(piece) = pieces.next().unwrap() {
                assert!(!piece.is_empty());
                let text = std::str::from_utf8(&piece).unwrap();
                parts.extend(statements(text).map(|(_, s)| s.into_owned()));
                bytes.extend(piece);
            }
            assert_eq!(bytes, text.as_bytes(), "size {size}");
            assert_eq!(parts, whole, "size {size}");
        }
    }
}
