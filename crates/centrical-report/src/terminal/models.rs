//! The choice of the error model as text for the terminal.

use centrical::uncertainty::{FittedCandidate, Level, ModelSelection, chance_of_residuals};

use super::phrases::changes_for;
use super::screen::{Emphasis, Screen};
use super::table::{Align, Cell, Table};
use crate::number::counted;

/// Candidates in the table, beside the model as stated and its parts.
const SHOWN: usize = 12;

/// Terms that are listed by name: more of them are counted.
const NAMED: usize = 12;

/// Candidates whose BIC differs by less fit alike.
const ALIKE: f64 = 2.0;

/// How the candidates that add to the stated model are named.
const STATED: &str = "as stated";

/// The recommendation and its reason, the candidates with the lowest BIC in one table, the terms one by one.
pub fn selection_table(selection: &ModelSelection) -> Screen {
    let mut screen = Screen::default();
    recommendation(&mut screen, selection);
    screen.gap();
    candidates(&mut screen, selection);
    let named = |kept: bool| {
        let names: Vec<&str> = selection.terms.iter().filter(|t| t.kept == kept).map(|t| t.name.as_str()).collect();
        match names.len() {
            0 => "none".to_owned(),
            count if count > NAMED && !kept => {
                format!("{}, and {} more", names[..NAMED].join(", "), count - NAMED)
            }
            _ => names.join(", "),
        }
    };
    screen.gap();
    screen.head("TERMS", "each for itself");
    screen.say(2, &format!("worth an unknown: {}", named(true)));
    screen.say(2, &format!("not worth one: {}", named(false)));
    screen
}

/// Which candidate, what that means, and why.
fn recommendation(screen: &mut Screen, selection: &ModelSelection) {
    let best = &selection.candidates[selection.recommended];
    let meaning = if best.rivals.is_empty() {
        format!("\"{}\": the data support no addition to it", best.name)
    } else {
        format!("\"{}\": the data show an effect that the stated model leaves out", best.name)
    };
    screen.marked(Emphasis::Heading, "RECOMMENDED", &meaning);
    if !best.rivals.is_empty() {
        let changes = changes_for(&best.rivals);
        screen.say(2, &format!("in experiment.toml, under [model]: {changes}"));
        let alike = alike(selection, best);
        if !alike.is_empty() {
            let names = alike.join(", ");
            screen.sentence(2, 4, &format!("the data hardly tell it from {names}, and each gives other estimates: find by other means which it is"));
        }
    }
    for reason in reasons(selection) {
        screen.say(2, &reason);
    }
}

/// Other additions with as many unknowns and about as low a BIC.
fn alike(selection: &ModelSelection, best: &FittedCandidate) -> Vec<String> {
    let is_alike = |other: &&FittedCandidate| {
        other.name != best.name && other.rank == best.rank && other.converged && other.bic - best.bic < ALIKE
    };
    selection.candidates.iter().filter(is_alike).map(|other| format!("\"{}\"", other.name)).collect()
}

/// The candidates, the recommended one first, then by their BIC.
fn candidates(screen: &mut Screen, selection: &ModelSelection) {
    let mut order: Vec<usize> = (0..selection.candidates.len()).collect();
    order.sort_by(|&a, &b| selection.candidates[a].bic.total_cmp(&selection.candidates[b].bic));
    order.sort_by_key(|n| *n != selection.recommended);
    let is_shown = |place: usize, n: usize| place < SHOWN || selection.candidates[n].rivals.is_empty();
    let shown: Vec<usize> =
        order.iter().enumerate().filter(|(place, n)| is_shown(*place, **n)).map(|(_, n)| *n).collect();
    screen.head("MODELS", "by BIC, the lowest first; + adds to the model as stated");
    let numbers = ["unknowns", "chi^2", "dof", "BIC", "hold-out", "F test"];
    let mut table = Table::new(1, &[(Align::Left, &[""]), (Align::Right, &numbers), (Align::Words, &[""])]);
    for &n in &shown {
        let rival = &selection.candidates[n];
        let determined = if rival.rank == rival.unknowns {
            rival.rank.to_string()
        } else {
            format!("{}/{}", rival.rank, rival.unknowns)
        };
        let test = rival.against.map_or(String::new(), |(_, test)| match test.probability {
            p if p > 0.0 => probability(p),
            _ => "<1e-300".to_owned(),
        });
        table.row([
            short_name(&rival.name).into(),
            determined.into(),
            wide(rival.chi_squared).into(),
            rival.degrees_of_freedom.to_string().into(),
            wide(rival.bic).into(),
            wide(rival.hold_out_score).into(),
            test.into(),
            if rival.converged { Cell::default() } else { "did not converge".into() },
        ]);
    }
    screen.table(table);
    let hidden = selection.candidates.len() - shown.len();
    if hidden > 0 {
        screen.say(2, &format!("and {hidden} more with a higher BIC"));
    }
    if !selection.undetermined.is_empty() {
        let names: Vec<String> = selection.undetermined.iter().map(|rival| rival.name()).collect();
        let words = "not fitted, since the readings do not depend on them but through alignment errors";
        screen.sentence(2, 4, &format!("{words}: {}; bounds under [uncertainty] state them", names.join(", ")));
    }
    screen.say(
        2,
        "unknowns: determined ones, of all where some are not; hold-out: score of the prediction \
        of left-out mountings, little above 1 for a true model; F test: probability of the gain over the candidate \
        without the addition, if it were chance",
    );
}

/// `+ seat-radius` for what adds to the model as stated.
fn short_name(name: &str) -> &str {
    name.strip_prefix(STATED).map(str::trim_start).filter(|rest| rest.starts_with('+')).unwrap_or(name)
}

/// One digit; what is too small for a double by its bound.
fn probability(p: f64) -> String {
    if p > 0.0 { format!("{p:.1e}") } else { "less than 1e-300".to_owned() }
}

/// Two decimals where they fit, an exponent where not.
fn wide(value: f64) -> String {
    if value.abs() < 1e6 { format!("{value:.2}") } else { format!("{value:.2e}") }
}

/// Why the recommended one.
fn reasons(selection: &ModelSelection) -> Vec<String> {
    let best = &selection.candidates[selection.recommended];
    let mut reasons = vec!["it has the lowest BIC".to_owned()];
    let others = selection.candidates.iter().enumerate().filter(|(n, _)| *n != selection.recommended).map(|(_, r)| r);
    if let Some(second) = others.min_by(|a, b| a.bic.total_cmp(&b.bic)) {
        reasons[0] = if second.bic < best.bic {
            format!("it has the lowest BIC of those that gain more than chance; \"{}\" has a lower one", second.name)
        } else {
            format!("it has the lowest BIC; the next, \"{}\", is {:.1} behind", second.name, second.bic - best.bic)
        };
    }
    let chance = chance_of_residuals(best.chi_squared, best.degrees_of_freedom, None);
    if Level::Objection.is_passed_by(chance) {
        reasons.insert(
            0,
            format!(
                "it does not fit either, chi^2 {} of {} degrees of freedom: no single effect in this list explains the residuals",
                wide(best.chi_squared),
                best.degrees_of_freedom
            ),
        );
    }
    if let Some((nested, test)) = best.against {
        reasons.push(format!(
            "it has {} over \"{}\"; so large a gain comes by chance with a probability of {}",
            counted(test.degrees_of_freedom, "further unknown"),
            selection.candidates[nested].name,
            probability(test.probability)
        ));
    }
    let sound = selection.candidates.iter().filter(|rival| rival.converged);
    reasons.push(match sound.min_by(|a, b| a.hold_out_score.total_cmp(&b.hold_out_score)) {
        Some(first) if first.hold_out_score < best.hold_out_score => format!(
            "left-out mountings are predicted better by \"{}\", a score of {:.3} against {:.3}",
            first.name, first.hold_out_score, best.hold_out_score
        ),
        _ => "it predicts left-out mountings best as well".to_owned(),
    });
    reasons
}
