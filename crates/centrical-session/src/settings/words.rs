//! What a parser says, in words of the file.

/// `invalid type: string "x", expected a number` as `found string "x", expected a number`, and so on.
pub(super) fn found_and_expected(sentence: &str, expected: &str) -> String {
    let quoted_name = |rest: &str| rest.strip_prefix('`').and_then(|rest| rest.split('`').next()).map(str::to_owned);
    if let Some(name) = sentence.strip_prefix("missing field ").and_then(quoted_name) {
        return format!("found no key `{name}`, expected one");
    }
    if let Some(name) = sentence.strip_prefix("duplicate field ").and_then(quoted_name) {
        return format!("found the key `{name}` twice, expected it once");
    }
    if let Some(rest) = sentence.strip_prefix("unknown field ") {
        let rest = rest.replace(", there are no fields", ", expected none");
        return format!("found an unknown key {rest}");
    }
    for start in ["invalid type: ", "invalid value: ", "unknown variant "] {
        if let Some(rest) = sentence.strip_prefix(start) {
            return format!("found {}", in_words(rest));
        }
    }
    if let Some(rest) = sentence.strip_prefix("invalid length ") {
        return format!("found a length of {}", in_words(rest));
    }
    if sentence.contains(", expected ") {
        let start = if sentence.starts_with("found ") { "" } else { "found " };
        return format!("{start}{sentence}");
    }
    format!("found text with a fault ({sentence}), expected {expected}")
}

const TABLE: &str = "a table of keys and values";
const LIST: &str = "a list of values";

/// What was found and expected, without the names that types have in the program.
fn in_words(sentence: &str) -> String {
    let Some((found, expected)) = sentence.rsplit_once(", expected ") else { return sentence.to_owned() };
    let found = match found {
        "map" => TABLE,
        "sequence" => LIST,
        _ => found,
    };
    let expected = match expected {
        "a map" => TABLE,
        "a sequence" => LIST,
        _ => match expected.split(' ').next().unwrap_or_default() {
            "struct" => TABLE,
            "f32" | "f64" => "a number",
            "u8" | "u16" | "u32" | "u64" | "usize" => "a whole number, zero or more",
            "i8" | "i16" | "i32" | "i64" | "isize" => "a whole number",
            _ => expected,
        },
    };
    format!("{found}, expected {expected}")
}
