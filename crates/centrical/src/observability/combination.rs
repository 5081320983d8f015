//! Linear combinations of parameters, as people write them: `dR_2[A] + dR_1[B] - 2 drho_22`.

use thiserror::Error;

use crate::model::Parameters;

/// A linear combination of parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Combination {
    terms: Vec<(usize, f64)>,
}

/// Why a text is not a linear combination.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("combination, character {at}: found {found}, expected {expected}")]
pub struct CombinationError {
    /// Place in the text, in characters from 1.
    pub at: usize,
    /// What stands there.
    pub found: String,
    /// What should stand there.
    pub expected: String,
}

impl Combination {
    /// The combination with a coefficient for each of the given parameters; several on one parameter add up.
    pub fn new(terms: impl IntoIterator<Item = (usize, f64)>) -> Self {
        let mut sums: Vec<(usize, f64)> = Vec::new();
        for (j, coefficient) in terms {
            match sums.iter_mut().find(|(index, _)| *index == j) {
                Some((_, sum)) => *sum += coefficient,
                None => sums.push((j, coefficient)),
            }
        }
        sums.retain(|(_, coefficient)| *coefficient != 0.0);
        Self { terms: sums }
    }

    /// Reads a sum of parameters with numbers before them, with or without `*`.
    ///
    /// # Errors
    /// [`CombinationError`] with the place, when the text is not such a sum.
    pub fn parse(text: &str, parameters: &Parameters) -> Result<Self, CombinationError> {
        let mut scanner = Scanner { text, at: 0 };
        let mut terms = Vec::new();
        loop {
            let sign = scanner.sign(terms.is_empty())?;
            let coefficient = scanner.number();
            terms.push((scanner.parameter(parameters)?, sign * coefficient));
            if scanner.rest().is_empty() {
                return Ok(Self::new(terms));
            }
        }
    }

    /// Indices of the parameters with their coefficients.
    pub fn terms(&self) -> &[(usize, f64)] {
        &self.terms
    }

    /// The combination as people write it.
    pub fn text(&self, parameters: &Parameters) -> String {
        sum_text(&self.terms, parameters)
    }
}

/// `a + 2 b - 0.5 c`.
pub(super) fn sum_text(terms: &[(usize, f64)], parameters: &Parameters) -> String {
    let mut text = String::new();
    for (n, &(j, coefficient)) in terms.iter().enumerate() {
        let sign = match (coefficient < 0.0, n) {
            (true, 0) => "-",
            (false, 0) => "",
            (true, _) => " - ",
            (false, _) => " + ",
        };
        text.push_str(sign);
        let size = significant(coefficient.abs());
        if size != "1" {
            text.push_str(&size);
            text.push(' ');
        }
        text.push_str(&parameters[j].name);
    }
    if text.is_empty() { "0".to_owned() } else { text }
}

/// Four significant digits without trailing zeros.
fn significant(value: f64) -> String {
    let rounded: f64 = format!("{value:.3e}").parse().unwrap_or(value);
    if (1e-3..1e5).contains(&rounded) { rounded.to_string() } else { format!("{rounded:e}") }
}

struct Scanner<'t> {
    text: &'t str,
    /// Byte.
    at: usize,
}

impl<'t> Scanner<'t> {
    /// The remaining text, from its first non-blank character.
    fn rest(&mut self) -> &'t str {
        let text = &self.text[self.at..];
        self.at += text.len() - text.trim_start().len();
        &self.text[self.at..]
    }

    fn error(&mut self, expected: impl Into<String>) -> CombinationError {
        let rest = self.rest();
        let first = rest.chars().next().map_or(0, char::len_utf8);
        let shown = if word(rest).is_empty() { &rest[..first] } else { word(rest) };
        let found = if rest.is_empty() { "the end".to_owned() } else { format!("{shown:?}") };
        CombinationError { at: self.text[..self.at].chars().count() + 1, found, expected: expected.into() }
    }

    /// A sign, which only the first term may leave out.
    fn sign(&mut self, first: bool) -> Result<f64, CombinationError> {
        let sign = match self.rest().chars().next() {
            Some('+') => 1.0,
            Some('-') => -1.0,
            _ if first => return Ok(1.0),
            _ => return Err(self.error("+ or -")),
        };
        self.at += 1;
        Ok(sign)
    }

    /// The number before a parameter, 1 if absent.
    fn number(&mut self) -> f64 {
        let rest = self.rest();
        let digits = rest.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(rest.len());
        let exponent = rest[digits..].strip_prefix(['e', 'E']).map_or(0, |tail| {
            let signed = tail.strip_prefix(['+', '-']).unwrap_or(tail);
            let count = signed.find(|c: char| !c.is_ascii_digit()).unwrap_or(signed.len());
            if count == 0 { 0 } else { 1 + tail.len() - signed.len() + count }
        });
        let Ok(number) = rest[..digits + exponent].parse() else { return 1.0 };
        self.at += digits + exponent;
        if self.rest().starts_with('*') {
            self.at += 1;
        }
        number
    }

    fn parameter(&mut self, parameters: &Parameters) -> Result<usize, CombinationError> {
        let name = word(self.rest());
        match parameters.find(name) {
            Some(j) => {
                self.at += name.len();
                Ok(j)
            }
            None => Err(self.error(format!("a parameter such as {}", similar(name, parameters)))),
        }
    }
}

/// The first word: up to a blank or an operator, brackets kept together.
fn word(text: &str) -> &str {
    let mut depth = 0_u32;
    let end = text.find(|c: char| {
        match c {
            '[' => depth += 1,
            ']' => depth = depth.saturating_sub(1),
            _ => {}
        }
        depth == 0 && (c.is_whitespace() || matches!(c, '+' | '-' | '*'))
    });
    &text[..end.unwrap_or(text.len())]
}

/// The parameter whose name begins most like this one.
fn similar<'p>(name: &str, parameters: &'p Parameters) -> &'p str {
    let common = |known: &str| known.chars().zip(name.chars()).take_while(|(a, b)| a == b).count();
    let mut best: (&str, usize) = ("", 0);
    for parameter in parameters {
        let length = common(&parameter.name);
        if best.0.is_empty() || length > best.1 {
            best = (&parameter.name, length);
        }
    }
    best.0
}
