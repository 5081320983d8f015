//! Calibrations compared, as text for the terminal.

use std::fmt::Write;

use centrical_session::{ComparedResultSummary, ComparisonReport, PairComparison, customary, harmless_line};

use crate::number::short;

/// Calibrations of one unit, two by two.
pub fn comparison_text(report: &ComparisonReport) -> String {
    let mut text = String::from("COMPARISON  E_n with expanded uncertainties, k = 2\n");
    for (n, result) in report.results.iter().enumerate() {
        let ComparedResultSummary { file, title, date, .. } = result;
        let _ = writeln!(
            text,
            "  {}  {}: {}  {}  {}",
            n + 1,
            harmless_line(file),
            unit(result),
            date,
            harmless_line(title)
        );
    }
    for pair in &report.comparisons {
        one_pair(&mut text, report, pair);
    }
    text
}

fn one_pair(text: &mut String, report: &ComparisonReport, pair: &PairComparison) {
    let years = pair.years.map_or(String::new(), |years| format!(", {years:.2} years between them"));
    let _ = writeln!(text, "\nRESULT {} LESS RESULT {}{years}", pair.second + 1, pair.first + 1);
    let drift = if pair.years.is_some() { "per year" } else { "" };
    if !pair.differences.is_empty() {
        let _ = writeln!(text, "  {:<12}{:<9}{:>12}{:>10}{:>8}{drift:>12}", "", "unit", "difference", "u", "E_n");
    }
    for d in &pair.differences {
        let (factor, unit) = customary(&d.unit, d.group);
        let (difference, u) = (short(d.difference * factor), short(d.standard_uncertainty * factor));
        let drift = d.per_year.map_or(String::new(), |drift| short(drift * factor));
        let mark = if d.disagrees { "  DISAGREE" } else { "" };
        let _ = writeln!(text, "  {:<12}{unit:<9}{difference:>12}{u:>10}{:>8.2}{drift:>12}{mark}", d.name, d.e_n);
    }
    let beyond = pair.differences.iter().filter(|d| d.e_n.abs() > 1.0).count();
    if let (Some(chi_squared), Some(probability)) = (pair.chi_squared, pair.probability) {
        let count = pair.degrees_of_freedom;
        let _ = writeln!(
            text,
            "  {beyond} of {count} have E_n beyond 1; by chance it is 1 in 20\n  \
             all {count} together: chi^2 = {chi_squared:.1} with {count} degrees of freedom, probability {probability:.1e} \
             if nothing has changed"
        );
    }
    cautions(text, report, pair);
}

/// What forbids or limits the comparison.
fn cautions(text: &mut String, report: &ComparisonReport, pair: &PairComparison) {
    if !pair.same_unit {
        let [first, second] = [pair.first, pair.second].map(|n| unit(&report.results[n]));
        let _ = writeln!(text, "DIFFERENT UNITS  the first result is of {first}, the second of {second}");
    }
    for (which, terms) in [("first", &pair.only_in_first), ("second", &pair.only_in_second)] {
        if !terms.is_empty() {
            let terms = terms.join(", ");
            let _ = writeln!(
                text,
                "DIFFERENT ERROR MODELS  only the {which} has {terms}: other coefficients may differ for that"
            );
        }
    }
    if pair.differences.is_empty() {
        text.push_str("NOTHING TO COMPARE  the two determine no coefficient in common\n");
    }
}

fn unit(result: &ComparedResultSummary) -> String {
    harmless_line(&format!("{}, serial {}", result.unit_model, result.unit_serial)).into_owned()
}
