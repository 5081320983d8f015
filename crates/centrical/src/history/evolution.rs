//! How a quantity goes on: level, slope, forecast, and the date until which it stays within its limit.
//!
//! Level and slope have the uncertainties of G. Knapp and J. Hartung (Statistics in Medicine 22, 2003): the scatter about the curve is their
//! measure, with Student's t of `nu` degrees; what sessions share is added as a normal law. A forecast is of the true value after one
//! more switch-on, `x^T beta + u`. Its law is the mixture of normal laws over the confidence distribution of `tau^2` (K. Nagashima et
//! al., Statistical Methods in Medical Research 28, 2019). With `v_i = 0` that is Student's t.

use super::between::{Between, Likely};
use super::law::{NormalMixture, Part};
use super::line::{Curve, Line};
use super::quantiles::Quantiles;
use super::series::Series;
use crate::statistics::t_tail;
use crate::uncertainty::Degrees;

/// An estimate and its law.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimated {
    /// Value.
    pub value: f64,
    /// Standard uncertainty.
    pub standard_uncertainty: f64,
    spread: Spread,
}

#[derive(Debug, Clone, PartialEq)]
enum Spread {
    /// Student's t with its degrees of freedom.
    StudentsT(usize),
    /// That, and what sessions share.
    Law(NormalMixture),
}

impl Estimated {
    /// The interval that covers it with probability `coverage`.
    pub fn interval(&self, coverage: f64) -> [f64; 2] {
        match &self.spread {
            Spread::StudentsT(nu) => {
                let half = Degrees::Finite(*nu as f64).coverage_factor(coverage) * self.standard_uncertainty;
                [self.value - half, self.value + half]
            }
            Spread::Law(law) => law.interval(coverage),
        }
    }

    /// Probability of an estimate as far from zero, or farther, if the true value is zero.
    pub fn probability(&self) -> f64 {
        let below = |law: &NormalMixture| law.probability_below(0.0);
        match &self.spread {
            // Sessions that agree to the last digit have no scatter to measure it by.
            Spread::StudentsT(_) if self.value == 0.0 => 1.0,
            Spread::StudentsT(nu) => t_tail(self.value / self.standard_uncertainty, *nu as f64),
            Spread::Law(law) => 2.0 * below(law).min(1.0 - below(law)),
        }
    }
}

/// The curve of a series, with all that is likely of its component between sessions.
#[derive(Debug, Clone)]
pub struct Evolution<'a> {
    series: &'a Series,
    /// The curve for the component of Paule and Mandel.
    line: Line,
    /// Scatter about the curve over the one that its weights expect, in squares: 1 where there is a component between sessions.
    scale: f64,
    /// Cochran's `Q(0)`.
    misfit: f64,
    degrees_of_freedom: usize,
    /// chi^2 over its degrees of freedom: weight, value.
    scales: Vec<(f64, f64)>,
    /// Curves for the components of the confidence distribution: weight, `tau^2`, curve.
    likely: Vec<(f64, f64, Line)>,
}

impl Series {
    /// How the quantity goes on along a `curve`, with the component `between` its sessions and all that is `likely` of it; `None` at
    /// times that do not determine the curve.
    pub fn evolution(
        &self,
        curve: Curve,
        between: &Between,
        likely: &Likely,
        quantiles: &Quantiles,
    ) -> Option<Evolution<'_>> {
        let line = |tau: f64| Line::new(self.points(), curve, tau);
        let nu = between.degrees_of_freedom;
        let scales = quantiles.of(nu)?.iter().map(|(weight, chi_squared)| (*weight, chi_squared / nu as f64)).collect();
        let likely = likely.0.iter().map(|(weight, tau)| Some((*weight, *tau, line(*tau)?)));
        Some(Evolution {
            series: self,
            line: line(between.variance)?,
            scale: between.scale,
            misfit: between.misfit,
            degrees_of_freedom: nu,
            scales,
            likely: likely.collect::<Option<_>>()?,
        })
    }
}

impl Evolution<'_> {
    /// The value of the curve at `time`.
    pub fn level(&self, time: f64) -> Estimated {
        let shared = self.line.shared_variance_at(self.series, time);
        self.estimated(self.line.at(time), self.line.variance_at(time), shared)
    }

    /// The slope per year; `None` of a constant. Its law is a mixture over the components that are likely, as that of a forecast is: with the
    /// weights of one component alone the best two sessions of many would determine it. Sessions that state equal uncertainties leave
    /// Student's t.
    pub fn slope(&self) -> Option<Estimated> {
        let of_line = |line: &Line| line.shared_variance_of_slope(self.series);
        let of_one = self.estimated(self.line.slope, 1.0 / self.line.spread, of_line(&self.line));
        // Sessions that agree to the last digit have no component of any size.
        let law = || Spread::Law(self.slopes(of_line));
        let spread = if of_one.standard_uncertainty > 0.0 { law() } else { of_one.spread.clone() };
        self.line.spread.is_finite().then_some(Estimated { spread, ..of_one })
    }

    /// The law of the slope: a part for each value `c` of chi^2, with the variance `(Q(tau^2) / c) / spread`: `Q = c` but where the sessions scatter by less than they
    /// state, `Q(0) <= c`, and `tau^2` is zero.
    fn slopes(&self, shared: impl Fn(&Line) -> f64) -> NormalMixture {
        let part = |weight: f64, line: &Line, part_of_stated: f64| {
            let variance = part_of_stated / line.spread + shared(line);
            Part { weight, mean: line.slope, deviation: variance.sqrt() }
        };
        let at_zero = self.likely.first().filter(|(_, tau, _)| *tau == 0.0);
        let less = self.scales.iter().filter_map(|(weight, scale)| {
            let part_of_stated = self.misfit / (scale * self.degrees_of_freedom as f64);
            (part_of_stated <= 1.0).then_some(part(*weight, &at_zero?.2, part_of_stated))
        });
        let beyond = self.likely.iter().filter(|(_, tau, _)| *tau > 0.0);
        NormalMixture::new(less.chain(beyond.map(|(weight, _, line)| part(*weight, line, 1.0))))
    }

    fn estimated(&self, value: f64, weighted_variance: f64, shared: f64) -> Estimated {
        let own = self.scale * weighted_variance;
        let part = |(weight, scale): &(f64, f64)| Part {
            weight: *weight,
            mean: value,
            deviation: (own / scale + shared).sqrt(),
        };
        let spread = if shared > 0.0 {
            Spread::Law(NormalMixture::new(self.scales.iter().map(part)))
        } else {
            Spread::StudentsT(self.degrees_of_freedom)
        };
        Estimated { value, standard_uncertainty: (own + shared).sqrt(), spread }
    }

    /// The true value after a switch-on at `time`.
    pub fn forecast(&self, time: f64) -> NormalMixture {
        NormalMixture::new(self.likely.iter().map(|(weight, tau, line)| {
            let variance = tau + line.variance_at(time) + line.shared_variance_at(self.series, time);
            Part { weight: *weight, mean: line.at(time), deviation: variance.sqrt() }
        }))
    }

    /// The first time after `from` at which the true value after a switch-on is beyond `limit` of `centre` with more than the
    /// probability `1 - confidence`; `None` if that is not so until `until`. All times in years.
    ///
    /// For `centre` the value of the calibration that compensates: what is beyond is then the error of a compensated reading.
    pub fn due(&self, centre: f64, limit: f64, confidence: f64, from: f64, until: f64) -> Option<f64> {
        let is_due = |time: f64| self.forecast(time).probability_beyond(centre, limit) > 1.0 - confidence;
        let ahead = |n: u32| from + f64::from(n) * (until - from) / f64::from(STEPS_AHEAD);
        let first = (0..=STEPS_AHEAD).find(|&n| is_due(ahead(n)))?;
        let (mut before, mut due) = (ahead(first.saturating_sub(1)), ahead(first));
        while due - before > A_DAY {
            let middle = 0.5 * (before + due);
            if is_due(middle) { due = middle } else { before = middle }
        }
        Some(due)
    }
}

/// Steps in which a due date is looked for, before it is bisected to a day.
const STEPS_AHEAD: u32 = 64;

/// Days in a year.
pub const DAYS_IN_YEAR: f64 = 365.25;

/// [years]
const A_DAY: f64 = 1.0 / DAYS_IN_YEAR;
