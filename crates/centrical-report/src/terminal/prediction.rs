//! What will be known, as text for the terminal.

use centrical::{Group, STANDARD_GRAVITY};
use centrical_session::{MICRO_G, PredictedParameter, PredictionReport, customary};

use super::phrases::{extent, legend, rests_name};
use super::rests_on::rests_on_text;
use super::screen::Screen;
use super::table::{Align, Cell, Table};
use crate::number::two_digits;

/// Said of a parameter in which lost combinations leave doubt that no number beside it holds.
pub(super) const LEANING: &str = "leans on what is lost";

/// What will be known: parameters, and the compensated reading.
pub fn prediction_text(prediction: &PredictionReport) -> Screen {
    let mut screen = Screen::default();
    screen.head("PREDICTION", &format!("standard uncertainties (k = 1) by {}", prediction.sources.join(", ")));
    parameters(&mut screen, prediction);
    reading(&mut screen, prediction);
    screen.add(rests_on_text(&prediction.rests_on));
    screen
}

fn parameters(screen: &mut Screen, prediction: &PredictionReport) {
    let numbers = ["type A", "combined", "k", "expanded"];
    let mut table = Table::new(2, &[(Align::Left, &["", "unit"]), (Align::Right, &numbers), (Align::Words, &[""])]);
    let (attitudes, others): (Vec<_>, Vec<_>) = prediction.parameters.iter().partition(|p| p.group == Group::Attitude);
    for p in others {
        let (factor, unit) = customary(&p.unit, p.group);
        let names: [Cell; 2] = [p.name.as_str().into(), unit.into()];
        let known = (p.type_a, p.combined, p.expanded);
        let cells: [Cell; 5] = if let (Some(a), Some(combined), Some(expanded)) = known {
            let [of_a, of_all, of_interval] = [a, combined, expanded].map(|u| two_digits(u * factor).into());
            let note = if p.is_affected_by_null_space { LEANING } else { "" };
            [of_a, of_all, format!("{:.2}", expanded / combined).into(), of_interval, note.into()]
        } else {
            ["-".into(), "-".into(), Cell::default(), "-".into(), "not determined".into()]
        };
        table.row(names.into_iter().chain(cells));
    }
    if let Some(first) = attitudes.first() {
        let (factor, unit) = customary(&first.unit, first.group);
        let of = |u: fn(&PredictedParameter) -> Option<f64>| extent(attitudes.iter().map(|p| u(p).map(|u| u * factor)));
        let [a, combined, expanded] = [of(|p| p.type_a), of(|p| p.combined), of(|p| p.expanded)];
        let cells = [rests_name(attitudes.len()), unit.to_owned(), a, combined, String::new(), expanded, String::new()];
        table.row(cells.map(Cell::from));
    }
    screen.table(table);
    screen.say(2, &format!("expanded = k x combined, for a probability of {:.2} %", 100.0 * prediction.coverage));
    legend(screen, prediction.parameters.iter().map(|p| (p.name.as_str(), p.group)));
}

fn reading(screen: &mut Screen, prediction: &PredictionReport) {
    let ug = |u: f64| two_digits(u / MICRO_G);
    let range = prediction.range / STANDARD_GRAVITY;
    screen.say(2, &match prediction.reading {
        Some([a, all]) => format!(
            "compensated reading, root mean square over all directions to {range:.0} g: type A {} ug, combined {} ug",
            ug(a),
            ug(all)
        ),
        None => "compensated reading: a coefficient is not determined".to_owned(),
    });
    if prediction.curves.is_empty() {
        return;
    }
    let mut table = Table::new(1, &[(Align::Right, &["along, ug, at", "axis 1", "axis 2", "axis 3"])]);
    for [force, u @ ..] in &prediction.curves {
        let force = format!("{:.0} g", force / STANDARD_GRAVITY);
        table.row([force.into()].into_iter().chain(u.map(|u| ug(u).into())));
    }
    screen.table(table);
}
