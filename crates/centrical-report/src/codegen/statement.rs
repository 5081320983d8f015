//! The error model as statements of a language: `error_2 += c[4] * f_1`, a line for each term and derivative.

use centrical_compensate::{Monomial, Term};
use centrical_session::harmless_line;

/// How a language writes what the error model is made of. Indices count from 0.
pub(super) trait Language {
    /// What begins a line of comment.
    fn comment(&self) -> &'static str;

    /// Distance from 1 to the next number of the precision.
    fn epsilon(&self) -> f64 {
        f64::EPSILON
    }

    /// A number that reads back as it is.
    fn number(&self, value: f64) -> String {
        format!("{value:e}")
    }

    /// A line of the table of coefficients.
    fn table_line(&self, number: &str, remark: &str) -> String;

    /// Coefficient `k`.
    fn coefficient(&self, k: usize) -> String;

    /// Component `j` of the specific force.
    fn component(&self, j: usize) -> String;

    /// -1 where component `j` is negative, else 1.
    fn sign(&self, j: usize) -> String;

    /// Between factors.
    fn times(&self) -> &'static str {
        " * "
    }

    /// Adds `value` to component `i` of the error.
    fn add_to_error(&self, i: usize, value: &str, remark: &str) -> String;

    /// Adds `value` to the derivative of reading `i` by component `j`.
    fn add_to_gain(&self, i: usize, j: usize, value: &str) -> String;
}

/// The table of coefficients of these names.
pub(super) fn coefficients(language: &dyn Language, names: &[String], terms: &[Term]) -> String {
    if terms.is_empty() {
        // No language minds a number that nobody uses; C minds a table without any.
        return language.table_line(&language.number(0.0), "no terms");
    }
    let line =
        |(name, term): (&String, &Term)| language.table_line(&language.number(term.coefficient), &harmless(name));
    names.iter().zip(terms).map(line).collect::<Vec<_>>().join("\n")
}

/// The statements that add every term and its derivatives.
pub(super) fn error_and_gain(language: &dyn Language, names: &[String], terms: &[Term]) -> String {
    let mut statements = Vec::new();
    for (k, (name, term)) in names.iter().zip(terms).enumerate() {
        let value = product(language, k, (1.0, term.monomial));
        statements.push(language.add_to_error(term.axis, &value, &harmless(name)));
        for (j, derivative) in (0..3).filter_map(|j| Some((j, term.monomial.derivative(j)?))) {
            statements.push(language.add_to_gain(term.axis, j, &product(language, k, derivative)));
        }
    }
    statements.join("\n")
}

/// `factor * c_k * sign * f_1 * f_1 * f_2`.
fn product(language: &dyn Language, k: usize, (factor, monomial): (f64, Monomial)) -> String {
    let mut factors = if factor == 1.0 { vec![] } else { vec![language.number(factor)] };
    factors.push(language.coefficient(k));
    factors.extend(monomial.sign_of.map(|j| language.sign(j)));
    for (j, power) in monomial.powers.into_iter().enumerate() {
        factors.extend((0..power).map(|_| language.component(j)));
    }
    factors.join(language.times())
}

/// Text that stays within a comment of any of the languages, whatever a session calls itself.
pub(super) fn harmless(text: &str) -> String {
    let line = harmless_line(text).replace('\\', " ");
    // The ends of a C comment, what begins a trigraph, and the marks of the templates.
    line.replace("*/", "* /").replace("/*", "/ *").replace("??", "? ?").replace('@', "(at)")
}
