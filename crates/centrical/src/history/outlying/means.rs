//! The mean of each unit in one parameter, and its error by the scatter between sessions.

use super::scale::Counted;
use crate::history::series::{Point, Series};

/// One parameter of all units: what they are by their sessions.
#[derive(Debug, Clone, PartialEq)]
pub struct UnitMeans {
    /// Mean over the sessions of each unit.
    pub values: Vec<f64>,
    /// Variances of the means by errors of the sessions.
    pub(super) variances: Vec<f64>,
    /// Differences of neighbouring sessions in standard deviations, unit by unit: they show how errors of parameters go together. Empty where
    /// there are too few.
    pub(super) differences: Vec<f64>,
}

/// Fewer differences say nothing.
const FEWEST_DIFFERENCES: usize = 10;

impl UnitMeans {
    /// Those of `units`. The variance of session `t` is `c (v_t + tau^2)`: as stated, with what neighbouring sessions show beside it, a component
    /// `tau^2` or a factor `c < 1`. Units, their drift and what sessions share cancel in differences, or nearly.
    pub fn of(units: &[Series]) -> Self {
        let pairs = || units.iter().flat_map(|unit| unit.points().windows(2));
        let differences: Vec<f64> = pairs().map(|pair| pair[1].value - pair[0].value).collect();
        let variances: Vec<f64> = pairs().map(|pair| pair[1].variance + pair[0].variance).collect();
        let counted = Counted::of(&differences, &variances).filter(|_| differences.len() >= FEWEST_DIFFERENCES);
        let (between, factor) = counted.as_ref().map_or((0.0, 1.0), |c| (0.5 * c.common, c.factor));
        let mean = |points: &[Point]| points.iter().map(|point| point.value).sum::<f64>() / points.len() as f64;
        let variance = |points: &[Point]| {
            factor * points.iter().map(|point| point.variance + between).sum::<f64>() / (points.len() as f64).powi(2)
        };
        Self {
            values: units.iter().map(|unit| mean(unit.points())).collect(),
            variances: units.iter().map(|unit| variance(unit.points())).collect(),
            differences: counted.map_or_else(Vec::new, |counted| counted.scores),
        }
    }
}
