//! A request is a line of words, an answer too.

use std::fmt::Write;
use std::iter::Peekable;
use std::str::{FromStr, Split};

/// The words of a request; after the last there are empty ones.
pub struct Words<'a>(Peekable<Split<'a, char>>);

impl<'a> Words<'a> {
    pub fn new(line: &'a str) -> Self {
        Self(line.split(' ').peekable())
    }

    pub fn more(&mut self) -> bool {
        self.0.peek().is_some()
    }

    pub fn word(&mut self) -> &'a str {
        self.0.next().unwrap_or_default()
    }

    /// A number, none if the word is empty.
    pub fn maybe<T: FromStr>(&mut self) -> Option<T> {
        self.word().parse().ok()
    }

    pub fn number<T: FromStr + Default>(&mut self) -> T {
        self.maybe().unwrap_or_default()
    }

    pub fn flag(&mut self) -> bool {
        self.word() == "1"
    }

    pub fn octets(&mut self) -> Vec<u8> {
        unhex(self.word())
    }

    /// Bytes as often as a number says that stands before them.
    pub fn counted(&mut self) -> Vec<Vec<u8>> {
        (0..self.number()).map(|_| self.octets()).collect()
    }
}

/// Why a request cannot be answered: the error, and its keys.
pub struct Refusal(pub String);

/// What follows `ok`.
pub type Answer = Result<String, Refusal>;

impl From<icd::Error> for Refusal {
    fn from(error: icd::Error) -> Self {
        Self(match error {
            icd::Error::Length { expected, actual } => counted("length", expected, actual),
            icd::Error::Range { field, .. } => ranged(field),
            _ => "unknown-id".into(),
        })
    }
}

pub fn counted(error: &str, expected: usize, actual: usize) -> String {
    format!("{error} expected={expected} actual={actual}")
}

pub fn ranged(field: &str) -> String {
    format!("range field={}", hex(field.as_bytes()))
}

pub fn hex(bytes: &[u8]) -> String {
    bytes.iter().fold(String::new(), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    })
}

pub fn unhex(text: &str) -> Vec<u8> {
    let bytes = (0..text.len() / 2).map(|at| u8::from_str_radix(&text[2 * at..2 * at + 2], 16));
    bytes.map(Result::unwrap_or_default).collect()
}

/// A list, each item with a comma.
pub fn list(items: impl IntoIterator<Item = String>) -> String {
    items.into_iter().map(|item| item + ",").collect()
}
