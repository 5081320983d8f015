//! Plots of a noise analysis.

use centrical::noise::{Coefficient, Deviation, NoiseTerm, NoiseTerms, Spectrum};

use crate::plot::{Axis, Plot, Point, Series};

/// Stability plot: deviations with their intervals, the fitted noise terms together and each that is determined.
///
/// `name` is the estimator's, `unit` the deviations' unit.
pub fn deviation_plot(name: &str, unit: &str, deviations: &[Deviation], terms: Option<&NoiseTerms>) -> Plot {
    let points = deviations.iter().map(|d| Point::new(d.tau, d.value).with_interval(d.lower, d.upper)).collect();
    let mut plot =
        Plot::new("Stability of the reading", Axis::log("averaging time τ, s"), deviation_axis(unit, deviations))
            .with(Series::markers(name, points));
    if let (Some(terms), Some(first), Some(last)) = (terms, deviations.first(), deviations.last()) {
        let taus = between(first.tau, last.tau);
        let curve = |f: &dyn Fn(f64) -> f64| taus.iter().map(|&tau| Point::new(tau, f(tau))).collect();
        plot = plot.with(Series::line("fit", curve(&|tau| terms.allan_deviation(tau))));
        for term in NoiseTerm::ALL {
            if let Coefficient::Determined { value, .. } = terms.coefficient(term) {
                let share = |tau| term.allan_variance(value, tau).sqrt();
                plot = plot.with(Series::line(term.symbol().to_string(), curve(&share)));
            }
        }
    }
    plot
}

/// The axis spans the deviations; a term far below them all runs out of the plot.
fn deviation_axis(unit: &str, deviations: &[Deviation]) -> Axis {
    let axis = Axis::log(format!("deviation σ(τ), {unit}"));
    let low = deviations.iter().map(|d| d.lower).filter(|lower| *lower > 0.0).fold(f64::INFINITY, f64::min);
    let high = deviations.iter().map(|d| d.upper).filter(|upper| upper.is_finite()).fold(0.0, f64::max);
    if low < high { axis.with_range(low / 2.0, high * 2.0) } else { axis }
}

/// Power spectral density over frequency, without the ends of the band: the mean at frequency 0 is taken off, and
/// half the sampling rate has one side only. `unit` is the readings' unit.
pub fn spectrum_plot(unit: &str, spectrum: &Spectrum) -> Plot {
    let density =
        spectrum.frequency.iter().zip(&spectrum.density).take(spectrum.density.len().saturating_sub(1)).skip(1);
    Plot::new("Spectrum of the reading", Axis::log("frequency, Hz"), Axis::log(format!("density, ({unit})²/Hz")))
        .with(Series::line("power spectral density", density.map(|(&f, &s)| Point::new(f, s)).collect()))
}

/// Times from `first` to `last`, evenly spaced in logarithm.
fn between(first: f64, last: f64) -> Vec<f64> {
    const STEPS: u8 = 120;
    (0..=STEPS).map(|k| first * (last / first).powf(f64::from(k) / f64::from(STEPS))).collect()
}
