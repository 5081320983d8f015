//! The component between sessions, level and slope beside metafor 3.8-1 (R), which `metafor/generate.R` calls; Welch's test beside R.

use centrical::history::{BatchTest, Between, Curve, Likely, Point, Quantiles, Series};
use centrical::nalgebra::DMatrix;

const POINTS: &str = include_str!("metafor/points.csv");
const RESULTS: &str = include_str!("metafor/metafor.csv");
const WELCH: &str = include_str!("metafor/welch.txt");

/// The points of series `number`.
fn points(number: usize) -> Vec<Point> {
    let rows =
        POINTS.lines().skip(1).map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect::<Vec<f64>>());
    let of = rows.filter(|row| row[0] == number as f64);
    of.map(|row| Point { time: row[1], value: row[2], variance: row[3] }).collect()
}

/// Equal to `digits` digits: metafor prints twelve, and its iterations end earlier.
#[track_caller]
fn assert_close(what: &str, found: f64, expected: f64, digits: i32) {
    let tolerance = 10_f64.powi(-digits) * expected.abs().max(1e-3);
    assert!((found - expected).abs() <= tolerance, "{what}: found {found:e}, expected {expected:e}");
}

#[test]
fn every_row_of_metafor() {
    let mut rows = 0;
    for line in RESULTS.lines().skip(1) {
        let cells: Vec<&str> = line.split(',').map(str::trim).collect();
        let number = |column: usize| cells[column].parse::<f64>().unwrap();
        let points = points(cells[0].parse().unwrap());
        let series = Series::new(&points, &DMatrix::zeros(points.len(), 0)).unwrap();
        let curve = if cells[1] == "line" { Curve::Line } else { Curve::Constant };
        let quantiles = Quantiles::default();
        let between = Between::of(std::slice::from_ref(&series), curve, 0.95).unwrap();
        assert_close("Q", between.misfit, number(2), 11);
        assert_close("P(Q)", between.probability, number(3), 8);
        assert_close("tau^2", between.variance, number(4), 9);
        // The quantile of chi^2 is iterated to a step of 1e-8.
        assert_close("low", between.interval[0], number(5), 7);
        assert_close("high", between.interval[1], number(6), 7);

        let likely = Likely::of(std::slice::from_ref(&series), curve, &quantiles).unwrap();
        let evolution = series.evolution(curve, &between, &likely, &quantiles).unwrap();
        let level = evolution.level(number(7));
        assert_close("level", level.value, number(8), 11);
        assert_close("its uncertainty", level.standard_uncertainty, number(9), 9);
        for (found, column) in level.interval(0.95).into_iter().zip([10, 11]) {
            assert_close("its interval", found, number(column), 10);
        }
        if let Some(slope) = evolution.slope() {
            assert_close("slope", slope.value, number(12), 9);
            assert_close("its uncertainty", slope.standard_uncertainty, number(13), 9);
            // Its interval is of a mixture over tau^2, not of the likeliest alone.
            let [low, high] = slope.interval(0.95);
            let wider = (high - low) / (number(15) - number(14));
            assert!((0.9..1.1).contains(&wider), "{wider}");
        }
        rows += 1;
    }
    assert_eq!(rows, 12);
}

#[test]
fn welch_as_r_has_it() {
    let batches: Vec<Vec<f64>> = (3..=5).map(|s| points(s).iter().map(|p| p.value).collect()).collect();
    let test = BatchTest::of(&batches).unwrap();
    let printed: Vec<f64> = WELCH.split_whitespace().filter_map(|word| word.parse().ok()).collect();
    let found = [test.variance_ratio, test.degrees_of_freedom[0], test.degrees_of_freedom[1], test.probability];
    for (found, expected) in found.into_iter().zip(printed) {
        assert_close("Welch", found, expected, 9);
    }
}
