//! Names of parameters as print has them.

use super::typeset::{lowered, typeset};

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

#[cfg(test)]
mod tests {
    use super::symbol;

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
}
