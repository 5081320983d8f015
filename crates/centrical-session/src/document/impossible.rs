//! Numbers in a document that cannot be what their keys say.

use serde_json::Value;

/// The first number of a document that its key rules out: a probability outside 0 to 1, or a negative uncertainty or chi^2. What was found, and
/// what was expected.
pub(super) fn impossible(name: &str, document: &Value) -> Option<(String, String)> {
    first(name, name, document)
}

/// The first one at `path`, under `key`.
fn first(path: &str, key: &str, value: &Value) -> Option<(String, String)> {
    match value {
        Value::Number(number) => {
            let number = number.as_f64()?;
            let found = || format!("{path} = {number:e}");
            if key.ends_with("probability") && !(0.0..=1.0).contains(&number) {
                Some((found(), "a probability from 0 to 1".to_owned()))
            } else if number < 0.0 && ["uncertainty", "chi_squared"].iter().any(|end| key.ends_with(end)) {
                Some((found(), "zero or more".to_owned()))
            } else {
                None
            }
        }
        Value::Array(values) => {
            values.iter().enumerate().find_map(|(n, value)| first(&format!("{path}[{n}]"), key, value))
        }
        Value::Object(entries) => entries.iter().find_map(|(key, value)| first(&format!("{path}.{key}"), key, value)),
        _ => None,
    }
}
