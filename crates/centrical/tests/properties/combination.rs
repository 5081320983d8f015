use centrical::ThirdPosition::AxisOneUp;
use centrical::{Combination, ErrorModel, Extra, MeasurementModel, PairRelation, Parameters};

use crate::common::{Random, experiment};

fn parameters() -> Parameters {
    let mut experiment = experiment(AxisOneUp, PairRelation::Common, &[1.0, 0.5]);
    // Names are the laboratory's own.
    "up - left + 2".clone_into(&mut experiment.positions[0].id);
    let model = MeasurementModel::new(experiment, ErrorModel::kozlov_2017().with(Extra::CrossProducts), &[]);
    model.parameters().clone()
}

/// What is written is read again, whatever the names, the signs and the order.
#[test]
fn text_is_read_again() {
    let mut random = Random::new(50);
    let parameters = parameters();
    for _ in 0..200 {
        let count = 1 + random.below(6);
        let terms = (0..count).map(|_| (random.below(parameters.len()), (random.below(4001) as f64 - 2000.0) / 8.0));
        let terms: Vec<_> = terms.map(|(j, c)| (j, c.round())).collect();
        let combination = Combination::new(terms);
        if !combination.terms().is_empty() {
            let text = combination.text(&parameters);
            assert_eq!(Combination::parse(&text, &parameters).as_ref(), Ok(&combination), "{text}");
        }
    }
}

#[test]
fn forms_of_the_same_combination() {
    let parameters = parameters();
    let expected = Combination::new([(27, -2.0), (20, 1.0), (21, 0.5)]);
    for text in [
        "-2 drho_33 + dR_1[A] + 0.5 dR_2[A]",
        "  dR_1[A]+5e-1*dR_2[A] -2.0 * drho_33",
        "- drho_33 + dR_1[A] - drho_33 + .5dR_2[A]",
        "+dR_1[A] + 50E-2 dR_2[A] - 2drho_33",
    ] {
        let parsed = Combination::parse(text, &parameters).unwrap();
        let mut terms = parsed.terms().to_vec();
        let mut wanted = expected.terms().to_vec();
        terms.sort_by_key(|(j, _)| *j);
        wanted.sort_by_key(|(j, _)| *j);
        assert_eq!(terms, wanted, "{text}");
    }
}

#[test]
fn what_is_no_combination_is_refused_with_its_place() {
    let parameters = parameters();
    let message = |text: &str| Combination::parse(text, &parameters).unwrap_err().to_string();
    for (text, expected) in [
        ("", "combination, character 1: found the end, expected a parameter such as alpha_1"),
        ("dR_2[A] +", "combination, character 10: found the end, expected a parameter such as alpha_1"),
        ("dR_2[A] drho_22", "combination, character 9: found \"drho_22\", expected + or -"),
        ("2 dR_2[D]", "combination, character 3: found \"dR_2[D]\", expected a parameter such as dR_2[A]"),
        ("dR_2[A] - 3", "combination, character 12: found the end, expected a parameter such as alpha_1"),
        ("dR_2[A] * 3", "combination, character 9: found \"*\", expected + or -"),
    ] {
        assert_eq!(message(text), expected, "{text}");
    }
}
