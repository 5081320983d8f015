//! Plots of a noise analysis.

use centrical::stability::{Coefficient, Deviation, NoiseTerm, NoiseTerms};
use centrical_session::NoiseAnalysis;

use crate::evaluation::Shown;
use crate::plot::{Axis, Plot, Point, Series};

/// Plots of an analysis, each with the name of its file: the stability of all columns, of each column with its terms,
/// and the spectra.
pub fn noise_plots(analysis: &NoiseAnalysis) -> Vec<(String, Plot)> {
    let of_each = analysis.readings.iter().filter_map(|reading| {
        let (estimator, family) = reading.noise.deviations.first()?;
        let shown = Shown::deviation(reading, *estimator);
        let terms = reading.noise.quotable().filter(|_| !estimator.is_of_phase());
        let title = format!("Stability of {}, {}", reading.name, analysis.file_name());
        let plot = deviation_plot(title, estimator.name(), &shown, family, terms);
        Some((format!("deviation-{}.svg", file_part(&reading.name)), plot))
    });
    let mut plots: Vec<(String, Plot)> = of_each.collect();
    plots.push(("spectrum.svg".to_owned(), spectra(analysis)));
    plots
}

/// A name of a column as part of a file's name.
fn file_part(name: &str) -> String {
    name.chars().map(|c| if c.is_alphanumeric() || "._-".contains(c) { c } else { '_' }).collect()
}

/// Stability plot: deviations with their intervals, the fitted noise terms together and each that is determined.
fn deviation_plot(title: String, name: &str, shown: &Shown, family: &[Deviation], terms: Option<&NoiseTerms>) -> Plot {
    let Shown { factor, unit } = shown;
    let point = |d: &Deviation| Point::new(d.tau, factor * d.value).with_interval(factor * d.lower, factor * d.upper);
    let mut plot = Plot::new(title, Axis::log("averaging time τ, s"), deviation_axis(unit, *factor, family))
        .with(Series::markers(format!("{name} deviation"), family.iter().map(point).collect()));
    if let (Some(terms), Some(first), Some(last)) = (terms, family.first(), family.last()) {
        let taus = between(first.tau, last.tau);
        let curve = |f: &dyn Fn(f64) -> f64| taus.iter().map(|&tau| Point::new(tau, factor * f(tau))).collect();
        plot = plot.with(Series::line("fit", curve(&|tau| terms.allan_deviation(tau))));
        for term in NoiseTerm::ALL {
            if let Coefficient::Determined { value, .. } = terms.coefficient(term) {
                let share = |tau| term.allan_variance(value, tau).sqrt();
                plot = plot.with(Series::line(format!("{} {}", term.symbol(), term.name()), curve(&share)));
            }
        }
    }
    plot
}

/// The axis spans the deviations; a term far below them all runs out of the plot.
fn deviation_axis(unit: &str, factor: f64, deviations: &[Deviation]) -> Axis {
    let axis = Axis::log(format!("deviation σ(τ), {unit}"));
    let low = deviations.iter().map(|d| d.lower).filter(|lower| *lower > 0.0).fold(f64::INFINITY, f64::min);
    let high = deviations.iter().map(|d| d.upper).filter(|upper| upper.is_finite()).fold(0.0, f64::max);
    if low < high { axis.with_range(factor * low / 2.0, factor * high * 2.0) } else { axis }
}

/// Root of the power spectral density over frequency, of all columns of one unit, in narrow bands.
fn spectra(analysis: &NoiseAnalysis) -> Plot {
    const BANDS_PER_OCTAVE: f64 = 24.0;
    let unit = analysis.readings.first().map_or(String::new(), |reading| Shown::reading(reading).unit);
    let title = format!("Spectrum of the reading, {}", analysis.file_name());
    let mut plot = Plot::new(title, Axis::log("frequency, Hz"), Axis::log(format!("root of the density, {unit}/√Hz")));
    for reading in &analysis.readings {
        let Ok(spectrum) = &reading.noise.spectrum else { continue };
        let factor = Shown::reading(reading).factor;
        let points =
            spectrum.bands(BANDS_PER_OCTAVE).into_iter().map(|(f, density)| Point::new(f, factor * density.sqrt()));
        plot = plot.with(Series::line(reading.name.clone(), points.collect()));
    }
    plot
}

/// Times from `first` to `last`, evenly spaced in logarithm.
fn between(first: f64, last: f64) -> Vec<f64> {
    const STEPS: u8 = 120;
    (0..=STEPS).map(|k| first * (last / first).powf(f64::from(k) / f64::from(STEPS))).collect()
}
