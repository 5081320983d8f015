//! The choice of the error model as text for the terminal.

use std::fmt::Write;

use centrical::uncertainty::Selection;

/// The rivals in one table, the recommendation and its reason, the terms one by one.
pub fn selection_table(selection: &Selection) -> String {
    let mut text = String::from("MODELS\n");
    let _ = writeln!(
        text,
        "  {:<32}{:>9} {:>11} {:>5} {:>11} {:>9}  F test against",
        "", "unknowns", "chi^2", "dof", "BIC", "hold-out"
    );
    for (n, rival) in selection.rivals.iter().enumerate() {
        let mark = if n == selection.recommended { "*" } else { " " };
        let determined = if rival.rank == rival.unknowns {
            rival.rank.to_string()
        } else {
            format!("{}/{}", rival.rank, rival.unknowns)
        };
        let _ = write!(
            text,
            "{mark} {:<32}{determined:>9} {:>11} {:>5} {:>11} {:>9}",
            rival.name,
            wide(rival.chi_squared),
            rival.degrees_of_freedom,
            wide(rival.bic),
            wide(rival.hold_out_score)
        );
        if let Some(test) = &rival.against {
            let name = &selection.rivals[test.nested].name;
            let _ = write!(text, "  {name}: {:.2} for {}, p = {}", test.f, test.further, probability(test.probability));
        }
        text.push_str(if rival.converged { "\n" } else { "  did not converge\n" });
    }
    text.push_str(&reason(selection));
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
    let best = &selection.rivals[selection.recommended];
    let mut text = format!("  recommended: \"{}\", the lowest BIC", best.name);
    if let Some(test) = &best.against {
        let _ = write!(
            text,
            "; its {} further unknowns over \"{}\" would all be zero with a probability of {}",
            test.further,
            selection.rivals[test.nested].name,
            probability(test.probability)
        );
    }
    let others = selection.rivals.iter().enumerate().filter(|(n, _)| *n != selection.recommended).map(|(_, r)| r);
    if let Some(second) = others.min_by(|a, b| a.bic.total_cmp(&b.bic)) {
        let _ = write!(text, "; the next, \"{}\", is {:.1} behind", second.name, second.bic - best.bic);
    }
    let sound = selection.rivals.iter().filter(|rival| rival.converged);
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
