//! Calibrations compared, as text for the terminal.

use centrical_session::{ComparedResultSummary, ComparisonReport, PairComparison, customary};

use super::phrases::{chance, legend_in};
use super::screen::{Emphasis, Screen};
use super::table::{Align, Cell, Table};
use crate::language::{ComparisonMessages, Language};
use crate::number::{unsigned_zero, with_uncertainty};

/// Calibrations of one unit, two by two.
pub fn comparison_text(report: &ComparisonReport, language: Language) -> Screen {
    let messages = language.comparison();
    let mut screen = Screen::default();
    let (emphasis, [mark, words]) = if report.agree && report.comparisons.iter().any(|pair| pair.same_files > 0) {
        (Emphasis::Warning, [messages.agree[0], messages.agree_of_same_files])
    } else if report.agree {
        (Emphasis::Acceptable, messages.agree)
    } else if report.is_of_one_unit() {
        (Emphasis::NotAcceptable, messages.disagree)
    } else {
        (Emphasis::NotAcceptable, messages.other_units)
    };
    screen.marked(emphasis, mark, words);
    screen.gap();
    screen.head(messages.heading[0], messages.heading[1]);
    for (n, result) in report.results.iter().enumerate() {
        let ComparedResultSummary { file, title, date, acceptable, .. } = result;
        let verdict = if *acceptable { String::new() } else { format!("; {}", messages.not_acceptable) };
        let session = [unit(result, messages), language.written_date(date), title.clone()];
        let session: Vec<String> = session.into_iter().filter(|part| !part.is_empty()).collect();
        screen.say(2, &format!("{}  {file}: {}{verdict}", n + 1, session.join(", ")));
    }
    for pair in &report.comparisons {
        one_pair(&mut screen, report, pair, language);
    }
    let all = report.comparisons.iter().flat_map(|pair| &pair.differences);
    legend_in(&mut screen, all.map(|d| (d.name.as_str(), d.group)), language);
    screen
}

fn one_pair(screen: &mut Screen, report: &ComparisonReport, pair: &PairComparison, language: Language) {
    let messages = language.comparison();
    screen.gap();
    let years = pair.years.map(|years| language.plain(format!("{years:.2}")));
    screen.say(0, &(messages.less)(pair.second + 1, pair.first + 1, years.as_deref()));
    if pair.same_files > 0 {
        screen.marked(Emphasis::Warning, messages.same_files, &(messages.same_files_text)(pair.same_files));
    }
    cautions(screen, report, pair, messages);
    differences(screen, pair, language);
    let beyond = pair.differences.iter().filter(|d| d.e_n.abs() > 1.0).count();
    if let (Some(chi_squared), Some(probability)) = (pair.chi_squared, pair.probability) {
        let count = pair.degrees_of_freedom;
        screen.say(2, &(messages.beyond)(beyond, count));
        let chi_squared = language.plain(format!("{chi_squared:.1}"));
        let chance =
            if language == Language::English { chance(probability) } else { language.probability(probability) };
        screen.say(2, &(messages.together)(count, &chi_squared, &chance));
    }
}

fn differences(screen: &mut Screen, pair: &PairComparison, language: Language) {
    let messages = language.comparison();
    let numbers = [messages.difference, "E_n", messages.per_year];
    let mut table =
        Table::new(2, &[(Align::Left, &["", messages.unit]), (Align::Right, &numbers), (Align::Words, &[""])]);
    for d in &pair.differences {
        let (factor, unit) = customary(&d.unit, d.group);
        let shown = |share: f64| {
            let (value, u) = with_uncertainty(share * d.difference, share.abs() * d.standard_uncertainty);
            Cell::shown((language.plain(value), language.plain(u)))
        };
        let per_year = pair.years.map_or(Cell::default(), |years| shown(factor / years));
        let mark = if d.disagrees { messages.disagrees } else { "" };
        let e_n = language.plain(unsigned_zero(format!("{:.2}", d.e_n)));
        let unit = language.plain_unit(unit);
        table.row([d.name.as_str().into(), unit.into(), shown(factor), e_n.into(), per_year, mark.into()]);
    }
    screen.table(table);
}

/// What forbids or limits the comparison.
fn cautions(screen: &mut Screen, report: &ComparisonReport, pair: &PairComparison, messages: &ComparisonMessages) {
    let mut warn = |mark: &str, words: &str| screen.marked(Emphasis::Warning, mark, words);
    if !pair.same_unit {
        let [first, second] = [pair.first, pair.second].map(|n| unit(&report.results[n], messages));
        warn(messages.different_units, &(messages.different_units_text)(&first, &second));
    }
    for (only_in, terms) in messages.only_in.iter().zip([&pair.only_in_first, &pair.only_in_second]) {
        if !terms.is_empty() {
            warn(messages.different_models, &only_in(&terms.join(", ")));
        }
    }
    if !pair.by_priors_alone.is_empty() {
        warn(messages.not_compared, &(messages.by_priors_alone)(&pair.by_priors_alone.join(", ")));
    }
    if pair.differences.is_empty() {
        warn(messages.nothing[0], messages.nothing[1]);
    }
}

fn unit(result: &ComparedResultSummary, messages: &ComparisonMessages) -> String {
    (messages.unit_name)(&result.unit_model, &result.unit_serial)
}
