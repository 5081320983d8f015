//! Documents as JSON text, a line end at the end; characters that are not shown are escaped. And how numbers and words stand in it.

use std::path::Path;

use centrical::uncertainty::Degrees;
use centrical::{Group, PairRelation, ReferencePoint, Source, Termination};
use centrical_table::{escaped, write_stream};
use nalgebra::Matrix3;
use serde::Serialize;
use serde::de::{Deserialize, Deserializer, Error as _};
use serde::ser::Serializer;

use crate::error::Error;

/// Gives JSON documents, each beside the name of its schema, their text.
macro_rules! documents {
    ($($document:ty: $schema:expr,)*) => {
        $(impl $document {
            /// The text of the JSON document.
            ///
            /// # Errors
            /// [`Error::Json`](crate::Error::Json) when a value has no place in JSON.
            pub fn to_json(&self) -> Result<String, $crate::Error> {
                json::document($schema, self)
            }
        })*
    };
}
pub(super) use documents;

/// A JSON document over many lines.
pub(super) fn document(name: &'static str, value: &impl Serialize) -> Result<String, Error> {
    ended(name, serde_json::to_string_pretty(value))
}

/// A JSON document on one line.
pub(crate) fn line(name: &'static str, value: &impl Serialize) -> Result<String, Error> {
    ended(name, serde_json::to_string(value))
}

/// Writes a JSON document on one line, whole or not at all.
pub(super) fn write_line(name: &'static str, value: &impl Serialize, file: &Path) -> Result<(), Error> {
    let text = line(name, value)?;
    Ok(write_stream(file, |output| output.write_all(text.as_bytes()))?)
}

fn ended(document: &'static str, text: serde_json::Result<String>) -> Result<String, Error> {
    text.map(|text| escaped(text) + "\n").map_err(|source| Error::Json { document, source })
}

/// A number, or nothing in place of one that does not exist.
pub(super) fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

/// Degrees of freedom, or nothing where they are infinite.
pub(super) fn finite_degrees(degrees: Degrees) -> Option<f64> {
    match degrees {
        Degrees::Finite(nu) => Some(nu),
        Degrees::Infinite => None,
    }
}

/// A matrix row by row.
pub(super) fn rows(matrix: &Matrix3<f64>) -> [[f64; 3]; 3] {
    matrix.transpose().into()
}

/// One of several things, each with a word of its own.
pub(crate) trait Word: Copy + 'static {
    /// All of them.
    const ALL: &'static [Self];

    /// The word.
    fn word(self) -> &'static str;
}

/// Writes the word.
pub(crate) fn serialize<W: Word, S: Serializer>(thing: &W, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(thing.word())
}

/// Reads the word.
pub(crate) fn deserialize<'de, W: Word, D: Deserializer<'de>>(deserializer: D) -> Result<W, D::Error> {
    let found = String::deserialize(deserializer)?;
    W::ALL.iter().copied().find(|thing| thing.word() == found).ok_or_else(|| {
        let known: Vec<String> = W::ALL.iter().map(|thing| format!("{:?}", thing.word())).collect();
        D::Error::custom(format!("{found:?} where one of {} is due", known.join(", ")))
    })
}

impl Word for Group {
    const ALL: &'static [Self] = &Self::ALL;

    fn word(self) -> &'static str {
        self.name()
    }
}

impl Word for Source {
    const ALL: &'static [Self] = &Self::ALL;

    fn word(self) -> &'static str {
        self.name()
    }
}

impl Word for PairRelation {
    const ALL: &'static [Self] = &[Self::Common, Self::Opposite, Self::Free];

    fn word(self) -> &'static str {
        self.name()
    }
}

impl Word for ReferencePoint {
    const ALL: &'static [Self] = &[Self::FirstProofMass, Self::OwnAxes];

    fn word(self) -> &'static str {
        self.name()
    }
}

impl Word for Termination {
    const ALL: &'static [Self] = &[Self::Linear, Self::Converged, Self::Stalled, Self::IterationLimit];

    fn word(self) -> &'static str {
        match self {
            Self::Linear => "linear",
            Self::Converged => "converged",
            Self::Stalled => "stalled",
            Self::IterationLimit => "iteration limit",
        }
    }
}
