//! What ends a command early, how it is printed, and its exit code.

use huygens::film::output::OutputError;
use miette::{Diagnostic, Report};
use std::collections::BTreeSet;
use std::fmt::Write;
use std::io::IsTerminal;

/// Why a command did not do what was asked.
#[derive(Debug)]
pub(crate) enum Failure {
    /// The input or the request is wrong; found before any rendering.
    Input(Report),
    /// Anything else.
    Other(Report),
    /// It is slower than what it was compared with.
    Slower(String),
    /// The user interrupted it; what is there is written, as the message says.
    Interrupted(String),
}

impl From<OutputError> for Failure {
    fn from(error: OutputError) -> Self {
        if error.bad_request {
            Self::Input(error.into())
        } else {
            Self::Other(error.into())
        }
    }
}

impl Failure {
    /// Wrong input, in words.
    pub(crate) fn input(message: impl Into<String>) -> Self {
        Self::Input(Report::msg(message.into()))
    }

    /// A panic: the message is out already.
    pub(crate) fn defect() -> Self {
        Self::Other(Report::msg(
            "this is a defect of huygens; please report it with the message above and the scene",
        ))
    }

    /// The exit code of the process.
    pub(crate) fn code(&self) -> u8 {
        match self {
            Self::Input(_) => 2,
            Self::Slower(_) => 3,
            Self::Other(_) => 1,
            Self::Interrupted(_) => 130,
        }
    }

    /// Prints it on the standard error: with the place in the file drawn on a terminal, as plain
    /// lines otherwise.
    pub(crate) fn print(&self) {
        match self {
            Self::Interrupted(message) => eprintln!("interrupted: {message}"),
            Self::Slower(message) => eprintln!("slower: {message}"),
            Self::Input(report) | Self::Other(report) => {
                if std::io::stderr().is_terminal() {
                    eprintln!("{report:?}");
                } else {
                    eprint!("{}", plain(report.as_ref()));
                }
            }
        }
    }
}

/// `error: message`, a line for each cause, and the help.
fn plain(diagnostic: &dyn Diagnostic) -> String {
    let mut out = format!("error: {diagnostic}\n");
    let mut cause = diagnostic.source();
    while let Some(error) = cause {
        let _ = writeln!(out, "  because: {error}");
        cause = error.source();
    }
    if let Some(help) = diagnostic.help() {
        let _ = writeln!(out, "  help: {help}");
    }
    out
}

/// Prints each warning once, in order; with `strict` they are a failure.
pub(crate) fn warn(warnings: &[String], strict: bool) -> Result<(), Failure> {
    let mut seen = BTreeSet::new();
    for warning in warnings.iter().filter(|w| seen.insert(*w)) {
        eprintln!("warning: {warning}");
    }
    match seen.len() {
        0 => Ok(()),
        _ if !strict => Ok(()),
        1 => Err(Failure::input("--strict makes the warning above an error")),
        n => Err(Failure::input(format!(
            "--strict makes the {n} warnings above errors"
        ))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, thiserror::Error, Diagnostic)]
    #[error("outer")]
    #[diagnostic(help("do this"))]
    struct Outer(#[source] std::io::Error);

    #[test]
    fn a_plain_error_has_its_causes_and_its_help_and_no_colour() {
        let text = plain(&Outer(std::io::Error::other("inner")));
        assert_eq!(text, "error: outer\n  because: inner\n  help: do this\n");
    }

    #[test]
    fn strict_fails_on_warnings_only() {
        assert!(warn(&[], true).is_ok());
        assert!(warn(&["a".into()], false).is_ok());
        let failure = warn(&["a".into(), "a".into()], true).expect_err("strict");
        assert_eq!(failure.code(), 2);
    }
}
