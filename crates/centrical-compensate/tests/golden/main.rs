//! Specific forces to the bit, with `std` and without and on any machine: what rounds elsewhere shows here.

use centrical_compensate::{Compensation, Monomial, Term, reading};

fn kozlov() -> Vec<Term> {
    let mut terms = Vec::new();
    for i in 0..3 {
        terms.push(Term::power(i, i, 0, 0.05));
        terms.extend((0..=i).map(|j| Term::power(i, j, 1, 1e-3)));
        terms.extend((0..3).map(|j| Term::power(i, j, 2, -1.5e-6)));
        terms.push(Term::power(i, i, 3, 1e-9));
    }
    terms
}

/// A product of components and a kink: no fast form.
fn others() -> Vec<Term> {
    let mut terms = kozlov();
    terms.push(Term { axis: 0, monomial: Monomial::product(&[0, 1]), coefficient: 1e-6 });
    let kink = Monomial { sign_of: Some(1), ..Monomial::power(1, 1) };
    terms.push(Term { axis: 1, monomial: kink, coefficient: 3e-4 });
    terms
}

/// Bits of all specific forces of 4096 readings, folded into one number (FNV-1a by words).
fn folded(terms: &[Term]) -> u64 {
    let compensation = Compensation::new(terms, 2000.0).unwrap();
    let mut folded = 0xcbf2_9ce4_8422_2325_u64;
    for k in 0..4096_u32 {
        let u = [0.618_034, 0.414_214, 0.732_051].map(|step: f64| 2.0 * (f64::from(k) * step).fract() - 1.0);
        let f = compensation.apply(reading(terms, u.map(|u| 1999.0 * u))).unwrap();
        for f in f {
            folded = (folded ^ f.to_bits()).wrapping_mul(0x0100_0000_01b3);
        }
    }
    folded
}

#[test]
fn specific_forces_are_pinned() {
    assert_eq!(
        [folded(&kozlov()), folded(&others())].map(|bits| format!("{bits:016x}")),
        ["8ff5e0740712f63b", "91622ca59ddf12e5"]
    );
}
