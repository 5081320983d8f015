//! Entries that may be written in more than one way.

use std::fmt;

use centrical_table::ColumnName;
use schemars::JsonSchema;
use serde::Deserialize;
use serde::de::{self, Deserializer, IntoDeserializer, MapAccess, SeqAccess, Visitor};

use crate::quantity::{Quantity, QuantityVisitor};

/// A preset's name, or a list of terms.
#[derive(Debug)]
pub(crate) struct TermList(pub Vec<TermEntry>);

/// A preset's or a coefficient's name, or a term in full.
#[derive(Debug)]
pub(crate) enum TermEntry {
    Named(String),
    Written(TermTable),
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct TermTable {
    /// The newtonometer whose reading has the term: 1, 2 or 3.
    pub axis: usize,
    /// The term, such as "f1*f2" or "f2*|f2|".
    pub term: String,
}

/// Values one by one, or at equal steps.
#[derive(Debug)]
pub(crate) enum Steps {
    List(Vec<Quantity>),
    Range(StepsTable),
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct StepsTable {
    /// The first value.
    pub from: Quantity,
    /// The last value.
    pub to: Quantity,
    /// Number of values.
    pub count: usize,
}

/// The path of a record, or of three: one for each newtonometer.
#[derive(Debug)]
pub(crate) struct RecordEntry(pub Vec<String>);

/// Attitudes of rests: where up is, in axes of the case.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum AttitudeList {
    /// `cube`, or the path of a table.
    Named(String),
    /// Directions of any length.
    Listed(Vec<[f64; 3]>),
}

impl<'de> Deserialize<'de> for AttitudeList {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct ListVisitor;
        impl<'de> Visitor<'de> for ListVisitor {
            type Value = AttitudeList;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(
                    "\"cube\", the path of a table of attitudes, or a list of directions of up such as [0, 0, 1]",
                )
            }

            fn visit_str<E: de::Error>(self, name: &str) -> Result<AttitudeList, E> {
                Ok(AttitudeList::Named(name.to_owned()))
            }

            fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<AttitudeList, A::Error> {
                Vec::deserialize(de::value::SeqAccessDeserializer::new(list)).map(AttitudeList::Listed)
            }
        }
        deserializer.deserialize_any(ListVisitor)
    }
}

impl<'de> Deserialize<'de> for RecordEntry {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct EntryVisitor;
        impl<'de> Visitor<'de> for EntryVisitor {
            type Value = RecordEntry;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("the path of a record, or three paths, one for each newtonometer")
            }

            fn visit_str<E: de::Error>(self, path: &str) -> Result<RecordEntry, E> {
                Ok(RecordEntry(vec![path.to_owned()]))
            }

            fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<RecordEntry, A::Error> {
                let paths = Vec::<String>::deserialize(de::value::SeqAccessDeserializer::new(list))?;
                if paths.len() == 3 {
                    Ok(RecordEntry(paths))
                } else {
                    Err(de::Error::invalid_length(paths.len(), &self))
                }
            }
        }
        deserializer.deserialize_any(EntryVisitor)
    }
}

/// A column by name or number, or in full.
#[derive(Debug)]
pub(crate) struct ColumnEntry(pub ColumnTable);

#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct ColumnTable {
    /// Its name, or its number from 1.
    pub column: Option<ColumnLabel>,
    /// The column of dates, where this one has times of the day.
    pub date: Option<ColumnLabel>,
    /// Unit of its numbers.
    pub unit: Option<String>,
    /// Samples per second, where the column counts samples.
    pub rate: Option<Quantity>,
}

/// A column by its name or by its number from 1.
#[derive(Debug)]
pub(crate) struct ColumnLabel(pub ColumnName);

/// A prior: a standard uncertainty about zero, or about a mean.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct PriorValue {
    pub mean: Option<Quantity>,
    pub standard_uncertainty: Quantity,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct PriorTable {
    /// The measured mean.
    mean: Quantity,
    /// Its standard uncertainty.
    standard_uncertainty: Quantity,
}

impl<'de> Deserialize<'de> for PriorValue {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct PriorVisitor;
        impl<'de> Visitor<'de> for PriorVisitor {
            type Value = PriorValue;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a standard uncertainty, or { mean = ..., standard_uncertainty = ... }")
            }

            fn visit_str<E: de::Error>(self, text: &str) -> Result<PriorValue, E> {
                about_zero(QuantityVisitor.visit_str(text))
            }

            fn visit_i64<E: de::Error>(self, number: i64) -> Result<PriorValue, E> {
                about_zero(QuantityVisitor.visit_i64(number))
            }

            fn visit_f64<E: de::Error>(self, number: f64) -> Result<PriorValue, E> {
                about_zero(QuantityVisitor.visit_f64(number))
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<PriorValue, A::Error> {
                let PriorTable { mean, standard_uncertainty } =
                    PriorTable::deserialize(de::value::MapAccessDeserializer::new(map))?;
                Ok(PriorValue { mean: Some(mean), standard_uncertainty })
            }
        }
        deserializer.deserialize_any(PriorVisitor)
    }
}

fn about_zero<E>(standard_uncertainty: Result<Quantity, E>) -> Result<PriorValue, E> {
    Ok(PriorValue { mean: None, standard_uncertainty: standard_uncertainty? })
}

/// A date as TOML has it, or any text.
pub(crate) fn date_as_text<'de, D: Deserializer<'de>>(deserializer: D) -> Result<String, D::Error> {
    struct DateVisitor;
    impl<'de> Visitor<'de> for DateVisitor {
        type Value = String;

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            f.write_str("a date such as 2026-10-05 or a string")
        }

        fn visit_str<E: de::Error>(self, text: &str) -> Result<String, E> {
            Ok(text.to_owned())
        }

        fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<String, A::Error> {
            let date = toml::value::Datetime::deserialize(de::value::MapAccessDeserializer::new(map))?;
            Ok(date.to_string())
        }
    }
    deserializer.deserialize_any(DateVisitor)
}

/// A name: `"1"`, or `1` for short.
pub(crate) fn name_or_number<'de, D: Deserializer<'de>>(deserializer: D) -> Result<String, D::Error> {
    struct NameVisitor;
    impl Visitor<'_> for NameVisitor {
        type Value = String;

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            f.write_str("a name such as \"1\"")
        }

        fn visit_str<E: de::Error>(self, text: &str) -> Result<String, E> {
            Ok(text.to_owned())
        }

        fn visit_i64<E: de::Error>(self, number: i64) -> Result<String, E> {
            Ok(number.to_string())
        }
    }
    deserializer.deserialize_any(NameVisitor)
}

impl<'de> Deserialize<'de> for ColumnLabel {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct LabelVisitor;
        impl Visitor<'_> for LabelVisitor {
            type Value = ColumnLabel;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("the name of a column, or its number from 1")
            }

            fn visit_str<E: de::Error>(self, name: &str) -> Result<ColumnLabel, E> {
                Ok(ColumnLabel(ColumnName::Name(name.to_owned())))
            }

            fn visit_i64<E: de::Error>(self, number: i64) -> Result<ColumnLabel, E> {
                let number = usize::try_from(number).ok().filter(|n| *n > 0);
                let number = number.ok_or_else(|| E::custom("the number of a column is counted from 1"))?;
                Ok(ColumnLabel(ColumnName::Number(number)))
            }
        }
        deserializer.deserialize_any(LabelVisitor)
    }
}

impl<'de> Deserialize<'de> for ColumnEntry {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct EntryVisitor;
        impl<'de> Visitor<'de> for EntryVisitor {
            type Value = ColumnEntry;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("the name of a column, its number from 1, or { column = \"f1\", unit = \"mg\" }")
            }

            fn visit_str<E: de::Error>(self, name: &str) -> Result<ColumnEntry, E> {
                ColumnLabel::deserialize(name.into_deserializer()).map(ColumnEntry::from)
            }

            fn visit_i64<E: de::Error>(self, number: i64) -> Result<ColumnEntry, E> {
                ColumnLabel::deserialize(number.into_deserializer()).map(ColumnEntry::from)
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<ColumnEntry, A::Error> {
                ColumnTable::deserialize(de::value::MapAccessDeserializer::new(map)).map(ColumnEntry)
            }
        }
        deserializer.deserialize_any(EntryVisitor)
    }
}

impl From<ColumnLabel> for ColumnEntry {
    fn from(label: ColumnLabel) -> Self {
        Self(ColumnTable { column: Some(label), ..ColumnTable::default() })
    }
}

impl<'de> Deserialize<'de> for TermList {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct ListVisitor;
        impl<'de> Visitor<'de> for ListVisitor {
            type Value = TermList;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("\"kozlov-2017\" or a list of terms such as { axis = 1, term = \"f1*f2\" }")
            }

            fn visit_str<E: de::Error>(self, name: &str) -> Result<TermList, E> {
                Ok(TermList(vec![TermEntry::Named(name.to_owned())]))
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<TermList, A::Error> {
                let mut entries = Vec::new();
                while let Some(entry) = list.next_element()? {
                    entries.push(entry);
                }
                Ok(TermList(entries))
            }
        }
        deserializer.deserialize_any(ListVisitor)
    }
}

impl<'de> Deserialize<'de> for TermEntry {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct EntryVisitor;
        impl<'de> Visitor<'de> for EntryVisitor {
            type Value = TermEntry;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("\"kozlov-2017\", the name of one of its terms, or { axis = 1, term = \"f1*f2\" }")
            }

            fn visit_str<E: de::Error>(self, name: &str) -> Result<TermEntry, E> {
                Ok(TermEntry::Named(name.to_owned()))
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<TermEntry, A::Error> {
                TermTable::deserialize(de::value::MapAccessDeserializer::new(map)).map(TermEntry::Written)
            }
        }
        deserializer.deserialize_any(EntryVisitor)
    }
}

impl<'de> Deserialize<'de> for Steps {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct StepsVisitor;
        impl<'de> Visitor<'de> for StepsVisitor {
            type Value = Steps;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(
                    "a list of quantities, or equal steps such as { from = \"5 g\", to = \"200 g\", count = 8 }",
                )
            }

            fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<Steps, A::Error> {
                Vec::deserialize(de::value::SeqAccessDeserializer::new(list)).map(Steps::List)
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Steps, A::Error> {
                StepsTable::deserialize(de::value::MapAccessDeserializer::new(map)).map(Steps::Range)
            }
        }
        deserializer.deserialize_any(StepsVisitor)
    }
}
