//! The languages of the documents: how each writes numbers, units and dates.

mod comparison;
mod english;
mod english_words;
mod live;
mod messages;
mod russian;
mod russian_words;
mod speeds;

use centrical_session::{Date, Symbol};

pub(crate) use self::comparison::ComparisonMessages;
use self::english::ENGLISH;
pub(crate) use self::english_words::next_rest_brings;
pub(crate) use self::live::LiveMessages;
pub(crate) use self::messages::Messages;
use self::russian::RUSSIAN;
use crate::number::{power_of_ten, scientific, shortest, significant, superscript, unsigned_zero, with_uncertainty};

/// A language of the documents.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Language {
    /// English: decimal point, ISO dates.
    #[default]
    English,
    /// Russian: decimal comma, dates as 05.10.2026, Russian symbols of units.
    Russian,
}

impl Language {
    /// Code of ISO 639-1.
    pub fn code(self) -> &'static str {
        match self {
            Self::English => "en",
            Self::Russian => "ru",
        }
    }

    /// Everything the documents say.
    pub(crate) fn messages(self) -> &'static Messages {
        match self {
            Self::English => &ENGLISH,
            Self::Russian => &RUSSIAN,
        }
    }

    /// What the live page says.
    pub(crate) fn live(self) -> &'static LiveMessages {
        match self {
            Self::English => &live::IN_ENGLISH,
            Self::Russian => &live::IN_RUSSIAN,
        }
    }

    /// What a comparison of results says.
    pub(crate) fn comparison(self) -> &'static ComparisonMessages {
        match self {
            Self::English => &comparison::IN_ENGLISH,
            Self::Russian => &comparison::IN_RUSSIAN,
        }
    }

    /// A number written with a point and a hyphen, as this language writes it.
    pub(crate) fn number(self, plain: &str) -> String {
        let number = plain.replace('-', "\u{2212}");
        match self {
            Self::English => number,
            Self::Russian => number.replace('.', ","),
        }
    }

    /// A number of a table for the terminal, as a page in this language has it: in English as on the terminal.
    pub(crate) fn plain(self, number: String) -> String {
        if self == Self::English { number } else { self.number(&number) }
    }

    /// The same of a unit.
    pub(crate) fn plain_unit(self, unit: &str) -> String {
        if self == Self::English { unit.to_owned() } else { self.unit(unit) }
    }

    /// A number to `places` decimal places.
    pub(crate) fn fixed(self, value: f64, places: usize) -> String {
        self.number(&unsigned_zero(format!("{value:.places$}")))
    }

    /// A probability to three places, a small one to two digits and a power of ten.
    pub(crate) fn probability(self, value: f64) -> String {
        match value {
            1e-3.. => self.fixed(value, 3),
            1e-300.. => self.with_power(scientific(value, 2)),
            _ => format!("< {}", self.with_power(scientific(1e-300, 1))),
        }
    }

    /// A number to `digits` significant digits, never in powers of ten.
    pub(crate) fn significant(self, value: f64, digits: u8) -> String {
        // No digits beyond those, before the point either.
        let rounded = format!("{value:.*e}", usize::from(digits.max(1)) - 1).parse().unwrap_or(value);
        self.number(&unsigned_zero(significant(rounded, digits, i32::MIN..i32::MAX)))
    }

    /// A number above zero to two digits: in powers of ten outside `1e-3` to `1e5`.
    pub(crate) fn two_digits(self, value: f64) -> String {
        if (1e-3..1e5).contains(&value) { self.significant(value, 2) } else { self.with_power(scientific(value, 2)) }
    }

    /// `1.5·10⁻⁵`, with the digits that the number has.
    pub(crate) fn scientific(self, value: f64) -> String {
        self.with_power(shortest(value))
    }

    fn with_power(self, (digits, power): (String, i32)) -> String {
        format!("{}·{}", self.number(&digits), power_of_ten(power))
    }

    /// `value ± uncertainty` to two digits of the uncertainty.
    pub(crate) fn plus_minus(self, value: f64, uncertainty: f64) -> String {
        let (value, uncertainty) = with_uncertainty(value, uncertainty);
        format!("{} ± {}", self.number(&value), self.number(&uncertainty))
    }

    /// `(value ± uncertainty)·10ⁿ` with a leading digit before the point.
    pub(crate) fn plus_minus_scientific(self, value: f64, uncertainty: f64) -> String {
        let power = shortest(value.abs().max(uncertainty)).1;
        if (-1..4).contains(&power) {
            return self.plus_minus(value, uncertainty);
        }
        let scale = 10_f64.powi(-power);
        format!("({})·{}", self.plus_minus(value * scale, uncertainty * scale), power_of_ten(power))
    }

    /// A unit as results and tables for the terminal name it.
    pub(crate) fn unit(self, plain: &str) -> String {
        let part = |name: &str| {
            let (stem, power) = name.split_once('^').unwrap_or((name, ""));
            let symbol = Symbol::of(stem).map(|symbol| match self {
                Self::English => symbol.english,
                Self::Russian => symbol.russian,
            });
            let raised = power.parse().map_or(String::new(), superscript);
            format!("{}{raised}", symbol.unwrap_or(stem))
        };
        let words = |text: &str| text.split(' ').map(part).collect::<Vec<_>>().join(" ");
        plain.split('/').map(words).collect::<Vec<_>>().join("/")
    }

    /// A day as a session writes it: a text that is not a day of ISO 8601 stays as it is.
    pub(crate) fn written_date(self, text: &str) -> String {
        text.parse().map_or_else(|_| text.to_owned(), |date| self.date(date))
    }

    /// A day.
    pub(crate) fn date(self, date: Date) -> String {
        match self {
            Self::English => date.to_string(),
            Self::Russian => format!("{:02}.{:02}.{:04}", date.day, date.month, date.year),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Language::{English, Russian};

    #[test]
    fn numbers_and_units_by_language() {
        assert_eq!(English.plus_minus(-3.952_149, 0.001_234), "−3.9521 ± 0.0012");
        assert_eq!(Russian.plus_minus(-3.952_149, 0.001_234), "−3,9521 ± 0,0012");
        assert_eq!(Russian.plus_minus_scientific(-1.6488e-6, 1.2e-9), "(−1,6488 ± 0,0012)·10⁻⁶");
        assert_eq!(Russian.scientific(1.5e-5), "1,5·10⁻⁵");
        assert_eq!([0.155, 1e-3, 0.0].map(|p| Russian.probability(p)), ["0,155", "0,001", "< 1·10⁻³⁰⁰"]);
        assert_eq!([9.99e-4, 1.3e-45].map(|p| English.probability(p)), ["1.0·10⁻³", "1.3·10⁻⁴⁵"]);
        assert_eq!([1234.5, 10_873.0].map(|x| English.significant(x, 2)), ["1200", "11000"]);
        assert_eq!(Russian.significant(0.012_345, 3), "0,0123");
        assert_eq!(
            [2.44e-5, 0.033, 39_000.0, 1.5e7].map(|x| English.two_digits(x)),
            ["2.4·10⁻⁵", "0.033", "39000", "1.5·10⁷"]
        );
        assert_eq!((English.unit("ug/g^2"), Russian.unit("ug/g^2")), ("µg/g²".to_owned(), "мкg/g²".to_owned()));
        assert_eq!(["2026-10-05", "October"].map(|day| Russian.written_date(day)), ["05.10.2026", "October"]);
        assert_eq!((Russian.fixed(-0.001, 2), Russian.fixed(-0.01, 2)), ("0,00".to_owned(), "−0,01".to_owned()));
        assert_eq!(Russian.unit("urad at 10 rev/s"), "мкрад при 10 об/с");
        assert_eq!((English.unit("s^4/m^2"), Russian.unit("s^4/m^2")), ("s⁴/m²".to_owned(), "с⁴/м²".to_owned()));
    }
}
