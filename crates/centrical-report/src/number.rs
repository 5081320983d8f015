//! Numbers in decimal digits, as tables, documents and plots show them.

use std::ops::Range;

/// Seconds in a minute.
pub(crate) const MINUTE: f64 = 60.0;

/// A number in another unit, to ten significant digits: the digits beyond them are those of the conversion.
pub(crate) fn converted(value: f64) -> f64 {
    format!("{value:.9e}").parse().unwrap_or(value)
}

/// A positive number cut to `digits` significant digits, without zeros at its end: what holds up to it holds up to this one.
pub(crate) fn rounded_down(value: f64, digits: u8) -> String {
    let value = converted(value);
    let (shown, power) = scientific(value, digits.into());
    let rounded: f64 = format!("{shown}e{power}").parse().unwrap_or(value);
    let step: f64 = format!("1e{}", power + 1 - i32::from(digits)).parse().unwrap_or(0.0);
    let cut = if rounded > value { rounded - step } else { rounded };
    converted(cut).to_string()
}

/// Digits and power of ten of a number rounded to `digits` significant digits: 0.0996 to two is `1.0`, -1.
pub(crate) fn scientific(value: f64, digits: usize) -> (String, i32) {
    parts(format!("{value:.*e}", digits.saturating_sub(1)))
}

/// The same with the digits that the number has.
pub(crate) fn shortest(value: f64) -> (String, i32) {
    parts(format!("{value:e}"))
}

fn parts(scientific: String) -> (String, i32) {
    let parsed = scientific.split_once('e').and_then(|(digits, power)| Some((digits.to_owned(), power.parse().ok()?)));
    // What is not finite has no power.
    parsed.unwrap_or((scientific, 0))
}

/// A value and its uncertainty, both to the place of the uncertainty's second significant digit (GUM, 7.2.6); a zero has
/// no sign.
pub fn with_uncertainty(value: f64, uncertainty: f64) -> (String, String) {
    let is_size = uncertainty.is_finite() && uncertainty > 0.0;
    if !is_size {
        return (unsigned_zero(format!("{value:.6}")), format!("{uncertainty:.6}"));
    }
    let places = places(uncertainty, 2);
    // Above a hundred the second digit stands before the point.
    let step = 10_f64.powi((scientific(uncertainty, 2).1 - 1).max(0));
    let shown = |x: f64| unsigned_zero(format!("{:.places$}", (x / step).round_ties_even() * step));
    if step > 1.0 {
        (shown(value), shown(uncertainty))
    } else {
        (unsigned_zero(format!("{value:.places$}")), format!("{uncertainty:.places$}"))
    }
}

/// An uncertainty to two significant digits, as [`with_uncertainty`] shows it beside a value: `0.0020`, `12000`; in powers of
/// ten outside `1e-4` to `1e6`.
pub(crate) fn two_digits(uncertainty: f64) -> String {
    let exponent = scientific(uncertainty, 2).1;
    match uncertainty {
        _ if !uncertainty.is_finite() => uncertainty.to_string(),
        0.0 => "0".to_owned(),
        _ if !(-4..6).contains(&exponent) => format!("{uncertainty:.1e}"),
        _ if uncertainty < 0.0 => format!("-{}", with_uncertainty(0.0, -uncertainty).1),
        _ => with_uncertainty(0.0, uncertainty).1,
    }
}

/// A count with its noun: `1 plateau`, `2 plateaus`.
pub fn counted(count: impl TryInto<u64>, noun: &str) -> String {
    match count.try_into() {
        Ok(1) => format!("1 {noun}"),
        Ok(count) => format!("{count} {noun}s"),
        Err(_) => format!("many {noun}s"),
    }
}

/// A number without the sign of a zero: `-0.00` is `0.00`.
pub(crate) fn unsigned_zero(shown: String) -> String {
    let is_zero = shown.starts_with('-') && !shown.contains(|c: char| c.is_alphabetic() || ('1'..='9').contains(&c));
    if is_zero { shown.trim_start_matches('-').to_owned() } else { shown }
}

/// A whole number in groups of three digits from the right, a narrow space that does not break between (ISO 80000-1, 7.3.1);
/// of four digits together.
pub(crate) fn grouped(number: u64) -> String {
    const GROUP: usize = 3;
    let digits = number.to_string();
    if digits.len() <= GROUP + 1 {
        return digits;
    }
    let groups = digits.as_bytes().rchunks(GROUP).rev();
    groups.map(String::from_utf8_lossy).collect::<Vec<_>>().join("\u{202f}")
}

/// Decimal places that show `digits` significant digits of a number.
fn places(value: f64, digits: u8) -> usize {
    let exponent = scientific(value, digits.into()).1;
    usize::try_from(i32::from(digits) - 1 - exponent).unwrap_or(0)
}

/// A number to `digits` significant digits, with an exponent where its leading digit is outside `plain` powers of ten.
pub(crate) fn significant(value: f64, digits: u8, plain: Range<i32>) -> String {
    let exponent = scientific(value, digits.into()).1;
    if plain.contains(&exponent) {
        format!("{value:.*}", places(value, digits))
    } else {
        format!("{value:.*e}", usize::from(digits) - 1)
    }
}

/// Three significant digits, without an exponent where that is shorter.
pub(crate) fn digits(value: f64) -> String {
    if value == 0.0 { "0".to_owned() } else { significant(value, 3, -3..5) }
}

/// `10` with its exponent raised; plain numbers near 1.
pub(crate) fn power_of_ten(exponent: i32) -> String {
    match exponent {
        0 => "1".to_owned(),
        1 => "10".to_owned(),
        _ => format!("10{}", superscript(exponent)),
    }
}

/// A whole number raised.
pub(crate) fn superscript(number: i32) -> String {
    number.to_string().chars().map(raised).collect()
}

/// A digit or a minus raised.
pub(crate) fn raised(symbol: char) -> char {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    symbol.to_digit(10).map_or('⁻', |digit| DIGITS[digit as usize])
}

#[cfg(test)]
mod tests {
    use super::{converted, counted, grouped, rounded_down, significant, two_digits, with_uncertainty};

    #[test]
    fn two_digits_of_the_uncertainty() {
        let shown = |v, u| {
            let (value, uncertainty) = with_uncertainty(v, u);
            format!("{value} ± {uncertainty}")
        };
        assert_eq!(shown(-3.952_149, 0.001_234), "-3.9521 ± 0.0012");
        assert_eq!(shown(744.294, 0.0996), "744.29 ± 0.10");
        assert_eq!(shown(12345.6, 123.0), "12350 ± 120");
        assert_eq!(shown(-2e5, 26.0), "-200000 ± 26");
        assert_eq!(shown(-40.0, 1234.0), "0 ± 1200");
        assert_eq!(shown(1.0, 9.96), "1 ± 10");
        assert_eq!(shown(-0.3, 40.0), "0 ± 40");
        assert_eq!(shown(-0.04, 3.0), "0.0 ± 3.0");
        assert_eq!(shown(f64::NAN, 3.0), "NaN ± 3.0");
    }

    #[test]
    fn an_uncertainty_alone_has_the_digits_that_it_has_beside_a_value() {
        let numbers = [0.001_96, 0.0996, 9.96, 26.0, 12_345.6, -40.4, 0.0, 3.21e-9, 1.55e7];
        let shown = ["0.0020", "0.10", "10", "26", "12000", "-40", "0", "3.2e-9", "1.6e7"];
        assert_eq!(numbers.map(two_digits), shown);
        assert_eq!([f64::NAN, f64::INFINITY].map(two_digits), ["NaN", "inf"]);
    }

    #[test]
    fn a_conversion_adds_no_digits() {
        assert_eq!([1e6 * 2e-7, 3e-3 * 9.80665 / 9.80665e-6].map(converted), [0.2, 3000.0]);
        assert_eq!(converted(1e6 * 1.234_567_8e-5), 12.345_678);
    }

    #[test]
    fn a_range_is_cut_not_rounded() {
        let cut = [525.985, 199.999, 1e3, 0.098_76, 9.8066].map(|value| rounded_down(value, 3));
        assert_eq!(cut, ["525", "199", "1000", "0.0987", "9.8"]);
        assert_eq!([200.0, 411.123_456].map(|value| rounded_down(value * (1.0 - 1e-15), 5)), ["200", "411.12"]);
    }

    #[test]
    fn one_is_singular() {
        assert_eq!([0, 1, 2].map(|n| counted(n, "plateau")), ["0 plateaus", "1 plateau", "2 plateaus"]);
    }

    #[test]
    fn long_numbers_have_groups() {
        assert_eq!([108, 1234, 105_893].map(grouped), ["108", "1234", "105\u{202f}893"]);
    }

    #[test]
    fn digits_are_those_of_the_rounded_number() {
        let numbers = [9.9996, 9.9994, 0.012_345, 123_456.0, 1.2e-7, 0.0];
        let shown: Vec<String> = numbers.map(|v| significant(v, 4, -4..7)).into();
        assert_eq!(shown, ["10.00", "9.999", "0.01235", "123456", "1.200e-7", "0.000"]);
    }
}
