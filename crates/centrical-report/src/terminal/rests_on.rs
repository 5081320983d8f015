//! What a result rests on, as text for the terminal.

use centrical::{Extension, Extra, Rival};
use centrical_session::RestsOn;

use super::rivals::changes_for;
use super::screen::Screen;
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
    // A step of the reading has no inverse at no force.
    if let Some(Rival::Terms(Extra::Jump)) = effect.rival() {
        return format!("protect: state {bound} under [uncertainty]");
    }
    match effect.price_as_unknown {
        Some(price) if price < CHEAP => {
            format!("protect: {change}, at {price:.2} times the uncertainty of {}", effect.parameter)
        }
        Some(price) => format!(
            "protect: state {bound} under [uncertainty]; or {change}, at {price:.1} times the uncertainty of {}",
            effect.parameter
        ),
        None => format!(
            "protect: state {bound} under [uncertainty]; as an unknown it would leave {} undetermined",
            effect.parameter
        ),
    }
}
