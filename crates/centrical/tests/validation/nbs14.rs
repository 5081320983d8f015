//! The NBS data sets: nine readings of NBS Monograph 140, Annex 8.E, and Riley's 1000 pseudo-random readings.

use centrical::stability::{Deviation, Estimator, Phase, PowerLaw};
use centrical::unwatched;

const RILEY: &str = include_str!("nbs14/riley_tables.csv");
const STABLE32: &str = include_str!("nbs14/stable32.csv");
const ALLANTOOLS: &str = include_str!("nbs14/allantools_reference.csv");

/// Confidence of one standard deviation, `erf(1 / sqrt(2))`.
const ONE_SIGMA: f64 = 0.682_689_492_137_085_9;

/// SP 1065, table 29.
const NINE: [f64; 9] = [892.0, 809.0, 823.0, 798.0, 671.0, 644.0, 883.0, 903.0, 677.0];

/// SP 1065, section 12.4: `n_(i+1) = 16807 n_i mod 2147483647`, n_0 = 1234567890, reading n_i / 2147483647.
fn thousand() -> Vec<f64> {
    let next = |n: &u64| Some(16807 * n % 2_147_483_647);
    std::iter::successors(Some(1_234_567_890), next).take(1000).map(|n| n as f64 / 2_147_483_647.0).collect()
}

fn phase(readings: &[f64]) -> Phase {
    Phase::integrate(readings, 1.0, &unwatched).unwrap()
}

fn rows(table: &str) -> impl Iterator<Item = Vec<&str>> {
    table.lines().filter(|line| !line.starts_with('#')).map(|line| line.split(',').collect())
}

fn estimator(name: &str) -> Estimator {
    Estimator::ALL.into_iter().find(|e| format!("{e:?}") == name).unwrap_or_else(|| panic!("no estimator {name}"))
}

/// `computed` rounds to what is printed, give or take `units` of its last digit.
fn assert_printed(what: &str, computed: f64, printed: &str, units: f64) {
    let (mantissa, exponent) = printed.split_once('e').unwrap_or((printed, "0"));
    let decimals = mantissa.split_once('.').map_or(0, |(_, digits)| digits.len());
    let unit = 10_f64.powi(exponent.parse::<i32>().unwrap() - i32::try_from(decimals).unwrap());
    let value: f64 = printed.parse().unwrap();
    assert!((computed - value).abs() <= units * unit, "{what}: computed {computed:e}, printed {printed}");
}

fn single(phase: &Phase, estimator: Estimator, m: usize) -> Deviation {
    phase.deviations(estimator, &[m], ONE_SIGMA, &unwatched).unwrap()[0]
}

fn standard_deviation(readings: &[f64], m: usize) -> f64 {
    let means: Vec<f64> = readings.chunks_exact(m).map(|chunk| chunk.iter().sum::<f64>() / m as f64).collect();
    let mean = means.iter().sum::<f64>() / means.len() as f64;
    (means.iter().map(|y| (y - mean).powi(2)).sum::<f64>() / (means.len() - 1) as f64).sqrt()
}

#[test]
fn the_thousand_readings_are_those_of_the_source() {
    // SP 1065, p. 108, prints the first four numbers of the sequence.
    let printed = [1_234_567_890_u64, 395_529_916, 1_209_410_747, 633_705_974];
    let sequence: Vec<f64> = thousand()[..4].iter().map(|y| (y * 2_147_483_647.0).round()).collect();
    assert_eq!(sequence, printed.map(|n| n as f64));
}

/// SP 1065, tables 30 and 31, every row and column.
///
/// One unit of the last digit: the table itself prints one and the same quantity, the Hadamard deviation of the nine
/// readings at m = 1, as 70.80608 and as 70.80607.
#[test]
fn every_deviation_of_riley_tables_30_and_31() {
    let columns: [(&[f64], usize); 5] =
        [(&NINE, 1), (&NINE, 2), (&thousand(), 1), (&thousand(), 10), (&thousand(), 100)];
    let mut cells = 0;
    for row in rows(RILEY) {
        for ((readings, m), printed) in columns.iter().zip(&row[1..]) {
            let computed = if row[0] == "standard deviation" {
                standard_deviation(readings, *m)
            } else {
                white(&phase(readings), estimator(row[0]), *m)
            };
            assert_printed(&format!("{} of {} readings at m = {m}", row[0], readings.len()), computed, printed, 1.0);
            cells += 1;
        }
    }
    assert_eq!(cells, 11 * 5);
}

/// The deviation corrected for the bias of white readings, which the tables take the data for.
fn white(phase: &Phase, estimator: Estimator, m: usize) -> f64 {
    let deviation = single(phase, estimator, m);
    assert_eq!(deviation.law, PowerLaw::White);
    deviation.value
}

/// Every value Stable32 prints for the 1000 readings, to half a unit of the last digit (and a little, for what lies
/// next to a tie).
#[test]
fn every_value_of_stable32() {
    let phase = phase(&thousand());
    let mut cells = 0;
    for row in rows(STABLE32) {
        let m: usize = row[1].parse().unwrap();
        let (variance, terms) = estimator(row[0]).variance(&phase, m).unwrap();
        // Stable32 corrects the Hadamard total alone, where it takes the noise for white.
        let is_corrected = row[0] == "HadamardTotal" && m > 1 && row[3] == "0";
        let computed = (variance / if is_corrected { 0.995 } else { 1.0 }).sqrt();
        assert_printed(&format!("{} at m = {m}", row[0]), computed, row[5], 0.51);
        assert_eq!(terms.to_string(), row[2], "terms of {} at m = {m}", row[0]);
        cells += 1;
    }
    assert_eq!(cells, 84);
}

/// Stable32's intervals, for white readings, to 1 % of their half width (the chi^2 quantiles of Stable32 are
/// approximate: above a hundred degrees of freedom its intervals are 0.5 % too narrow).
///
/// The difference estimators and the total deviation at every tau, the Hadamard total where its formula holds. The
/// modified total is left out: Stable32's own degrees of freedom (about 1.33 T/tau - 1.9) are not those of SP 1065,
/// table 8 (1.10 T/tau - 1.2), which are the more cautious.
#[test]
fn every_interval_of_stable32() {
    let phase = phase(&thousand());
    let mut cells = 0;
    for row in rows(STABLE32).filter(|row| !row[4].is_empty()) {
        let m: usize = row[1].parse().unwrap();
        let is_from_table = match row[0] {
            "ModifiedTotal" | "TimeTotal" => false,
            "HadamardTotal" => m >= 16 && row[3] == "0",
            _ => true,
        };
        if !is_from_table {
            continue;
        }
        let deviation = single(&phase, estimator(row[0]), m);
        assert_eq!(deviation.law.alpha().to_string(), row[3], "power law of {} at m = {m}", row[0]);
        let half_width = 0.5 * (deviation.upper - deviation.lower);
        for (computed, printed) in [(deviation.lower, row[4]), (deviation.upper, row[6])] {
            let difference = (computed - printed.parse::<f64>().unwrap()).abs() / half_width;
            assert!(difference < 0.01, "{row:?}: {computed:e} is {difference} half widths from {printed}");
        }
        cells += 1;
    }
    assert_eq!(cells, 60);
}

/// Every estimator by allantools, to the rounding of sums of a thousand.
#[test]
fn every_deviation_of_allantools() {
    let (nine, thousand) = (phase(&NINE), phase(&thousand()));
    let mut cells = 0;
    for row in rows(ALLANTOOLS).filter(|row| row[0] == "deviation") {
        let phase = if row[1] == "nine" { &nine } else { &thousand };
        let m: usize = row[3].parse().unwrap();
        let computed = estimator(row[2]).variance(phase, m).unwrap().0.sqrt();
        let expected: f64 = row[4].parse().unwrap();
        assert!((computed / expected - 1.0).abs() < 1e-10, "{row:?}: computed {computed:e}");
        cells += 1;
    }
    assert_eq!(cells, 100);
}

/// Greenhall and Riley's degrees of freedom by allantools: every noise, estimator and branch of the algorithm that
/// allantools has.
#[test]
fn every_degree_of_freedom_of_allantools() {
    let mut cells = 0;
    for row in rows(ALLANTOOLS).filter(|row| row[0] == "freedom") {
        let law = PowerLaw::ALL.into_iter().find(|law| law.alpha().to_string() == row[4]).unwrap();
        let computed = estimator(row[2]).degrees_of_freedom(law, row[3].parse().unwrap(), row[1].parse().unwrap());
        let expected: f64 = row[5].parse().unwrap();
        // Rounding in s_w grows with F^2 |t|^(3 - alpha): 1e-6 is what the largest F and |t| leave of 16 digits.
        assert!((computed / expected - 1.0).abs() < 1e-6, "{row:?}: computed {computed}");
        cells += 1;
    }
    assert_eq!(cells, 581);
}
