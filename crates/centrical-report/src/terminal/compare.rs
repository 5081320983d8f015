//! Two calibrations compared, as text for the terminal.

use centrical_session::{CalibrationResult, ComparedResults, customary};

use super::screen::{Emphasis, Screen};
use super::symbols::legend;
use super::table::{Align, Cell, Table};
use crate::number::{unsigned_zero, with_uncertainty};

/// Two calibrations of one unit, the `first` and a second one; `years` lie between them, where known.
pub fn comparison_table(first: &CalibrationResult, compared: &ComparedResults, years: Option<f64>) -> Screen {
    let mut screen = verdict(compared);
    cautions(&mut screen, compared);
    screen.gap();
    screen.head("COMPARISON", "second less first ± standard uncertainty; E_n with expanded uncertainties, k = 2");
    differences(&mut screen, first, compared, years.filter(|years| *years != 0.0));
    let comparison = &compared.comparison;
    let beyond = comparison.differences.iter().filter(|d| d.e_n.abs() > 1.0).count();
    if let (Some(chi_squared), Some(probability)) = (comparison.chi_squared, comparison.probability) {
        let count = comparison.differences.len();
        screen.say(2, &format!("{beyond} of {count} have E_n beyond 1; by chance it is 1 in 20"));
        screen.say(
            2,
            &format!(
                "all {count} together: chi^2 = {chi_squared:.1} with {count} degrees of freedom, probability \
             {probability:.1e} if nothing has changed"
            ),
        );
    }
    screen
}

fn verdict(compared: &ComparedResults) -> Screen {
    let mut screen = Screen::default();
    let (emphasis, mark, words) = if compared.agree {
        (Emphasis::Acceptable, "AGREE", "no difference beyond what the uncertainties explain")
    } else {
        (Emphasis::NotAcceptable, "DO NOT AGREE", "the reasons stand below")
    };
    screen.marked(emphasis, mark, words);
    screen
}

fn differences(screen: &mut Screen, first: &CalibrationResult, compared: &ComparedResults, years: Option<f64>) {
    let columns = [
        ("", Align::Left),
        ("unit", Align::Left),
        ("difference", Align::Right),
        ("E_n", Align::Right),
        ("per year", Align::Right),
        ("", Align::Words),
    ];
    let mut table = Table::new(2, columns);
    let known = |name: &str| first.parameter(name);
    for d in &compared.comparison.differences {
        let (factor, unit) = known(&d.name).map_or((1.0, ""), |p| customary(&p.unit, p.group));
        let shown =
            |share: f64| Cell::estimate(with_uncertainty(share * d.difference, share.abs() * d.standard_uncertainty));
        let per_year = years.map_or(Cell::default(), |years| shown(factor / years));
        let mark = if d.is_real() { "DISAGREE" } else { "" };
        let e_n = unsigned_zero(format!("{:.2}", d.e_n));
        table.row([d.name.as_str().into(), unit.into(), shown(factor), e_n.into(), per_year, mark.into()]);
    }
    screen.table(table);
    let groups = compared.comparison.differences.iter().filter_map(|d| Some((d.name.as_str(), known(&d.name)?.group)));
    legend(screen, groups);
}

/// What forbids or limits the comparison.
fn cautions(screen: &mut Screen, compared: &ComparedResults) {
    if let Some([first, second]) = &compared.different_units {
        let words = format!("the first result is of {first}, the second of {second}");
        screen.marked(Emphasis::Warning, "DIFFERENT UNITS", &words);
    }
    for (which, terms) in ["first", "second"].into_iter().zip(&compared.terms_of_one) {
        if !terms.is_empty() {
            let words = format!("only the {which} has {}: other coefficients may differ for that", terms.join(", "));
            screen.marked(Emphasis::Warning, "DIFFERENT ERROR MODELS", &words);
        }
    }
    if compared.comparison.differences.is_empty() {
        let words = "the two determine no coefficient in common";
        screen.marked(Emphasis::Warning, "NOTHING TO COMPARE", words);
    }
}
