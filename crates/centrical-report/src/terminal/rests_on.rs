//! What a result rests on, as text for the terminal: the absence of effects, and prior knowledge.

use centrical::{Course, Extension, Extra, Group, Rival};
use centrical_session::RestsOn;

use super::phrases::{changes_for, rests_name};
use super::screen::Screen;
use super::table::{Align, Table};
use crate::document::rests_on_sentence;
use crate::language::Language;

/// Effects that are shown: the others are in the JSON.
const SHOWN: usize = 3;

/// A price below this factor is worth paying: the effect is then better an unknown.
const CHEAP: f64 = 1.5;

/// The effects whose absence a result rests on most, and what would protect against each. Without effects the text is empty.
pub(super) fn rests_on_text(effects: &[RestsOn]) -> Screen {
    let mut screen = Screen::default();
    if effects.is_empty() {
        return screen;
    }
    screen.fact("RESTS", "on the absence of effects that could pass unseen, up to these sizes; the worst:");
    for effect in effects.iter().take(SHOWN) {
        screen.sentence(2, 4, &format!("- {}", rests_on_sentence(effect, Language::English)));
        screen.sentence(4, 6, &protection(effect));
    }
    screen
}

/// What protects against an effect: an unknown where it costs little, else a bound.
fn protection(effect: &RestsOn) -> String {
    let bound = effect.name.replace('-', "_");
    let change = effect.rival().map(|rival| changes_for(&[rival])).unwrap_or_default();
    if let Some(Rival::Effect(Extension::OneMounting(_, mounting))) = effect.rival() {
        return format!("protect: mount the unit again as in mounting {}", mounting + 1);
    }
    if let Some(Rival::Effect(Extension::OneSpeed(_))) = effect.rival() {
        return "protect: measure the speeds (measured under [centrifuge])".to_owned();
    }
    if let Some(Rival::Effect(Extension::Disturbance(Course::From(_)))) = effect.rival() {
        return "Repeating earlier attitudes would reveal a smaller step.".to_owned();
    }
    if let Some(Rival::Effect(Extension::EarthRate)) = effect.rival() {
        return "protect: state latitude under [site]".to_owned();
    }
    // A step of the reading has no inverse at no force.
    if let Some(Rival::Terms(Extra::Jump)) = effect.rival() {
        return format!("protect: state {bound} under [uncertainty]");
    }
    let has_bound = !matches!(effect.rival(), Some(Rival::Effect(Extension::Resonance(_))));
    match effect.price_as_unknown {
        None if !has_bound => "protect: leave out the plateaus at that speed".to_owned(),
        Some(price) if price < CHEAP || !has_bound => {
            format!("protect: {change}, at {price:.2} times the uncertainty of {}", effect.parameter)
        }
        Some(price) => format!(
            "protect: state {bound} under [uncertainty]; or {change}, at {price:.1} times the uncertainty of {}",
            effect.parameter
        ),
        None => format!("protect: {}", bound_alone(&effect.name)),
    }
}

/// How the model takes in an effect that the residuals show: as an unknown, or by its size alone.
pub(super) fn remedy(shown: Rival, effects: &[RestsOn]) -> String {
    let name = shown.name();
    let is_lost = |effect: &RestsOn| effect.name == name && effect.price_as_unknown.is_none();
    if Rival::COMMON.contains(&shown) && effects.iter().any(is_lost) {
        return bound_alone(&name);
    }
    format!("models fits it in full; to have it in the model: {}", changes_for(&[shown]))
}

/// For an effect that takes parameters of the instrument with it.
fn bound_alone(name: &str) -> String {
    let bound = name.replace('-', "_");
    format!("state {bound} under [uncertainty]; as an unknown it would leave parameters of the instrument undetermined")
}

/// What the data add to prior knowledge: for each prior its parameter, and the standard uncertainty after the data over that before.
/// The known attitudes of rests stand in one row. Nothing without priors.
pub(super) fn priors<'p>(screen: &mut Screen, given: impl Iterator<Item = (&'p str, Group, f64)>) {
    let (attitudes, others): (Vec<_>, Vec<_>) = given.partition(|(_, group, _)| *group == Group::Attitude);
    let mut table = Table::new(1, &[(Align::Left, &[""]), (Align::Right, &[""])]);
    for (name, _, ratio) in &others {
        table.row([(*name).into(), format!("{ratio:.3}").into()]);
    }
    let extremes = attitudes.iter().map(|(_, _, ratio)| (*ratio, *ratio));
    if let Some((low, high)) = extremes.reduce(|(low, high), (r, _)| (low.min(r), high.max(r))) {
        table.row([rests_name(attitudes.len()).into(), format!("{low:.3} to {high:.3}").into()]);
    }
    if !table.rows().is_empty() {
        screen.gap();
        screen.head("PRIORS", "standard uncertainty after the data over that before");
        screen.table(table);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An effect that would take parameters of the instrument with it is stated by its size; another one is an unknown.
    #[test]
    fn an_effect_that_costs_a_parameter_is_stated() {
        let effect = |price: Option<f64>| RestsOn {
            name: "mounting-shift".to_owned(),
            unknown: "mounting_shift_1[2]".to_owned(),
            unit: "m".to_owned(),
            group: Group::MountingShift,
            smallest_shown: Some(1e-6),
            parameter: "df_2".to_owned(),
            shift: 1e-4,
            standard_uncertainties: 5.0,
            reading: 1e-3,
            price_as_unknown: price,
        };
        let shown = Rival::Effect(Extension::MountingShift);
        let stated = "state mounting_shift under [uncertainty]; as an unknown it would leave parameters of the instrument undetermined";
        assert_eq!(remedy(shown, &[effect(None)]), stated);
        let unknown = "models fits it in full; to have it in the model: add \"mounting-shift\" to extensions";
        assert_eq!(remedy(shown, &[effect(Some(2.0))]), unknown);
        assert_eq!(remedy(shown, &[]), unknown);
    }
}
