//! The words that documents write for what is one of several: reading and writing them by name.

use centrical::Source;
use centrical::{Group, PairRelation, ReferencePoint, Termination};
use serde::de::{Deserialize, Deserializer, Error as _};
use serde::ser::Serializer;

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
