//! The choice of the error model as text for the terminal.

use std::fmt::Write;

use centrical::uncertainty::Selection;

use super::rivals::lines_of;

/// Candidates in the table, beside the model as stated and its parts.
const SHOWN: usize = 12;

/// The candidates with the lowest BIC in one table, the recommendation and its reason, the terms one by one.
pub fn selection_table(selection: &Selection) -> String {
    let mut text = String::from("MODELS\n");
    let _ = writeln!(
        text,
        "  {:<48}{:>9} {:>11} {:>5} {:>11} {:>9}  F test against",
        "", "unknowns", "chi^2", "dof", "BIC", "hold-out"
    );
    let mut order: Vec<usize> = (0..selection.candidates.len()).collect();
    order.sort_by(|&a, &b| selection.candidates[a].bic.total_cmp(&selection.candidates[b].bic));
    let is_shown = |place: usize, n: usize| place < SHOWN || selection.candidates[n].rivals.is_empty();
    let shown: Vec<usize> =
        order.iter().enumerate().filter(|(place, n)| is_shown(*place, **n)).map(|(_, n)| *n).collect();
    for &n in &shown {
        let rival = &selection.candidates[n];
        let mark = if n == selection.recommended { "*" } else { " " };
        let determined = if rival.rank == rival.unknowns {
            rival.rank.to_string()
        } else {
            format!("{}/{}", rival.rank, rival.unknowns)
        };
        let _ = write!(
            text,
            "{mark} {:<48}{determined:>9} {:>11} {:>5} {:>11} {:>9}",
            rival.name,
            wide(rival.chi_squared),
            rival.degrees_of_freedom,
            wide(rival.bic),
            wide(rival.hold_out_score)
        );
        if let Some(test) = &rival.against {
            let name = &selection.candidates[test.nested].name;
            let _ = write!(text, "  {name}: {:.2} for {}, p = {}", test.f, test.further, probability(test.probability));
        }
        text.push_str(if rival.converged { "\n" } else { "  did not converge\n" });
    }
    let hidden = selection.candidates.len() - shown.len();
    if hidden > 0 {
        let _ = writeln!(text, "  and {hidden} more with a higher BIC");
    }
    text.push_str(&reason(selection));
    let added = &selection.candidates[selection.recommended].rivals;
    if !added.is_empty() {
        let _ = writeln!(text, "  in experiment.toml, under [model]: {}", lines_of(added).join("; "));
    }
    let of = |kept: bool| {
        let names: Vec<&str> = selection.terms.iter().filter(|t| t.kept == kept).map(|t| t.name.as_str()).collect();
        if names.is_empty() { "none".to_owned() } else { names.join(", ") }
    };
    let _ = writeln!(text, "  terms that the data show, one by one: {}", of(true));
    let _ = writeln!(text, "  terms that they do not show: {}", of(false));
    text
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
fn reason(selection: &Selection) -> String {
    let best = &selection.candidates[selection.recommended];
    let mut text = format!("  recommended: \"{}\", the lowest BIC", best.name);
    if let Some(test) = &best.against {
        let _ = write!(
            text,
            "; its {} further unknowns over \"{}\" would all be zero with a probability of {}",
            test.further,
            selection.candidates[test.nested].name,
            probability(test.probability)
        );
    }
    let others = selection.candidates.iter().enumerate().filter(|(n, _)| *n != selection.recommended).map(|(_, r)| r);
    if let Some(second) = others.min_by(|a, b| a.bic.total_cmp(&b.bic)) {
        let _ = write!(text, "; the next, \"{}\", is {:.1} behind", second.name, second.bic - best.bic);
    }
    let sound = selection.candidates.iter().filter(|rival| rival.converged);
    match sound.min_by(|a, b| a.hold_out_score.total_cmp(&b.hold_out_score)) {
        Some(first) if first.hold_out_score < best.hold_out_score => {
            let _ = writeln!(
                text,
                "; left-out mountings are predicted better by \"{}\", a score of {:.3} against {:.3}",
                first.name, first.hold_out_score, best.hold_out_score
            );
        }
        _ => text.push_str("; it predicts left-out mountings best as well\n"),
    }
    text
}
