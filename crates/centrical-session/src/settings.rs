//! Settings and JSON documents from their text, and what is wrong with one in words of the file and not of its parser.

mod strict;
mod words;

use std::path::Path;

use centrical_table::{Source, cut};
use serde::de::DeserializeOwned;
use toml_edit::{DocumentMut, Item, TableLike, Value};

use self::strict::Strict;
use self::words::found_and_expected;
use crate::error::{Error, Place};

/// Largest file of settings [bytes]: thousands of mountings fit; more is another kind of file.
const LARGEST_SETTINGS: u64 = 16 << 20;

/// Largest result, state or history [bytes]: those of ten thousand plateaus fit.
const LARGEST_DOCUMENT: u64 = 128 << 20;

/// Characters that a message shows of what was found.
const LONGEST_SENTENCE: usize = 200;

/// The text of a file of settings, which should be what `expected` says.
pub(crate) fn read_settings(file: &Path, expected: &str) -> Result<String, Error> {
    settings_of(&Source::open(file, expected)?, expected)
}

/// The same of a source.
pub(crate) fn settings_of(source: &Source, expected: &str) -> Result<String, Error> {
    Ok(source.text(LARGEST_SETTINGS, expected)?)
}

/// The text of a result, a state or a history.
pub(crate) fn read_result(file: &Path, expected: &str) -> Result<String, Error> {
    Ok(Source::open(file, expected)?.text(LARGEST_DOCUMENT, expected)?)
}

/// Settings from the text of `file`.
pub(crate) fn from_toml<T: DeserializeOwned>(file: &Path, text: &str) -> Result<T, Error> {
    let read = toml::Deserializer::parse(text).and_then(|file| T::deserialize(Strict(file)));
    read.map_err(|error| {
        let place = error.span().map_or(Place::Whole, |span| Place::of_byte(text, span.start));
        form_error(file, place, error.message(), "TOML as the form of this file says")
    })
}

/// Settings as they are edited: with comments and order.
pub(crate) fn editable(file: &Path, text: &str) -> Result<DocumentMut, Error> {
    text.parse().map_err(|error: toml_edit::TomlError| {
        let place = error.span().map_or(Place::Whole, |span| Place::of_byte(text, span.start));
        form_error(file, place, error.message(), "TOML")
    })
}

/// The tables of an array, in either form of TOML.
pub(crate) fn tables_of<'a>(document: &'a mut DocumentMut, name: &str) -> Vec<&'a mut dyn TableLike> {
    match document.get_mut(name) {
        Some(Item::ArrayOfTables(tables)) => tables.iter_mut().map(|table| table as &mut dyn TableLike).collect(),
        Some(Item::Value(Value::Array(list))) => {
            let tables = list.iter_mut().filter_map(Value::as_inline_table_mut);
            tables.map(|table| table as &mut dyn TableLike).collect()
        }
        _ => Vec::new(),
    }
}

/// A text in quotes, as settings have it.
pub(crate) fn toml_text(text: &str) -> String {
    Value::from(text).to_string().trim().to_owned()
}

/// A JSON document, which should be what `expected` says; `line` is the number of its first line in the file.
pub(crate) fn from_json<T: DeserializeOwned>(file: &Path, line: usize, text: &str, expected: &str) -> Result<T, Error> {
    serde_json::from_str(text).map_err(|error| {
        let place = Place::Character { line: line + error.line().max(1) - 1, column: error.column() };
        json_error(file, place, &error, expected)
    })
}

/// A JSON document that stands under a key of settings.
pub(crate) fn from_json_under<T: DeserializeOwned>(
    file: &Path,
    key: &str,
    text: &str,
    expected: &str,
) -> Result<T, Error> {
    let place = || Place::Key { table: String::new(), key: key.to_owned() };
    serde_json::from_str(text).map_err(|error| json_error(file, place(), &error, expected))
}

/// What the parser of JSON says, without its place in the text.
fn json_error(file: &Path, place: Place, error: &serde_json::Error, expected: &str) -> Error {
    let sentence = error.to_string();
    form_error(file, place, sentence.split(" at line ").next().unwrap_or_default(), expected)
}

/// What a parser says, as what was found and what was expected.
fn form_error(file: &Path, place: Place, sentence: &str, expected: &str) -> Error {
    let sentence = sentence.trim().replace('\n', ", ");
    let message = found_and_expected(&sentence, expected);
    // What is expected stays whole, however long the value is that was found.
    let message = match message.rsplit_once(", expected ") {
        Some((found, expected)) => format!("{}, expected {expected}", cut(found, LONGEST_SENTENCE)),
        None => cut(&message, LONGEST_SENTENCE).into_owned(),
    };
    Error::Form { file: file.to_owned(), place, message }
}
