//! Random error models of the sizes that newtonometers have, and larger.

use centrical_compensate::{Monomial, Term};
use proptest::prelude::*;

/// 1 g [m/s^2].
pub const G: f64 = 9.806_65;

/// An error model and the range it is for.
#[derive(Debug, Clone)]
pub struct Model {
    pub terms: Vec<Term>,
    pub range: f64,
}

/// A model, and a point of the cube from -1 to 1 for each of `count` specific forces.
pub fn with_points(model: impl Strategy<Value = Model>, count: usize) -> impl Strategy<Value = (Model, Vec<[f64; 3]>)> {
    (model, prop::collection::vec(prop::array::uniform3(-1.0..=1.0), count))
}

impl Model {
    /// The point of the range at `u`, which runs from -1 to 1 on each axis.
    pub fn at(&self, u: [f64; 3]) -> [f64; 3] {
        u.map(|u| u * self.range)
    }
}

/// The source's 21 terms, up to 20 mg, 5e-3, 5e-3 rad, 3e-5 /g, 3e-7 /g^2, over 1 to 200 g.
pub fn kozlov() -> impl Strategy<Value = Model> {
    (prop::array::uniform21(-1.0..=1.0), 1.0..=200.0_f64)
        .prop_map(|(u, range)| Model { terms: kozlov_terms(&u), range: range * G })
}

/// The source's terms, products, odd squares, a kink on each axis (gains that differ by sign), a fourth and a fifth
/// power.
pub fn everything() -> impl Strategy<Value = Model> {
    (kozlov(), prop::array::uniform9(-1.0..=1.0), prop::array::uniform2(-1.0..=1.0)).prop_map(|(mut model, u, v)| {
        for i in 0..3 {
            let [j, k] = [(i + 1) % 3, (i + 2) % 3];
            let mut add = |monomial, coefficient| model.terms.push(Term { axis: i, monomial, coefficient });
            add(Monomial::product(&[j, k]), 1e-5 / G * u[3 * i]);
            add(Monomial::odd_square(i), 1e-5 / G * u[3 * i + 1]);
            add(Monomial { sign_of: Some(j), ..Monomial::power(j, 1) }, 2e-3 * u[3 * i + 2]);
        }
        model.terms.push(Term::power(0, 0, 4, 1e-10 / G.powi(3) * v[0]));
        let fifth = Monomial { powers: [2, 0, 3], sign_of: None };
        model.terms.push(Term { axis: 1, monomial: fifth, coefficient: 1e-13 / G.powi(4) * v[1] });
        model
    })
}

fn kozlov_terms(u: &[f64; 21]) -> Vec<Term> {
    let mut u = u.iter();
    let mut next = |size: f64| size * u.next().unwrap();
    let mut terms = Vec::new();
    for i in 0..3 {
        terms.push(Term::power(i, i, 0, next(20e-3 * G)));
        terms.extend((0..=i).map(|j| Term::power(i, j, 1, next(5e-3))));
        terms.extend((0..3).map(|j| Term::power(i, j, 2, next(3e-5 / G))));
        terms.push(Term::power(i, i, 3, next(3e-7 / (G * G))));
    }
    terms
}
