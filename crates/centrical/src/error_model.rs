//! The unit's error model: reading = ideal specific force + a sum of monomial terms per axis [K4.1], [K4.2].

use std::fmt;

use nalgebra::{Matrix3, Vector3};

use crate::group::Group;

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

/// `f1^p1 f2^p2 f3^p3`, with a sign if it is odd: `|f_j| f_j` is the square of `f_j` with the sign of `f_j`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Monomial {
    /// Powers of `f1, f2, f3`.
    pub powers: [u8; 3],
    /// Axis whose sign the monomial takes.
    pub sign_of: Option<usize>,
}

/// Terms beyond the source's model, which its text allows ("for example"), each off by default.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Extra {
    /// The cross terms `K_ip f_i f_p`, `K_io f_i f_o`, `K_po f_p f_o` of IEEE Std 1293: for every newtonometer `i`
    /// the products of two of the three components, 9 coefficients `K_1[f1*f2]`, ... Which of the other two axes is
    /// the pendulous axis `p` and which the output axis `o` is the sensor's affair and changes no product.
    CrossProducts,
    /// The odd quadratic terms `K_oq f_i |f_i|` of IEEE Std 1293: 3 coefficients `K_1[f1*|f1|]`, ...
    OddQuadratic,
}

impl Extra {
    /// The extra of a name as written in sessions: `cross-products`, `odd-quadratic`.
    pub fn named(name: &str) -> Option<Self> {
        match name {
            "cross-products" => Some(Self::CrossProducts),
            "odd-quadratic" => Some(Self::OddQuadratic),
            _ => None,
        }
    }

    /// Its terms, newtonometer by newtonometer.
    pub fn terms(self) -> Vec<Term> {
        let monomials = |axis: usize| match self {
            Self::CrossProducts => {
                let (p, o) = ((axis + 1) % 3, (axis + 2) % 3);
                vec![Monomial::product(axis, p), Monomial::product(axis, o), Monomial::product(p, o)]
            }
            Self::OddQuadratic => vec![Monomial::odd_square(axis)],
        };
        (0..3).flat_map(|axis| monomials(axis).into_iter().map(move |m| Term::new(axis, m))).collect()
    }
}

impl Term {
    /// A term beyond the presets, named after its axis and monomial: `K_1[f1*f2]`.
    pub fn new(axis: usize, monomial: Monomial) -> Self {
        let axes = monomial.powers.iter().filter(|p| **p > 0).count();
        let group = match (axes, monomial.degree()) {
            (2.., _) => Group::CrossCoupling,
            (_, 0) => Group::Bias,
            (_, 1) if monomial.sign_of.is_some() => Group::Asymmetry,
            (_, 1) if monomial.powers[axis] == 1 => Group::Scale,
            (_, 1) => Group::Misalignment,
            (_, 2) => Group::Quadratic,
            (_, 3) => Group::Cubic,
            _ => Group::HigherOrder,
        };
        Self { name: format!("K_{}[{monomial}]", axis + 1), group, axis, monomial }
    }
}

/// `f1*f2`, `f2*|f2|`, `f1^3`, `1`: axes in order, the absolute value last of its axis.
impl fmt::Display for Monomial {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut factors = Vec::new();
        for j in 0..3 {
            let absolute = u8::from(self.sign_of == Some(j) && self.powers[j] > 0);
            match self.powers[j] - absolute {
                0 => {}
                1 => factors.push(format!("f{}", j + 1)),
                power => factors.push(format!("f{}^{power}", j + 1)),
            }
            if absolute == 1 {
                factors.push(format!("|f{}|", j + 1));
            }
        }
        if factors.is_empty() { f.write_str("1") } else { f.write_str(&factors.join("*")) }
    }
}

impl Monomial {
    /// The constant 1.
    pub const ONE: Self = Self { powers: [0; 3], sign_of: None };

    /// `f_axis^power`.
    pub fn power(axis: usize, power: u8) -> Self {
        let mut powers = [0; 3];
        powers[axis] = power;
        Self { powers, sign_of: None }
    }

    /// `|f_axis| f_axis`.
    pub fn odd_square(axis: usize) -> Self {
        Self { sign_of: Some(axis), ..Self::power(axis, 2) }
    }

    /// `f_a f_b`.
    pub fn product(a: usize, b: usize) -> Self {
        let mut powers = [0; 3];
        powers[a] += 1;
        powers[b] += 1;
        Self { powers, sign_of: None }
    }

    /// Sum of the powers.
    pub fn degree(&self) -> u8 {
        self.powers.iter().sum()
    }

    /// Value at `f` [m/s^2 to the degree].
    pub fn value(&self, f: &Vector3<f64>) -> f64 {
        self.sign(f) * power(f.x, self.powers[0]) * power(f.y, self.powers[1]) * power(f.z, self.powers[2])
    }

    /// Gradient at `f`, by `f1, f2, f3`.
    pub fn gradient(&self, f: &Vector3<f64>) -> Vector3<f64> {
        let mut gradient = Vector3::zeros();
        for j in 0..3 {
            if self.powers[j] > 0 {
                let mut lower = *self;
                lower.powers[j] -= 1;
                gradient[j] = f64::from(self.powers[j]) * lower.value(f);
            }
        }
        gradient
    }

    fn sign(&self, f: &Vector3<f64>) -> f64 {
        self.sign_of.map_or(1.0, |j| if f[j] < 0.0 { -1.0 } else { 1.0 })
    }

    /// Unit of a coefficient: reading per monomial.
    pub fn coefficient_unit(&self) -> String {
        match self.degree() {
            0 => "m/s^2".to_owned(),
            1 => "1".to_owned(),
            2 => "s^2/m".to_owned(),
            d => format!("s^{}/m^{}", 2 * (d - 1), d - 1),
        }
    }
}

/// `x^n`, the powers that error models are made of without a call.
fn power(x: f64, n: u8) -> f64 {
    match n {
        0 => 1.0,
        1 => x,
        2 => x * x,
        3 => x * x * x,
        _ => x.powi(n.into()),
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
            reading[term.axis] += c * term.monomial.value(f);
        }
        reading
    }

    /// [`ErrorModel::reading`] and [`ErrorModel::gain`] at `f`; `each` is told the index and value of every monomial.
    pub(crate) fn expanded(
        &self,
        coefficients: &[f64],
        f: &Vector3<f64>,
        mut each: impl FnMut(usize, f64),
    ) -> Expanded {
        let table = [f.x, f.y, f.z].map(|x| [1.0, x, x * x, x * x * x]);
        let power = |j: usize, n: u8| table[j].get(usize::from(n)).copied().unwrap_or_else(|| f[j].powi(n.into()));
        let product = |[a, b, c]: [u8; 3], sign: f64| sign * power(0, a) * power(1, b) * power(2, c);
        let mut at = Expanded { reading: *f, gain: Matrix3::identity() };
        for (t, (term, c)) in self.terms.iter().zip(coefficients).enumerate() {
            let Monomial { powers, .. } = term.monomial;
            let sign = term.monomial.sign(f);
            let value = product(powers, sign);
            each(t, value);
            at.reading[term.axis] += c * value;
            for j in (0..3).filter(|&j| powers[j] > 0) {
                let mut lower = powers;
                lower[j] -= 1;
                at.gain[(term.axis, j)] += f64::from(powers[j]) * product(lower, sign) * c;
            }
        }
        at
    }

    /// `d f' / d f` at `f`, dimensionless.
    pub fn gain(&self, coefficients: &[f64], f: &Vector3<f64>) -> Matrix3<f64> {
        let mut gain = Matrix3::identity();
        for (term, c) in self.terms.iter().zip(coefficients) {
            let mut row = gain.row_mut(term.axis);
            row += term.monomial.gradient(f).transpose() * *c;
        }
        gain
    }
}
