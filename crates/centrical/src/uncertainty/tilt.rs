//! The tilt of the axis of rotation as it is seen while spinning, against the one that the fit has from rest.
//!
//! Gravity turns once a revolution about a tilted axis: a plateau reads `Re m exp(i alpha_3)` about its mean, `m` a vector
//! of three complex amplitudes. Where the arm stood as a plateau began is unknown, so `m` is known up to a phase.
//! By the fitted model `m = p + b alpha_1 + b' alpha_2`, `b' = -i b` or `i b`, and `p` is what turns without a tilt: the
//! pull of the Earth's rotation. The projection
//! `w = b^H C^-1 m / (b^H C^-1 b)`, `C` the covariance of a quadrature, has the size of the tilt, and either of its
//! parts the variance `1 / (b^H C^-1 b)`.

use std::f64::consts::TAU;

use nalgebra::{Complex, Matrix2, Matrix3, Vector2, Vector3};

use crate::fit::{Calibration, Fit};
use crate::model::MeasurementModel;
use crate::statistics::chi_squared_tail;
use crate::uncertainty::verdict::Level;

/// The once-per-revolution term of a plateau.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OncePerRevolution {
    /// Index of the plateau's set point.
    pub set_point: usize,
    /// `c`, `s` of `c cos(Omega t) + s sin(Omega t)`, instrument axes [m/s^2].
    pub quadratures: [Vector3<f64>; 2],
    /// Covariance of either [m^2/s^4].
    pub covariance: Matrix3<f64>,
}

/// The two tilts. Squares are compared, whose expectation is known however small the tilt is.
#[derive(Debug, Clone, PartialEq)]
pub struct TiltComparison {
    /// Tilt by the fit [rad].
    pub at_rest: f64,
    /// Its standard uncertainty [rad].
    pub at_rest_uncertainty: f64,
    /// Tilt seen while spinning, all plateaus together [rad].
    pub spinning: f64,
    /// Its standard uncertainty [rad]: by the scatter of the plateaus where that is more than their noise.
    pub spinning_uncertainty: f64,
    /// What would be seen if the arm turned the other way [rad]: nothing.
    pub reversed: f64,
    /// Plateaus that tell.
    pub plateaus: usize,
    /// Plateaus in which something else turns with the arm, left out of all the rest: set point, and the tilt that it looks like [rad].
    pub disturbed: Vec<(usize, f64)>,
    /// chi^2 of the plateaus about their mean, with one degree of freedom less than plateaus.
    pub scatter_chi_squared: f64,
    /// Probability of so large a scatter by chance.
    pub scatter_probability: f64,
    /// Square of the difference of the two tilts' squares over its variance: chi^2 of one degree of freedom.
    pub chi_squared: f64,
    /// Probability of so large a difference by chance.
    pub probability: f64,
}

impl Calibration<'_> {
    /// Compares the two tilts. `None` without a term of any plateau, or if the fit does not determine the tilt.
    pub fn tilt_while_spinning(&self, terms: &[OncePerRevolution]) -> Option<TiltComparison> {
        let (fit, model) = (self.fit(), self.data().model());
        let alpha = [model.parameters().find("alpha_1")?, model.parameters().find("alpha_2")?];
        let known = [fit.value(alpha[0])?, fit.value(alpha[1])?];
        let tilt = Vector2::from(known);
        let covariance = Matrix2::from_fn(|i, j| fit.covariance(alpha[i], alpha[j]).unwrap_or(f64::NAN));
        let seen: Vec<Seen> = terms.iter().filter_map(|term| Seen::of(fit, model, alpha, term)).collect();
        // The fit's own uncertainty adds to the square of the tilt as noise adds to that of an amplitude.
        let rest = tilt.norm_squared() - covariance.trace();
        let rest_variance = 4.0 * tilt.dot(&(covariance * tilt)) + 2.0 * (covariance * covariance).trace();
        let variance = |one: &Seen| 4.0 * rest.max(0.0) * one.variance + 4.0 * one.variance * one.variance;
        let (seen, disturbed) = without_disturbed(seen, variance);
        if seen.is_empty() {
            return None;
        }
        let weight: f64 = seen.iter().map(|one| 1.0 / variance(one)).sum();
        let mean = |of: fn(&Seen) -> f64| seen.iter().map(|one| of(one) / variance(one)).sum::<f64>() / weight;
        let (spinning, reversed) = (mean(|one| one.square), mean(|one| one.reversed));
        let scatter_chi_squared: f64 = seen.iter().map(|one| (one.square - spinning).powi(2) / variance(one)).sum();
        let scatter_probability = chi_squared_tail(scatter_chi_squared, seen.len() - 1);
        let excess = if Level::Real.is_passed_by(scatter_probability) {
            scatter_chi_squared / (seen.len() - 1) as f64
        } else {
            1.0
        };
        let spinning_variance = excess / weight;
        let chi_squared = (spinning - rest).powi(2) / (spinning_variance + rest_variance);
        // u(A) = u(A^2) / 2A, and where that is more than A itself, sqrt(u(A^2)).
        let uncertainty = |square: f64, variance: f64| {
            let size = square.max(0.0).sqrt().max(0.5 * variance.sqrt().sqrt());
            variance.sqrt() / (2.0 * size)
        };
        Some(TiltComparison {
            at_rest: tilt.norm(),
            at_rest_uncertainty: uncertainty(tilt.norm_squared(), rest_variance),
            spinning: spinning.max(0.0).sqrt(),
            spinning_uncertainty: uncertainty(spinning, spinning_variance),
            reversed: reversed.max(0.0).sqrt(),
            plateaus: seen.len(),
            disturbed: disturbed.iter().map(|one| (one.set_point, one.square.max(0.0).sqrt())).collect(),
            scatter_chi_squared,
            scatter_probability,
            chi_squared,
            probability: chi_squared_tail(chi_squared, 1),
        })
    }
}

/// Takes out the plateaus that no others are like: again and again the one farthest from the mean of all others, as long as chance makes a
/// distance as large in one session of 10,000. More than a fifth of the plateaus are no exceptions: then all stay.
fn without_disturbed(seen: Vec<Seen>, variance: impl Fn(&Seen) -> f64) -> (Vec<Seen>, Vec<Seen>) {
    let count = seen.len();
    let (mut like, mut disturbed) = (seen, Vec::new());
    while like.len() > 2 {
        let weight: f64 = like.iter().map(|one| 1.0 / variance(one)).sum();
        let sum: f64 = like.iter().map(|one| one.square / variance(one)).sum();
        let distance = |one: &Seen| {
            let own = 1.0 / variance(one);
            let others = (sum - one.square * own) / (weight - own);
            (one.square - others).powi(2) / (variance(one) + 1.0 / (weight - own))
        };
        let distances = like.iter().map(distance).enumerate();
        let Some((farthest, distance)) = distances.max_by(|a, b| a.1.total_cmp(&b.1)) else { break };
        if !Level::Objection.is_passed_by(count as f64 * chi_squared_tail(distance, 1)) {
            break;
        }
        disturbed.push(like.remove(farthest));
    }
    if 5 * disturbed.len() > count {
        like.append(&mut disturbed);
        like.sort_by_key(|one| one.set_point);
    }
    (like, disturbed)
}

/// What one plateau shows.
struct Seen {
    set_point: usize,
    /// Square of the tilt [rad^2], the mean effect of noise and the Earth's rotation taken off.
    square: f64,
    /// The same of the term turned the other way.
    reversed: f64,
    /// Variance of either part of `w` [rad^2].
    variance: f64,
}

impl Seen {
    fn of(fit: &Fit, model: &MeasurementModel, alpha: [usize; 2], term: &OncePerRevolution) -> Option<Self> {
        /// Small against a radian, and so large that the difference keeps ten digits.
        const STEP: f64 = 1e-3;
        let weight = term.covariance.cholesky()?;
        let product = |a: &Amplitude, b: &Amplitude| -> Complex<f64> {
            let [re, im] = [b.map(|z| z.re), b.map(|z| z.im)].map(|part| weight.solve(&part));
            (0..3).map(|i| a[i].conj() * Complex::new(re[i], im[i])).sum()
        };
        let mut x = fit.state().to_vec();
        let expected = turning(model, term.set_point, &x);
        x[alpha[0]] += STEP;
        let b = (turning(model, term.set_point, &x) - expected) / Complex::from(STEP);
        let information = product(&b, &b).re;
        let projected = |m: &Amplitude| (product(&b, m) / information).norm_sqr();
        let [c, s] = &term.quadratures;
        let m = c.zip_map(s, |c, s| Complex::new(c, -s));
        let reversed = m.map(|z| z.conj());
        let variance = 1.0 / information;
        let tilt = fit.value(alpha[0])?.hypot(fit.value(alpha[1])?);
        let of_earth = projected(&expected) - tilt * tilt;
        let is_seen = variance.is_finite() && variance > 0.0;
        is_seen.then(|| Self {
            set_point: term.set_point,
            square: projected(&m) - of_earth - 2.0 * variance,
            reversed: projected(&reversed) - 2.0 * variance,
            variance,
        })
    }
}

type Amplitude = Vector3<Complex<f64>>;

/// First harmonic of the model's reading over the carousel angle `theta`: `m` of `Re m exp(i theta)`.
fn turning(model: &MeasurementModel, set_point: usize, x: &[f64]) -> Amplitude {
    /// Exact to the harmonics that the cubes of the error model make.
    const STEPS: u8 = 16;
    let set_point = &model.experiment().set_points[set_point];
    let at = |step: u8| {
        let angle = TAU * f64::from(step) / f64::from(STEPS);
        let reading = model.reading_at(set_point.mounting, x, [angle, set_point.omega, 0.0]);
        reading.map(|f| Complex::from_polar(2.0 * f / f64::from(STEPS), -angle))
    };
    (0..STEPS).map(at).sum()
}
