//! A noise analysis as tables and plots.

use std::fmt::Write;

use centrical::STANDARD_GRAVITY;
use centrical::stability::{Analysis, Coefficient, Deviation, Estimator, NoiseTerm, NoiseTerms};
use centrical_session::{NoiseAnalysis, ReadingNoise};

use crate::customary::with_uncertainty;
use crate::plot::{Axis, Plot, Point, Series};

/// How the numbers of one column are shown.
struct Shown {
    /// Shown value over the value in the readings' unit.
    factor: f64,
    unit: String,
}

impl Shown {
    /// Readings: accelerations in ug.
    fn reading(reading: &ReadingNoise) -> Self {
        if reading.unit == "m/s^2" {
            Self { factor: 1e6 / STANDARD_GRAVITY, unit: "ug".to_owned() }
        } else {
            Self { factor: 1.0, unit: reading.unit.clone() }
        }
    }

    /// Their integral over time.
    fn phase(reading: &ReadingNoise) -> Self {
        if reading.unit == "m/s^2" {
            Self { factor: 1e6, unit: "um/s".to_owned() }
        } else {
            Self { factor: 1.0, unit: format!("{} s", reading.unit) }
        }
    }

    fn deviation(reading: &ReadingNoise, estimator: Estimator) -> Self {
        if estimator.is_of_phase() { Self::phase(reading) } else { Self::reading(reading) }
    }

    fn coefficient(reading: &ReadingNoise, term: NoiseTerm) -> Self {
        let Self { factor, unit } = Self::reading(reading);
        let per = |what: &str| Self { factor, unit: format!("{unit}{what}") };
        match term {
            NoiseTerm::Quantisation => Self::phase(reading),
            NoiseTerm::White => per("/sqrt(Hz)"),
            NoiseTerm::BiasInstability => per(""),
            NoiseTerm::RandomWalk => per("/sqrt(s)"),
            NoiseTerm::Ramp => per("/s"),
        }
    }
}

/// The analysis as text: for each column its deviations with their intervals, its spectrum by octaves, its terms.
pub fn noise_table(analysis: &NoiseAnalysis) -> String {
    let [from, to] = analysis.window;
    let mut text = format!("{}, {from:.3} s to {to:.3} s\n", analysis.file_name());
    let _ = writeln!(
        text,
        "intervals [lower, upper] hold the true value with {:.1} %; 1 g = 9.80665 m/s^2",
        100.0 * analysis.confidence
    );
    for reading in &analysis.readings {
        heading(&mut text, reading);
        stability(&mut text, reading);
        spectrum(&mut text, reading);
        terms(&mut text, reading);
    }
    text
}

fn heading(text: &mut String, reading: &ReadingNoise) {
    let ReadingNoise { name, noise: Analysis { samples, interval, spikes, repeated, gaps, .. }, .. } = reading;
    let _ = write!(text, "\n{}  {samples} readings every {interval:.6} s", name.to_uppercase());
    if gaps.missing > 0 {
        let _ = write!(text, "; missing: {}, the longest run {}", gaps.missing, gaps.longest);
    }
    if *repeated > 0 {
        let _ = write!(text, "; repeated: {repeated}");
    }
    if *spikes > 0 {
        let _ = write!(text, "; left out as spikes: {spikes}");
    }
    text.push('\n');
}

/// One table: a row for each averaging time, a column for each estimator.
fn stability(text: &mut String, reading: &ReadingNoise) {
    const CELL: usize = 34;
    let title = |e: Estimator| format!("{}, {}", e.name(), Shown::deviation(reading, e).unit);
    let mut line = format!("  {:<12}", "tau, s");
    line.extend(reading.noise.deviations.iter().map(|(e, _)| format!("{:<CELL$}", title(*e))));
    let _ = writeln!(text, "{}", line.trim_end());
    let mut factors: Vec<(usize, f64)> = Vec::new();
    for deviation in reading.noise.deviations.iter().flat_map(|(_, family)| family) {
        if let Err(place) = factors.binary_search_by_key(&deviation.factor, |f| f.0) {
            factors.insert(place, (deviation.factor, deviation.tau));
        }
    }
    for (factor, tau) in factors {
        let mut line = format!("  {:<12}", significant(tau, 4));
        for (estimator, family) in &reading.noise.deviations {
            let shown = Shown::deviation(reading, *estimator);
            let cell = family.iter().find(|d| d.factor == factor).map_or(String::new(), |d| interval(d, shown.factor));
            let _ = write!(line, "{cell:<CELL$}");
        }
        let _ = writeln!(text, "{}", line.trim_end());
    }
}

fn interval(d: &Deviation, factor: f64) -> String {
    let [value, lower, upper] = [d.value, d.lower, d.upper].map(|v| significant(factor * v, 4));
    format!("{value:<9} [{lower}, {upper}]")
}

/// The spectrum in a line an octave, and the lines in it.
fn spectrum(text: &mut String, reading: &ReadingNoise) {
    let Shown { factor, unit } = Shown::reading(reading);
    let spectrum = match &reading.noise.spectrum {
        Ok(spectrum) => spectrum,
        Err(error) => {
            let _ = writeln!(text, "  no spectrum: {error}");
            return;
        }
    };
    let _ = writeln!(
        text,
        "  spectrum, one-sided, means of octaves; {} segments, resolution {} Hz",
        spectrum.segments,
        significant(spectrum.resolution, 3)
    );
    let _ = writeln!(text, "  {:<12}{unit}/sqrt(Hz)", "Hz");
    for band in spectrum.bands(1.0) {
        let density = factor * band.density.sqrt();
        let _ = writeln!(text, "  {:<12}{}", significant(band.frequency, 4), significant(density, 4));
    }
    for line in spectrum.lines() {
        let (frequency, amplitude) = (significant(line.frequency, 5), significant(factor * line.amplitude, 3));
        let excess = significant(line.excess, 2);
        let _ =
            writeln!(text, "  line at {frequency} Hz, amplitude {amplitude} {unit}, {excess} times the noise about it");
    }
}

fn terms(text: &mut String, reading: &ReadingNoise) {
    let Some(terms) = reading.noise.quotable() else { return };
    let _ = writeln!(
        text,
        "  noise terms (IEEE Std 952); chi^2 {:.1} with {} degrees of freedom",
        terms.chi_squared, terms.degrees_of_freedom
    );
    for term in NoiseTerm::ALL {
        let Shown { factor, unit } = Shown::coefficient(reading, term);
        let value = match terms.coefficient(term) {
            Coefficient::Determined { value, standard_uncertainty } => {
                let (value, uncertainty) = with_uncertainty(factor * value, factor * standard_uncertainty);
                format!("{value} ± {uncertainty} {unit}")
            }
            Coefficient::NotDetermined { upper_bound } if upper_bound.is_finite() => {
                format!("not seen, below {} {unit} (95 %)", significant(factor * upper_bound, 2))
            }
            Coefficient::NotDetermined { .. } => "not seen".to_owned(),
        };
        let _ = writeln!(text, "  {}  {:<18}{value}", term.symbol(), term.name());
    }
}

/// Why coefficients are not quoted, one sentence for each column of which they are not; empty if all are.
pub fn noise_warnings(analysis: &NoiseAnalysis) -> Vec<String> {
    let warning = |reading: &ReadingNoise| match &reading.noise.terms {
        Ok(terms) if terms.is_consistent() => None,
        Ok(terms) => Some(format!(
            "{}: no sum of quantisation, white noise, bias instability, random walk and ramp describes the deviations \
             (chi^2 {:.1} with {} degrees of freedom); its coefficients are not quoted",
            reading.name, terms.chi_squared, terms.degrees_of_freedom
        )),
        Err(error) => Some(format!("{}: no noise terms: {error}", reading.name)),
    };
    analysis.readings.iter().filter_map(warning).collect()
}

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

/// Root of the power spectral density over frequency, of all columns of one unit, in bands too narrow to be told apart.
fn spectra(analysis: &NoiseAnalysis) -> Plot {
    const BANDS_PER_OCTAVE: f64 = 24.0;
    let unit = analysis.readings.first().map_or(String::new(), |reading| Shown::reading(reading).unit);
    let title = format!("Spectrum of the reading, {}", analysis.file_name());
    let mut plot = Plot::new(title, Axis::log("frequency, Hz"), Axis::log(format!("root of the density, {unit}/√Hz")));
    for reading in &analysis.readings {
        let Ok(spectrum) = &reading.noise.spectrum else { continue };
        let factor = Shown::reading(reading).factor;
        let points =
            spectrum.bands(BANDS_PER_OCTAVE).into_iter().map(|b| Point::new(b.frequency, factor * b.density.sqrt()));
        plot = plot.with(Series::line(reading.name.clone(), points.collect()));
    }
    plot
}

/// Times from `first` to `last`, evenly spaced in logarithm.
fn between(first: f64, last: f64) -> Vec<f64> {
    const STEPS: u8 = 120;
    (0..=STEPS).map(|k| first * (last / first).powf(f64::from(k) / f64::from(STEPS))).collect()
}

/// A number to so many significant digits; with an exponent only where it would be long without.
fn significant(value: f64, digits: u8) -> String {
    let scientific = format!("{value:.*e}", usize::from(digits) - 1);
    // The exponent as rounded: 9.9996 has a digit more before the point than 9.9994.
    let exponent = scientific.split_once('e').and_then(|(_, exponent)| exponent.parse::<i64>().ok());
    match exponent {
        Some(exponent @ -4..7) => {
            format!("{value:.*}", usize::try_from(i64::from(digits) - 1 - exponent).unwrap_or(0))
        }
        _ => scientific,
    }
}

#[cfg(test)]
mod tests {
    use super::significant;

    #[test]
    fn digits_are_those_of_the_rounded_number() {
        let shown: Vec<String> = [9.9996, 9.9994, 0.012_345, 123_456.0, 1.2e-7, 0.0].map(|v| significant(v, 4)).into();
        assert_eq!(shown, ["10.00", "9.999", "0.01235", "123456", "1.200e-7", "0.000"]);
    }
}
