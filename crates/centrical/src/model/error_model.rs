//! The unit's error model: reading = ideal specific force + a sum of monomial terms per axis [K4.1], [K4.2].

use centrical_compensate::Monomial;
use nalgebra::{Matrix3, Vector3};

use super::group::Group;

/// `f' = f + sum_t c_t m_t(f) e_axis(t)`: a list of terms; their coefficients `c_t` are parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorModel {
    /// The terms in the order of their parameters.
    pub terms: Vec<Term>,
}

/// One term of the error model.
#[derive(Debug, Clone, PartialEq)]
pub struct Term {
    /// Name of its coefficient: `G0_21`.
    pub name: String,
    /// Group of the coefficient.
    pub group: Group,
    /// Newtonometer it acts on, 0 to 2.
    pub axis: usize,
    /// What multiplies the coefficient.
    pub monomial: Monomial,
}

/// An error model about a specific force.
pub(crate) struct Expanded {
    /// `f'` [m/s^2].
    pub reading: Vector3<f64>,
    /// `d f' / d f`.
    pub gain: Matrix3<f64>,
}

/// Terms beyond the source's model, which its text permits ("for example"), each off by default.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Extra {
    /// The cross terms `K_ip f_i f_p`, `K_io f_i f_o`, `K_po f_p f_o` of IEEE Std 1293: for every newtonometer `i`
    /// the products of two of the three components, 9 coefficients `K_1[f1*f2]`, ... Which of the other two axes is
    /// the pendulous axis `p` and which the output axis `o` is the sensor's affair and changes no product.
    CrossProducts,
    /// The cubes of the two other components, `f_j^3`, `j != i`: 6 coefficients `K_1[f2^3]`, ...
    CrossCubes,
    /// The products of three components that are no cubes: `f_j^2 f_k`, `j != k`, and `f_1 f_2 f_3`, 21 coefficients
    /// `K_1[f1^2*f2]`, ... With `kozlov-2017`, the cross products and the cross cubes, the power series to the third degree is
    /// complete.
    CubicProducts,
    /// The even quadratic terms `K_ii f_i^2` of IEEE Std 1293: 3 coefficients `G1_11`, ..., which the source's model has and a coarser one lacks.
    OwnSquares,
    /// The squares of the two other components, `f_j^2`, `j != i`: 6 coefficients `G1_12`, ..., which the source's model has.
    CrossSquares,
    /// The cubes `f_i^3`: 3 coefficients `G2_11`, ..., which the source's model has.
    OwnCubes,
    /// The odd quadratic terms `K_oq f_i |f_i|` of IEEE Std 1293: 3 coefficients `K_1[f1*|f1|]`, ...
    OddQuadratic,
    /// The difference of the scales for positive and negative forces, `|f_i|` (IEEE Std 1293): 3 coefficients `K_1[|f1|]`, ...
    Asymmetry,
    /// `f_i^4`: 3 coefficients `K_1[f1^4]`, ...
    FourthPower,
    /// `f_i^5`: 3 coefficients `K_1[f1^5]`, ...
    FifthPower,
    /// A jump of the bias where the force changes its sign, `sgn f_i`: 3 coefficients `K_1[sgn f1]`, ...
    Jump,
}

impl Extra {
    /// Every extra with its name as written in sessions.
    pub const NAMED: [(&'static str, Self); 11] = [
        ("cross-products", Self::CrossProducts),
        ("cross-cubes", Self::CrossCubes),
        ("cubic-products", Self::CubicProducts),
        ("own-squares", Self::OwnSquares),
        ("cross-squares", Self::CrossSquares),
        ("own-cubes", Self::OwnCubes),
        ("odd-quadratic", Self::OddQuadratic),
        ("asymmetry", Self::Asymmetry),
        ("fourth-power", Self::FourthPower),
        ("fifth-power", Self::FifthPower),
        ("jump", Self::Jump),
    ];

    /// The extra of a name, if it is one of [`Extra::NAMED`].
    pub fn named(name: &str) -> Option<Self> {
        Self::NAMED.iter().find(|(known, _)| *known == name).map(|(_, extra)| *extra)
    }

    /// Its name as written in sessions.
    pub fn name(self) -> &'static str {
        Self::NAMED.iter().find(|(_, extra)| *extra == self).map_or("", |(name, _)| name)
    }

    /// Its terms, newtonometer by newtonometer.
    pub fn terms(self) -> Vec<Term> {
        let others = |axis: usize| [(axis + 1) % 3, (axis + 2) % 3];
        let monomials = |axis: usize| match self {
            Self::CrossProducts => {
                let [p, o] = others(axis);
                vec![Monomial::product(&[axis, p]), Monomial::product(&[axis, o]), Monomial::product(&[p, o])]
            }
            Self::CrossCubes => others(axis).map(|j| Monomial::power(j, 3)).to_vec(),
            Self::CubicProducts => {
                let with_square = (0..3).flat_map(|j| others(j).map(|k| Monomial::product(&[j, j, k])));
                with_square.chain([Monomial::product(&[0, 1, 2])]).collect()
            }
            Self::OwnSquares => vec![Monomial::power(axis, 2)],
            Self::CrossSquares => others(axis).map(|j| Monomial::power(j, 2)).to_vec(),
            Self::OwnCubes => vec![Monomial::power(axis, 3)],
            Self::OddQuadratic => vec![Monomial::odd_square(axis)],
            Self::Asymmetry => vec![Monomial { sign_of: Some(axis), ..Monomial::power(axis, 1) }],
            Self::FourthPower => vec![Monomial::power(axis, 4)],
            Self::FifthPower => vec![Monomial::power(axis, 5)],
            Self::Jump => vec![Monomial { sign_of: Some(axis), ..Monomial::ONE }],
        };
        // A term of the source's model has its name.
        let of_source = ErrorModel::kozlov_2017().terms;
        let term = |axis: usize, monomial: Monomial| {
            let known = of_source.iter().find(|term| (term.axis, term.monomial) == (axis, monomial));
            known.cloned().unwrap_or_else(|| Term::new(axis, monomial))
        };
        (0..3).flat_map(|axis| monomials(axis).into_iter().map(move |m| term(axis, m))).collect()
    }
}

impl Term {
    /// A term beyond the presets, named after its axis and monomial: `K_1[f1*f2]`.
    pub fn new(axis: usize, monomial: Monomial) -> Self {
        let axes = monomial.powers.iter().filter(|p| **p > 0).count();
        let group = match (axes, monomial.degree()) {
            (2.., _) => Group::CrossCoupling,
            (_, 0 | 1) if monomial.sign_of.is_some() => Group::Asymmetry,
            (_, 0) => Group::Bias,
            (_, 1) if monomial.powers[axis] == 1 => Group::Scale,
            (_, 1) => Group::Misalignment,
            (_, 2) => Group::Quadratic,
            (_, 3) => Group::Cubic,
            _ => Group::HigherOrder,
        };
        Self { name: format!("K_{}[{monomial}]", axis + 1), group, axis, monomial }
    }

    /// Unit of its coefficient: reading per monomial.
    pub fn unit(&self) -> String {
        match self.monomial.degree() {
            0 => "m/s^2".to_owned(),
            1 => "1".to_owned(),
            2 => "s^2/m".to_owned(),
            d => format!("s^{}/m^{}", 2 * (d - 1), d - 1),
        }
    }
}

impl ErrorModel {
    /// The source's model, 21 coefficients [K4.2]: bias `df_i`; `G0` lower triangular (scale, misalignment);
    /// `G1` full, on squares; `G2` diagonal, on cubes.
    ///
    /// The source prints `Gamma_12` in row 2 of `Gamma^(0)`; `Gamma_21` is meant, since the upper part is
    /// zero by the choice of the instrument frame (test `g0_is_lower_triangular`).
    pub fn kozlov_2017() -> Self {
        let term = |name: String, group, axis, monomial| Term { name, group, axis, monomial };
        let mut terms: Vec<Term> =
            (0..3).map(|i| term(format!("df_{}", i + 1), Group::Bias, i, Monomial::ONE)).collect();
        for i in 0..3 {
            for j in 0..=i {
                let group = if i == j { Group::Scale } else { Group::Misalignment };
                terms.push(term(format!("G0_{}{}", i + 1, j + 1), group, i, Monomial::power(j, 1)));
            }
        }
        for i in 0..3 {
            for j in 0..3 {
                terms.push(term(format!("G1_{}{}", i + 1, j + 1), Group::Quadratic, i, Monomial::power(j, 2)));
            }
        }
        for i in 0..3 {
            terms.push(term(format!("G2_{0}{0}", i + 1), Group::Cubic, i, Monomial::power(i, 3)));
        }
        Self { terms }
    }

    /// The names that a term of newtonometer `axis` may have: that of the source's notation, and that of a term beyond the presets.
    pub fn names(axis: usize, monomial: Monomial) -> Vec<String> {
        let beyond = Term::new(axis, monomial).name;
        let components: Vec<usize> = (0..3).filter(|&j| monomial.powers[j] > 0).collect();
        let of_source = match (monomial.sign_of, components.as_slice(), monomial.degree()) {
            (None, [], _) => Some(format!("df_{}", axis + 1)),
            (None, [j], degree @ 1..=3) => Some(format!("G{}_{}{}", degree - 1, axis + 1, j + 1)),
            _ => None,
        };
        of_source.into_iter().chain([beyond]).collect()
    }

    /// Whether a coefficient of this name belongs to an error model, and not to one mounting alone (`G1_11[3]`, `K_1[f1*f2][3]`).
    pub fn has_name(name: &str) -> bool {
        let of_source = Self::kozlov_2017().terms.iter().any(|term| term.name == name);
        of_source || name.starts_with("K_") && name.ends_with(']') && !name.contains("][")
    }

    /// The model with further terms at the end.
    #[must_use]
    pub fn with(mut self, extra: Extra) -> Self {
        self.terms.extend(extra.terms());
        self
    }

    /// Reading `f' = f + sum_t c_t m_t(f)` [m/s^2] of the ideal specific force `f` [m/s^2].
    pub fn reading(&self, coefficients: &[f64], f: &Vector3<f64>) -> Vector3<f64> {
        let mut reading = *f;
        for (term, c) in self.terms.iter().zip(coefficients) {
            reading[term.axis] += c * term.monomial.value((*f).into());
        }
        reading
    }

    /// The terms with their coefficients.
    pub fn with_coefficients(&self, coefficients: &[f64]) -> Vec<centrical_compensate::Term> {
        let term = |(term, c): (&Term, &f64)| centrical_compensate::Term {
            axis: term.axis,
            monomial: term.monomial,
            coefficient: *c,
        };
        self.terms.iter().zip(coefficients).map(term).collect()
    }

    /// [`ErrorModel::reading`] and its gain at `f`; `each` takes the index and value of every monomial.
    pub(crate) fn expanded(
        &self,
        coefficients: &[f64],
        f: &Vector3<f64>,
        mut each: impl FnMut(usize, f64),
    ) -> Expanded {
        let mut at = Expanded { reading: *f, gain: Matrix3::identity() };
        for (t, (term, c)) in self.terms.iter().zip(coefficients).enumerate() {
            let value = term.monomial.value((*f).into());
            each(t, value);
            // The terms of a rival have columns and no coefficients.
            if *c == 0.0 {
                continue;
            }
            at.reading[term.axis] += c * value;
            for j in 0..3 {
                if let Some((factor, lower)) = term.monomial.derivative(j) {
                    at.gain[(term.axis, j)] += factor * lower.value((*f).into()) * c;
                }
            }
        }
        at
    }
}
