//! Units as headers and rows of units write them, in one spelling each.

use super::encoding::TextEncoding;

/// A unit in the spelling of settings, and how files spell it, in lower case.
const WORDS: [(&str, &[&str]); 27] = [
    ("s", &["s", "sec", "secs", "second", "seconds", "с", "сек", "секунды"]),
    ("ms", &["ms", "msec", "мс", "мсек"]),
    ("us", &["us", "µs", "usec", "мкс"]),
    ("ns", &["ns", "нс"]),
    ("min", &["min", "мин"]),
    ("h", &["h", "ч", "час"]),
    ("m/s^2", &["m/s^2", "m/s2", "m/s²", "m/s**2", "m s^-2", "m·s^-2", "m/sec^2", "м/с^2", "м/с2", "м/с²"]),
    ("mm/s^2", &["mm/s^2", "mm/s2", "mm/s²", "мм/с^2", "мм/с2", "мм/с²"]),
    ("g", &["g", "g_n", "gn"]),
    ("mg", &["mg", "мg"]),
    ("ug", &["ug", "µg", "мкg"]),
    ("Gal", &["gal", "гал"]),
    ("mGal", &["mgal", "мгал"]),
    ("V", &["v", "volt", "volts", "в", "вольт"]),
    ("mV", &["mv", "millivolt", "millivolts", "мв"]),
    ("uV", &["uv", "µv", "мкв"]),
    ("counts", &["counts", "count", "cts", "lsb", "adc", "digits", "отсчеты", "отсчёты", "ед. ацп"]),
    ("rad/s", &["rad/s", "rad/sec", "рад/с"]),
    ("deg/s", &["deg/s", "°/s", "deg/sec", "dps", "град/с", "°/с"]),
    ("rpm", &["rpm", "rev/min", "1/min", "об/мин"]),
    ("rev/s", &["rev/s", "rps", "об/с"]),
    ("Hz", &["hz", "гц"]),
    ("degC", &["degc", "°c", "deg c", "°с"]),
    ("samples", &["samples", "sample", "отсчет", "отсчёт"]),
    ("rad", &["rad", "рад"]),
    ("deg", &["deg", "°", "град"]),
    ("m^2/s^4", &["m^2/s^4", "m2/s4", "m²/s⁴", "м^2/с^4", "м²/с⁴"]),
];

/// The unit that a word of a file names, `1/min`, `[м/с²]`, with or without brackets, in the spelling of settings.
pub fn unit_of_word(text: &str) -> Option<&'static str> {
    let text = without_brackets(text.trim()).to_lowercase().replace('μ', "µ");
    WORDS.iter().find(|(_, spellings)| spellings.contains(&text.as_str())).map(|(unit, _)| *unit)
}

/// A name with the unit behind it, `f1 [g]`, `t (s)` or `f1, g`: the unit, in the spelling of settings.
pub fn unit_beside_name(text: &str) -> Option<&'static str> {
    name_and_unit(text).map(|(_, unit)| unit)
}

/// The unit that bytes of a file name in any encoding: a row of units is too short to show which it is.
pub(super) fn unit_in_any(text: &[u8]) -> Option<&'static str> {
    let encodings = [TextEncoding::Utf8].into_iter().chain(TextEncoding::OF_BYTES);
    encodings.into_iter().find_map(|encoding| unit_of_word(&encoding.decode(text)))
}

/// A name with the unit behind it, `f1 [g]`, `t (s)` or `f1, g`: the name and the unit.
pub(super) fn name_and_unit(text: &str) -> Option<(&str, &'static str)> {
    let text = text.trim();
    let begin = match text.chars().next_back()? {
        ']' => text.rfind('[')?,
        ')' => text.rfind('(')?,
        _ => text.rfind(',')?,
    };
    let (name, rest) = text.split_at(begin);
    Some((name.trim_end(), unit_of_word(rest.strip_prefix(',').unwrap_or(rest))?))
}

fn without_brackets(text: &str) -> &str {
    let inner = |[open, close]: [char; 2]| text.strip_prefix(open).and_then(|rest| rest.strip_suffix(close));
    [['[', ']'], ['(', ')'], ['<', '>']].into_iter().find_map(inner).unwrap_or(text).trim()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_of_files() {
        let cases = [
            ("[V]", Some("V")),
            ("(m/s²)", Some("m/s^2")),
            (" g ", Some("g")),
            ("м/с²", Some("m/s^2")),
            ("Volts", Some("V")),
            ("μs", Some("us")),
            ("1.5", None),
            ("NaN", None),
            ("", None),
            ("text", None),
        ];
        for (text, expected) in cases {
            assert_eq!(unit_of_word(text), expected, "{text}");
            for encoding in [encoding_rs::WINDOWS_1251, encoding_rs::WINDOWS_1252] {
                let (bytes, _, is_lossy) = encoding.encode(text);
                assert!(is_lossy || unit_in_any(&bytes) == expected, "{text}");
            }
        }
    }

    #[test]
    fn names_with_units() {
        let cases = [
            ("f1 [g]", Some(("f1", "g"))),
            ("Время, с", Some(("Время", "s"))),
            ("t(ms)", Some(("t", "ms"))),
            ("f1 [old]", None),
            ("f1", None),
            ("a)", None),
        ];
        for (text, expected) in cases {
            assert_eq!(name_and_unit(text), expected, "{text}");
        }
    }
}
