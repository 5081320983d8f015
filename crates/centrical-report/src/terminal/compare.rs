//! Two calibrations compared, as text for the terminal.

use std::fmt::Write;

use centrical::uncertainty::Comparison;
use centrical_session::{CalibrationResult, customary};

use crate::number::short;

/// Two calibrations of one unit, the `first` and a second one; `years` lie between them, where known.
pub fn comparison_table(first: &CalibrationResult, comparison: &Comparison, years: Option<f64>) -> String {
    let years = years.filter(|years| *years != 0.0);
    let mut text =
        String::from("COMPARISON  second less first; E_n with expanded uncertainties, k = 2: beyond 1 they disagree\n");
    let drift = if years.is_some() { "per year" } else { "" };
    let _ = writeln!(text, "  {:<12}{:<9}{:>12}{:>10}{:>8}{drift:>12}", "", "unit", "difference", "u", "E_n");
    for d in &comparison.differences {
        let (factor, unit) = first.parameter(&d.name).map_or((1.0, ""), |p| customary(&p.unit, p.group));
        let (difference, u) = (short(d.difference * factor), short(d.standard_uncertainty * factor));
        let drift = years.map_or(String::new(), |years| short(d.difference * factor / years));
        let mark = if d.e_n.abs() > 1.0 { "  DISAGREE" } else { "" };
        let _ = writeln!(text, "  {:<12}{unit:<9}{difference:>12}{u:>10}{:>8.2}{drift:>12}{mark}", d.name, d.e_n);
    }
    if let (Some(chi_squared), Some(probability)) = (comparison.chi_squared, comparison.probability) {
        let count = comparison.differences.len();
        let _ = writeln!(
            text,
            "  all {count} together: chi^2 = {chi_squared:.1} with {count} degrees of freedom, probability {probability:.1e} \
             if nothing has changed"
        );
    }
    text
}
