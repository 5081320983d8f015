//! The weighted mean of a series, or the weighted line through it.

use super::series::{Point, Series};

/// What a quantity follows beside its scatter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Curve {
    /// A constant.
    Constant,
    /// A line in time.
    Line,
}

impl Curve {
    /// Unknowns.
    pub const fn unknowns(self) -> usize {
        match self {
            Self::Constant => 1,
            Self::Line => 2,
        }
    }
}

/// The curve for one component `tau^2` between sessions, with weights `w_i = 1 / (v_i + tau^2)`.
#[derive(Debug, Clone)]
pub struct Line {
    weights: Vec<f64>,
    /// Sum of the weights.
    sum: f64,
    /// Weighted mean of the times.
    pub middle: f64,
    /// Value there.
    pub level: f64,
    /// Slope per year; zero of a constant.
    pub slope: f64,
    /// `sum w (t - middle)^2`; infinite of a constant, whose slope is known.
    pub spread: f64,
    /// `sum w r^2` of the residuals `r`: Cochran's Q for this `tau^2`.
    pub misfit: f64,
    /// `-dQ / d tau^2 = sum w^2 r^2`: the estimates make Q a minimum, so that their changes do not count.
    pub fall: f64,
}

impl Line {
    /// `None` if the times do not determine the curve.
    pub fn new(points: &[Point], curve: Curve, variance_between: f64) -> Option<Self> {
        Self::with_room(Vec::new(), points, curve, variance_between)
    }

    /// The same with the weights in `room`, whatever it holds.
    pub fn with_room(room: Vec<f64>, points: &[Point], curve: Curve, variance_between: f64) -> Option<Self> {
        let mut weights = room;
        weights.clear();
        weights.extend(points.iter().map(|p| 1.0 / (p.variance + variance_between)));
        let weighted = |f: &dyn Fn(&Point) -> f64| -> f64 { points.iter().zip(&weights).map(|(p, w)| w * f(p)).sum() };
        let sum = weighted(&|_| 1.0);
        let (middle, level) = (weighted(&|p| p.time) / sum, weighted(&|p| p.value) / sum);
        let (slope, spread) = match curve {
            Curve::Constant => (0.0, f64::INFINITY),
            Curve::Line => {
                let spread = weighted(&|p| (p.time - middle).powi(2));
                (weighted(&|p| (p.time - middle) * (p.value - level)) / spread, spread)
            }
        };
        let is_determined = points.len() >= curve.unknowns() && slope.is_finite() && spread > 0.0;
        let residual = |p: &Point| p.value - level - slope * (p.time - middle);
        let (mut misfit, mut fall) = (0.0, 0.0);
        for (point, weight) in points.iter().zip(&weights) {
            let part = weight * residual(point).powi(2);
            misfit += part;
            fall += weight * part;
        }
        is_determined.then_some(Self { weights, sum, middle, level, slope, spread, misfit, fall })
    }

    /// The room of the weights.
    pub fn into_room(self) -> Vec<f64> {
        self.weights
    }

    /// Value at `time`.
    pub fn at(&self, time: f64) -> f64 {
        self.level + self.slope * (time - self.middle)
    }

    /// Variance of the value at `time` by what belongs to single sessions.
    pub fn variance_at(&self, time: f64) -> f64 {
        1.0 / self.sum + (time - self.middle).powi(2) / self.spread
    }

    /// Variance of the value at `time` by what sessions share.
    pub fn shared_variance_at(&self, series: &Series, time: f64) -> f64 {
        let lever = (time - self.middle) / self.spread;
        let share = |(p, w): (&Point, &f64)| w * (1.0 / self.sum + lever * (p.time - self.middle));
        let coefficients: Vec<f64> = series.points().iter().zip(&self.weights).map(share).collect();
        series.shared_variance(&coefficients)
    }

    /// Variance of the slope by what sessions share.
    pub fn shared_variance_of_slope(&self, series: &Series) -> f64 {
        let share = |(p, w): (&Point, &f64)| w * (p.time - self.middle) / self.spread;
        let coefficients: Vec<f64> = series.points().iter().zip(&self.weights).map(share).collect();
        series.shared_variance(&coefficients)
    }
}
