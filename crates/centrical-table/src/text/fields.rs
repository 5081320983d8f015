//! The fields of a line: what divides them, and the numbers that stand in them.

use std::borrow::Cow;

use memchr::memchr;

use super::lines::TABLE;
use crate::column::{Backwards, Field};
use crate::error::quoted;
use crate::stamp::StampKind;

/// What stands wrong in a line.
pub(super) struct Fault {
    /// Name of the column, where one is meant.
    pub column: Option<String>,
    pub found: String,
    pub expected: String,
}

impl Fault {
    pub fn no_table(found: String) -> Self {
        Self { column: None, found, expected: TABLE.to_owned() }
    }

    /// A value that is below the one before it, in a row whose first field is that stamp.
    pub fn of(backwards: &Backwards, fields: &[Field], stamp: Option<StampKind>) -> Self {
        let is_of_day = backwards.field == 0 && stamp == Some(StampKind::TimeOfDay);
        fields[backwards.field].fault(backwards.found(), &backwards.expected(is_of_day))
    }
}

impl Field {
    pub(super) fn fault(&self, found: String, expected: &str) -> Fault {
        Fault { column: Some(self.name.to_string()), found, expected: expected.to_owned() }
    }
}

/// What divides the fields of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Delimiter {
    Byte(u8),
    /// Any number of spaces and tabs.
    Blanks,
}

impl Delimiter {
    /// The delimiter of a line: the first of `;`, tab, `,` that occurs outside quotes, or else blanks.
    pub fn of(line: &[u8]) -> Self {
        let mut inside = false;
        let outside: Vec<u8> = line
            .iter()
            .copied()
            .filter(|byte| {
                inside ^= *byte == b'"';
                !inside
            })
            .collect();
        let decimal_commas =
            || outside.split(u8::is_ascii_whitespace).filter(|w| !w.is_empty()).all(|w| number(w).is_some());
        match [b';', b'\t', b','].into_iter().find(|byte| outside.trim_ascii().contains(byte)) {
            Some(b',') if outside.trim_ascii().contains(&b' ') && decimal_commas() => Self::Blanks,
            Some(byte) => Self::Byte(byte),
            None => Self::Blanks,
        }
    }

    /// A line without what stands before its first field and after its last.
    #[inline]
    pub fn trimmed(self, line: &[u8]) -> &[u8] {
        if self == Self::Blanks { line.trim_ascii() } else { line }
    }

    /// The first field as it is written, and any rest of the line.
    pub fn split(self, text: &[u8]) -> Result<(&[u8], Option<&[u8]>), Fault> {
        let start = text.len() - text.trim_ascii_start().len();
        let quote = if text[start..].first() == Some(&b'"') { end_of_quote(text, start)? } else { 0 };
        let open = &text[quote..];
        let end = match self {
            Self::Byte(delimiter) => memchr(delimiter, open),
            Self::Blanks => open.iter().position(u8::is_ascii_whitespace),
        };
        let (field, after) = text.split_at(end.map_or(text.len(), |end| quote + end));
        let rest = after.get(1..).map(|rest| if self == Self::Blanks { rest.trim_ascii_start() } else { rest });
        Ok((field, rest))
    }

    /// All fields of a line, without quotes and blanks around.
    pub fn texts(self, line: &[u8]) -> Result<Vec<Cow<'_, [u8]>>, Fault> {
        let mut texts = Vec::new();
        let mut rest = Some(self.trimmed(line));
        while let Some(text) = rest {
            let field;
            (field, rest) = self.split(text)?;
            texts.push(unquoted(field));
        }
        Ok(texts)
    }
}

/// Place after the quote that closes the one at `start`; a quote inside is doubled.
fn end_of_quote(text: &[u8], start: usize) -> Result<usize, Fault> {
    let mut at = start + 1;
    while let Some(quote) = memchr(b'"', &text[at..]) {
        at += quote + 1;
        if text.get(at) != Some(&b'"') {
            return Ok(at);
        }
        at += 1;
    }
    Err(Fault { column: None, found: quoted(text), expected: "a closing quote".to_owned() })
}

/// A field without quotes and blanks around it.
pub(super) fn unquoted(field: &[u8]) -> Cow<'_, [u8]> {
    let field = field.trim_ascii();
    match field.strip_prefix(b"\"").and_then(|f| f.strip_suffix(b"\"")) {
        Some(inner) => {
            let text = String::from_utf8_lossy(inner).replace("\"\"", "\"");
            Cow::Owned(text.trim().as_bytes().to_vec())
        }
        None => Cow::Borrowed(field),
    }
}

/// A number with a decimal point or, as the delimiter can not be inside a field, a decimal comma.
pub(super) fn number(text: &[u8]) -> Option<f64> {
    if !text.contains(&b',') {
        return fast_float2::parse(text).ok();
    }
    let point: Vec<u8> = text.iter().map(|byte| if *byte == b',' { b'.' } else { *byte }).collect();
    fast_float2::parse(point).ok()
}
