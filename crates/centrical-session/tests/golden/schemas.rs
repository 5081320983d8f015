//! The schemas of the forms accept what the program reads and refuse what its parser refuses.

use std::fs;
use std::path::Path;

use centrical_session::{SettingsForm, settings_schema};
use jsonschema::Validator;
use serde_json::Value;

use crate::sample::EXPERIMENT;

/// Places of messages that come from the parser of a form, and not from what is read in it.
const OF_PARSER: &str = "line ";

fn validator(form: SettingsForm) -> Validator {
    let schema: Value = serde_json::from_str(&settings_schema(form).unwrap()).unwrap();
    jsonschema::draft7::new(&schema).unwrap()
}

/// The text as an editor hands it to a validator: dates as text. `None` if it is not TOML.
fn value(text: &str) -> Option<Value> {
    fn json(value: toml::Value) -> Value {
        match value {
            toml::Value::Datetime(date) => Value::String(date.to_string()),
            toml::Value::Array(list) => Value::Array(list.into_iter().map(json).collect()),
            toml::Value::Table(table) => Value::Object(table.into_iter().map(|(k, v)| (k, json(v))).collect()),
            toml::Value::String(text) => Value::String(text),
            toml::Value::Integer(number) => number.into(),
            // JSON has no nan: as a text it is not a number either.
            toml::Value::Float(number) => {
                serde_json::Number::from_f64(number).map_or_else(|| Value::String(number.to_string()), Value::Number)
            }
            toml::Value::Boolean(truth) => Value::Bool(truth),
        }
    }
    toml::from_str::<toml::Table>(text).ok().map(|table| json(toml::Value::Table(table)))
}

/// A message with a line comes from the parser: then the schema refuses the text as well, unless it is not TOML at all.
pub fn refuses_what_the_parser_refuses(form: SettingsForm, text: &str, message: &str) {
    if message.starts_with(OF_PARSER)
        && let Some(value) = value(text)
    {
        assert!(!validator(form).is_valid(&value), "the schema accepts what the parser refuses: {message}");
    }
}

fn assert_accepted(form: SettingsForm, name: &str, text: &str) {
    let errors: Vec<String> =
        validator(form).iter_errors(&value(text).unwrap()).map(|e| format!("{}: {e}", e.instance_path())).collect();
    assert!(errors.is_empty(), "{name}: {errors:?}");
}

#[test]
fn every_example_is_accepted() {
    use SettingsForm::{Experiment, Laboratory, Plan, Truth};
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut count = 0;
    for (folder, form) in [("examples/ta-200", Experiment), ("examples/plans", Plan), ("examples/03_plan", Plan)] {
        for entry in fs::read_dir(root.join(folder)).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            if path.extension().is_none_or(|extension| extension != "toml") {
                continue;
            }
            let form = match name.as_str() {
                "truth.toml" => Truth,
                "laboratory.toml" => Laboratory,
                _ => form,
            };
            assert_accepted(form, &name, &fs::read_to_string(&path).unwrap());
            count += 1;
        }
    }
    assert!(count >= 6, "only {count} files");
    assert_accepted(Experiment, "the sample", EXPERIMENT);
    assert_accepted(Truth, "benches", &fs::read_to_string(root.join("benches/records/truth.toml")).unwrap());
}

/// Keys carry a sentence that an editor shows.
#[test]
fn every_key_of_an_experiment_is_described() {
    let schema: Value = serde_json::from_str(&settings_schema(SettingsForm::Experiment).unwrap()).unwrap();
    let tables = schema["definitions"].as_object().unwrap().values().chain([&schema]);
    let mut keys = 0;
    for properties in tables.filter_map(|table| table["properties"].as_object()) {
        for (key, property) in properties {
            let described = property["description"].is_string() || property["$ref"].is_string();
            assert!(described, "{key} is not described");
            keys += 1;
        }
    }
    assert!(keys > 60, "only {keys} keys");
}
