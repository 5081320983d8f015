//! Names and formulas as print has them: Greek stems, lowered indices, raised powers, a centred point.

use crate::number::raised;

/// Stems that print writes in Greek.
const GREEK: [(&str, &str); 3] = [("alpha", "α"), ("delta", "δ"), ("drho", "dρ")];

/// The parts of a parameter's name: `delta`, `2` and `[4]` of `delta_2[4]`; all of `radius_scale` is its stem.
pub(crate) struct ParameterName<'n> {
    pub stem: &'n str,
    /// Digits behind the stem.
    pub index: &'n str,
    /// The position or pair of positions in brackets.
    pub place: &'n str,
}

impl<'n> ParameterName<'n> {
    /// Takes a name apart.
    pub fn of(name: &'n str) -> Self {
        let (name, place) = name.split_at(name.find('[').unwrap_or(name.len()));
        let is_index = |index: &str| !index.is_empty() && index.bytes().all(|b| b.is_ascii_digit());
        let (stem, index) = name.rsplit_once('_').filter(|(_, index)| is_index(index)).unwrap_or((name, ""));
        Self { stem, index, place }
    }
}

/// A name of a result as print has it: `G0_21` with a lowered 21, `delta_1[6]` with a delta; a name without numbers as it is.
pub(crate) fn symbol(name: &str) -> String {
    let ParameterName { stem, index, place } = ParameterName::of(name);
    let greek = GREEK.iter().find(|(latin, _)| *latin == stem && !index.is_empty());
    format!("{}{}{}", greek.map_or(stem, |(_, greek)| greek), lowered(index), typeset(place))
}

/// The reading of a newtonometer as print has it: `f` with a lowered number.
pub(crate) fn newtonometer(axis: usize) -> String {
    format!("f{}", lowered(&axis.to_string()))
}

/// A formula of sessions as print has it: `f1^2*f3` with a raised 2, lowered 1 and 3 and a point between.
pub(crate) fn typeset(formula: &str) -> String {
    let mut after = ' ';
    let mut text = String::with_capacity(formula.len());
    for symbol in formula.chars() {
        match (symbol.to_digit(10), after) {
            (Some(_), '^') => text.push(raised(symbol)),
            (Some(_), 'f') => text.push_str(&lowered(symbol.encode_utf8(&mut [0; 4]))),
            _ => match symbol {
                '^' => {}
                '*' => text.push('·'),
                _ => text.push(symbol),
            },
        }
        // A power may have several digits.
        if !(after == '^' && symbol.is_ascii_digit()) {
            after = symbol;
        }
    }
    text
}

/// Digits lowered.
pub(crate) fn lowered(digits: &str) -> String {
    const LOWERED: [char; 10] = ['₀', '₁', '₂', '₃', '₄', '₅', '₆', '₇', '₈', '₉'];
    digits.chars().map(|c| c.to_digit(10).map_or(c, |digit| LOWERED[digit as usize])).collect()
}

#[cfg(test)]
mod tests {
    use super::{symbol, typeset};

    #[test]
    fn indices_are_lowered() {
        for (name, printed) in [
            ("df_1", "df₁"),
            ("G0_21", "G0₂₁"),
            ("delta_3[6]", "δ₃[6]"),
            ("drho_22", "dρ₂₂"),
            ("dR_1[A]", "dR₁[A]"),
            ("K_1[f1^2*f2]", "K₁[f₁²·f₂]"),
            ("radius_scale", "radius_scale"),
            ("elastic_speed_1[3]", "elastic_speed₁[3]"),
        ] {
            assert_eq!(symbol(name), printed);
        }
    }

    #[test]
    fn products_and_powers_are_typeset() {
        for (written, printed) in
            [("f1", "f₁"), ("f1^2", "f₁²"), ("f1*f2", "f₁·f₂"), ("f2*|f2|", "f₂·|f₂|"), ("f1^2*f3^12", "f₁²·f₃¹²")]
        {
            assert_eq!(typeset(written), printed);
        }
    }
}
