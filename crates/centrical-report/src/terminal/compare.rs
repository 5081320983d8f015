//! Two calibrations compared, as text for the terminal.

use std::fmt::Write;

use centrical_session::{CalibrationResult, ComparedResults, customary};

use crate::number::short;

/// Two calibrations of one unit, the `first` and a second one; `years` lie between them, where known.
pub fn comparison_table(first: &CalibrationResult, compared: &ComparedResults, years: Option<f64>) -> String {
    let years = years.filter(|years| *years != 0.0);
    let comparison = &compared.comparison;
    let mut text = String::from("COMPARISON  second less first; E_n with expanded uncertainties, k = 2\n");
    let drift = if years.is_some() { "per year" } else { "" };
    let _ = writeln!(text, "  {:<12}{:<9}{:>12}{:>10}{:>8}{drift:>12}", "", "unit", "difference", "u", "E_n");
    for d in &comparison.differences {
        let (factor, unit) = first.parameter(&d.name).map_or((1.0, ""), |p| customary(&p.unit, p.group));
        let (difference, u) = (short(d.difference * factor), short(d.standard_uncertainty * factor));
        let drift = years.map_or(String::new(), |years| short(d.difference * factor / years));
        let mark = if d.is_real() { "  DISAGREE" } else { "" };
        let _ = writeln!(text, "  {:<12}{unit:<9}{difference:>12}{u:>10}{:>8.2}{drift:>12}{mark}", d.name, d.e_n);
    }
    let beyond = comparison.differences.iter().filter(|d| d.e_n.abs() > 1.0).count();
    if let (Some(chi_squared), Some(probability)) = (comparison.chi_squared, comparison.probability) {
        let count = comparison.differences.len();
        let _ = writeln!(
            text,
            "  {beyond} of {count} have E_n beyond 1; by chance it is 1 in 20\n  \
             all {count} together: chi^2 = {chi_squared:.1} with {count} degrees of freedom, probability {probability:.1e} \
             if nothing has changed"
        );
    }
    cautions(&mut text, compared);
    text
}

/// What forbids or limits the comparison.
fn cautions(text: &mut String, compared: &ComparedResults) {
    if let Some([first, second]) = &compared.different_units {
        let _ = writeln!(text, "DIFFERENT UNITS  the first result is of {first}, the second of {second}");
    }
    for (which, terms) in ["first", "second"].into_iter().zip(&compared.terms_of_one) {
        if !terms.is_empty() {
            let terms = terms.join(", ");
            let _ = writeln!(
                text,
                "DIFFERENT ERROR MODELS  only the {which} has {terms}: other coefficients may differ for that"
            );
        }
    }
    if compared.comparison.differences.is_empty() {
        text.push_str("NOTHING TO COMPARE  the two determine no coefficient in common\n");
    }
}
