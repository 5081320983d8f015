//! Calibrations compared, as text for the terminal.

use centrical_session::{ComparedResultSummary, ComparisonReport, PairComparison, customary, unit_name};

use super::chance::chance;
use super::screen::{Emphasis, Screen};
use super::symbols::legend;
use super::table::{Align, Cell, Table};
use crate::number::{counted, unsigned_zero, with_uncertainty};

/// Calibrations of one unit, two by two.
pub fn comparison_text(report: &ComparisonReport) -> Screen {
    let mut screen = Screen::default();
    let (emphasis, mark, words) = if report.agree && report.comparisons.iter().any(|pair| pair.same_files > 0) {
        let words =
            "no difference beyond what the uncertainties explain, which two results of the same files show anyway";
        (Emphasis::Warning, "AGREE", words)
    } else if report.agree {
        (Emphasis::Acceptable, "AGREE", "no difference beyond what the uncertainties explain")
    } else if report.is_of_one_unit() {
        (Emphasis::NotAcceptable, "DO NOT AGREE", "the reasons stand below")
    } else {
        (Emphasis::NotAcceptable, "OTHER UNITS", "the results are of different units; their differences stand below")
    };
    screen.marked(emphasis, mark, words);
    screen.gap();
    screen.head("COMPARISON", "difference ± standard uncertainty; E_n with expanded uncertainties, k = 2");
    for (n, result) in report.results.iter().enumerate() {
        let ComparedResultSummary { file, title, date, acceptable, .. } = result;
        let verdict = if *acceptable { "" } else { "; NOT ACCEPTABLE" };
        screen.say(2, &format!("{}  {file}: {}, {date}, {title}{verdict}", n + 1, unit(result)));
    }
    for pair in &report.comparisons {
        one_pair(&mut screen, report, pair);
    }
    let all = report.comparisons.iter().flat_map(|pair| &pair.differences);
    legend(&mut screen, all.map(|d| (d.name.as_str(), d.group)));
    screen
}

fn one_pair(screen: &mut Screen, report: &ComparisonReport, pair: &PairComparison) {
    screen.gap();
    let years = pair.years.map_or(String::new(), |years| format!(", {years:.2} years between them"));
    screen.say(0, &format!("RESULT {} LESS RESULT {}{years}", pair.second + 1, pair.first + 1));
    if pair.same_files > 0 {
        let files = counted(pair.same_files, "file");
        screen.marked(
            Emphasis::Warning,
            "SAME FILES",
            &format!("both rest on {files} with the same bytes: one measurement, not two"),
        );
    }
    cautions(screen, report, pair);
    differences(screen, pair);
    let beyond = pair.differences.iter().filter(|d| d.e_n.abs() > 1.0).count();
    if let (Some(chi_squared), Some(probability)) = (pair.chi_squared, pair.probability) {
        let count = pair.degrees_of_freedom;
        screen.say(
            2,
            &format!(
                "{beyond} of {count} have E_n beyond 1; by chance it is 1 in 20, and a DISAGREE in 1 of 100 pairs"
            ),
        );
        screen.say(
            2,
            &format!(
                "all {count} together: chi^2 = {chi_squared:.1} with {count} degrees of freedom, probability \
                 {} if nothing has changed",
                chance(probability)
            ),
        );
    }
}

fn differences(screen: &mut Screen, pair: &PairComparison) {
    let columns = [
        ("", Align::Left),
        ("unit", Align::Left),
        ("difference", Align::Right),
        ("E_n", Align::Right),
        ("per year", Align::Right),
        ("", Align::Words),
    ];
    let mut table = Table::new(2, columns);
    for d in &pair.differences {
        let (factor, unit) = customary(&d.unit, d.group);
        let shown =
            |share: f64| Cell::estimate(with_uncertainty(share * d.difference, share.abs() * d.standard_uncertainty));
        let per_year = pair.years.map_or(Cell::default(), |years| shown(factor / years));
        let mark = if d.disagrees { "DISAGREE" } else { "" };
        let e_n = unsigned_zero(format!("{:.2}", d.e_n));
        table.row([d.name.as_str().into(), unit.into(), shown(factor), e_n.into(), per_year, mark.into()]);
    }
    screen.table(table);
}

/// What forbids or limits the comparison.
fn cautions(screen: &mut Screen, report: &ComparisonReport, pair: &PairComparison) {
    if !pair.same_unit {
        let [first, second] = [pair.first, pair.second].map(|n| unit(&report.results[n]));
        let words = format!("the first result is of {first}, the second of {second}");
        screen.marked(Emphasis::Warning, "DIFFERENT UNITS", &words);
    }
    for (which, terms) in [("first", &pair.only_in_first), ("second", &pair.only_in_second)] {
        if !terms.is_empty() {
            let words = format!("only the {which} has {}: other coefficients may differ for that", terms.join(", "));
            screen.marked(Emphasis::Warning, "DIFFERENT ERROR MODELS", &words);
        }
    }
    if !pair.by_priors_alone.is_empty() {
        let words = format!("priors alone determine {}: they show no change", pair.by_priors_alone.join(", "));
        screen.marked(Emphasis::Warning, "NOT COMPARED", &words);
    }
    if pair.differences.is_empty() {
        let words = "the two determine no coefficient in common";
        screen.marked(Emphasis::Warning, "NOTHING TO COMPARE", words);
    }
}

fn unit(result: &ComparedResultSummary) -> String {
    unit_name(&result.unit_model, &result.unit_serial)
}
