//! Charts of D. C. Montgomery, "Introduction to Statistical Quality Control", 6th edition, tables 9.1 and 9.2 (CUSUM), 9.10 and 9.11 (EWMA): every row.

use centrical::history::{Control, Rule};

/// Table 9.1: twenty values about 10, ten about 11, standard deviation 1.
const VALUES: [f64; 30] = [
    9.45, 7.99, 9.29, 11.66, 12.16, 10.18, 8.04, 11.46, 9.20, 10.34, 9.03, 11.47, 10.51, 9.40, 10.08, 9.37, 10.62,
    10.31, 8.52, 10.84, 10.90, 9.33, 12.29, 11.50, 10.60, 11.08, 10.38, 11.62, 11.31, 10.52,
];

const CONTROL: Control = Control { centre: 10.0, deviation: 1.0 };

#[test]
fn the_cusum_of_table_9_2() {
    let upper = [
        0.0, 0.0, 0.0, 1.16, 2.82, 2.50, 0.04, 1.00, 0.0, 0.0, 0.0, 0.97, 0.98, 0.0, 0.0, 0.0, 0.12, 0.0, 0.0, 0.34,
        0.74, 0.0, 1.79, 2.79, 2.89, 3.47, 3.35, 4.47, 5.28, 5.30,
    ];
    let lower = [
        0.05, 1.56, 1.77, 0.0, 0.0, 0.0, 1.46, 0.0, 0.30, 0.0, 0.47, 0.0, 0.0, 0.10, 0.0, 0.13, 0.0, 0.0, 0.98, 0.0,
        0.0, 0.17, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
    ];
    let chart = CONTROL.cusum(&VALUES, 0.5, 5.0);
    for (found, printed) in chart.upper.iter().chain(&chart.lower).zip(upper.iter().chain(&lower)) {
        assert!((found - printed).abs() < 0.005 + 1e-9, "found {found}, printed {printed}");
    }
    assert_eq!(chart.signals, [28, 29]);
}

#[test]
fn the_ewma_of_table_9_11() {
    let printed = [
        9.945, 9.7495, 9.70355, 9.8992, 10.1253, 10.1307, 9.92167, 10.0755, 9.98796, 10.0232, 9.92384, 10.0785,
        10.1216, 10.0495, 10.0525, 9.98426, 10.0478, 10.074, 9.91864, 10.0108, 10.0997, 10.0227, 10.2495, 10.3745,
        10.3971, 10.4654, 10.4568, 10.5731, 10.6468, 10.6341,
    ];
    let chart = CONTROL.ewma(&VALUES, 0.1, 2.7);
    for (found, printed) in chart.means.iter().zip(printed) {
        assert!((found - printed).abs() < 0.6e-4, "found {found}, printed {printed}");
    }
    // The book: 9.38 to 10.62 in the end, and a signal at observation 28 of the text, 29 of the table.
    assert!((chart.half_widths[29] - 0.62).abs() < 0.005 && (chart.half_widths[0] - 0.27).abs() < 0.005);
    assert_eq!(chart.signals, [28, 29]);
}

/// Each rule on a series made of its words, and not one value earlier.
#[test]
fn each_rule_in_its_own_words() {
    let alternating: Vec<f64> = (0..14).map(|n| if n % 2 == 0 { 0.9 } else { -0.9 } + 1e-3 * f64::from(n)).collect();
    let cases: [(Rule, Vec<f64>); 9] = [
        (Rule::Beyond, vec![-3.1]),
        (Rule::Nine, vec![0.1; 9]),
        (Rule::Eight, vec![-0.1; 8]),
        (Rule::SixSteady, vec![-0.5, -0.3, 0.0, 0.1, 0.2, 0.9]),
        (Rule::FourteenAlternating, alternating),
        (Rule::TwoOfThree, vec![2.1, 0.0, 2.2]),
        (Rule::FourOfFive, vec![-1.1, -1.2, 0.5, -1.1, -1.5]),
        (Rule::FifteenWithin, [0.5, -0.5, 0.2].repeat(5)),
        (Rule::EightBeyond, [1.5, -1.5].repeat(4)),
    ];
    for (rule, z) in cases {
        let values: Vec<f64> = z.iter().map(|z| 10.0 + z).collect();
        assert_eq!(CONTROL.signals(&values, &[rule]), [(values.len() - 1, rule)], "{rule:?}");
        assert!(CONTROL.signals(&values[..values.len() - 1], &[rule]).is_empty(), "{rule:?}");
    }
}

/// Limits from accepted values, with the factors as the tables print them: d2 1.128, 3 / d2 2.66, D4 3.267.
#[test]
fn limits_from_accepted_values() {
    let control = Control::of(&[1.0, 3.0, 2.0, 4.0]).unwrap();
    let mean_range = 5.0 / 3.0;
    assert_eq!((Control::moving_ranges(&[1.0, 3.0, 2.0, 4.0]), control.centre), (vec![2.0, 1.0, 2.0], 2.5));
    for (found, printed, half_digit) in [
        (mean_range / control.deviation, 1.128, 5e-4),
        ((control.limits()[1] - 2.5) / mean_range, 2.66, 5e-3),
        (control.range_limit() / mean_range, 3.267, 5e-4),
    ] {
        assert!((found - printed).abs() <= half_digit, "found {found}, printed {printed}");
    }
}
