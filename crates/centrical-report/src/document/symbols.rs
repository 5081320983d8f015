//! The symbols of the error model in words, and how raw output becomes readings.

use centrical::Group;
use centrical_session::{CalibrationResult, OutputSummary};

use super::content::{Align, Block, Fact, Table};
use super::tables::axis_titles;
use crate::evaluation::symbol;
use crate::language::Language;

/// Every coefficient of the error model by its group, with what it is.
pub(super) fn symbols(result: &CalibrationResult, language: Language) -> Vec<Fact> {
    let messages = language.messages();
    let mut groups: Vec<(Group, Vec<String>)> = Vec::new();
    for parameter in result.model.error_model.iter().filter_map(|term| result.parameter(&term.name)) {
        match groups.iter_mut().find(|(group, _)| *group == parameter.group) {
            Some((_, names)) => names.push(symbol(&parameter.name)),
            None => groups.push((parameter.group, vec![symbol(&parameter.name)])),
        }
    }
    groups.into_iter().map(|(group, names)| (names.join(", "), (messages.words.meaning)(group).to_owned())).collect()
}

/// The nominal scale and bias of a unit that does not put out an acceleration.
pub(super) fn nominal_output(result: &CalibrationResult, language: Language) -> Vec<Block> {
    let messages = language.messages();
    let Some(OutputSummary { unit, scale, bias }) = result.raw_output() else {
        return Vec::new();
    };
    let unit = language.unit(unit);
    let row = |name: &str, numbers: &[f64; 3], unit: String| {
        let numbers = numbers.iter().map(|number| language.number(&number.to_string()));
        [name.to_owned(), unit].into_iter().chain(numbers).collect::<Vec<_>>()
    };
    let per_force = format!("{unit}/({})", language.unit("m/s^2"));
    let rows = [row(messages.nominal_scale, scale, per_force), row(messages.nominal_bias, bias, unit)];
    let axes = axis_titles(language);
    let columns = [
        ("", 0.26, Align::Left),
        (messages.unit, 0.2, Align::Left),
        (&axes[0], 0.18, Align::Right),
        (&axes[1], 0.18, Align::Right),
        (&axes[2], 0.18, Align::Right),
    ];
    vec![
        Block::Subheading(messages.nominal_output.to_owned()),
        Block::paragraph(messages.nominal_output_text),
        Block::Table(Table::numbers(columns, rows)),
    ]
}
