//! A noise analysis as text for the terminal.

use std::fmt::Write;

use centrical::reduction::Staircase;
use centrical::stability::{Analysis, Coefficient, Deviation, Estimator, NoiseTerm};
use centrical_session::{NoiseAnalysis, ReadingNoise};

use super::screen::Screen;
use super::table::{Align, Cell, Table};
use crate::evaluation::Shown;
use crate::number::{self, with_uncertainty};

/// The analysis as text, of a `part` of the file such as "Plateau 2:1 of ": for each column its deviations with their intervals, its spectrum by octaves, its terms.
pub fn noise_table(analysis: &NoiseAnalysis, part: &str) -> Screen {
    let [from, to] = analysis.window;
    let mut screen = Screen::default();
    screen.say(0, &format!("{part}{}, {from:.3} s to {to:.3} s", analysis.file_name()));
    let text = format!(
        "intervals [lower, upper] hold the true value with {:.1} %; 1 g = 9.80665 m/s^2",
        100.0 * analysis.confidence
    );
    screen.say(0, &text);
    for reading in &analysis.readings {
        heading(&mut screen, reading);
        stability(&mut screen, reading);
        spectrum(&mut screen, reading);
        terms(&mut screen, reading);
    }
    screen
}

fn heading(screen: &mut Screen, reading: &ReadingNoise) {
    let ReadingNoise { name, noise: Analysis { samples, interval, spikes, repeated, gaps, .. }, .. } = reading;
    let mut text = format!("{samples} readings every {interval:.6} s");
    if gaps.missing > 0 {
        let _ = write!(text, "; missing: {}, the longest run {}", gaps.missing, gaps.longest);
    }
    if *repeated > 0 {
        let _ = write!(text, "; repeated: {repeated}");
    }
    if *spikes > 0 {
        let _ = write!(text, "; left out as spikes: {spikes}");
    }
    screen.gap();
    screen.head(name, &text);
}

/// One table: a row for each averaging time, a column for each estimator.
fn stability(screen: &mut Screen, reading: &ReadingNoise) {
    let title = |e: Estimator| format!("{}, {}", e.name(), Shown::deviation(reading, e).unit);
    let titles = reading.noise.deviations.iter().map(|(e, _)| (title(*e), Align::Left));
    let mut table = Table::of(1, [("tau, s".to_owned(), Align::Left)].into_iter().chain(titles).collect());
    let mut factors: Vec<(usize, f64)> = Vec::new();
    for deviation in reading.noise.deviations.iter().flat_map(|(_, family)| family) {
        if let Err(place) = factors.binary_search_by_key(&deviation.factor, |f| f.0) {
            factors.insert(place, (deviation.factor, deviation.tau));
        }
    }
    for (factor, tau) in factors {
        let cells = reading.noise.deviations.iter().map(|(estimator, family)| {
            let shown = Shown::deviation(reading, *estimator);
            family.iter().find(|d| d.factor == factor).map_or(Cell::default(), |d| interval(d, shown.factor).into())
        });
        table.row([significant(tau, 4).into()].into_iter().chain(cells));
    }
    screen.table(table);
}

fn interval(d: &Deviation, factor: f64) -> String {
    let [value, lower, upper] = [d.value, d.lower, d.upper].map(|v| significant(factor * v, 4));
    format!("{value:<9} [{lower}, {upper}]")
}

/// The spectrum in a line an octave, and the lines in it.
fn spectrum(screen: &mut Screen, reading: &ReadingNoise) {
    let Shown { factor, unit } = Shown::reading(reading);
    let spectrum = match &reading.noise.spectrum {
        Ok(spectrum) => spectrum,
        Err(error) => {
            screen.say(2, &format!("no spectrum: {error}"));
            return;
        }
    };
    let text = format!(
        "spectrum, one-sided, means of octaves; {} segments, resolution {} Hz",
        spectrum.segments,
        significant(spectrum.resolution, 3)
    );
    screen.say(2, &text);
    let density = format!("{unit}/sqrt(Hz)");
    let mut table = Table::new(1, &[(Align::Left, &["Hz", &density])]);
    for (frequency, density) in spectrum.bands(1.0) {
        let density = factor * density.sqrt();
        table.row([frequency, density].map(|number| significant(number, 4).into()));
    }
    screen.table(table);
    for line in spectrum.lines() {
        let (frequency, amplitude) = (significant(line.frequency, 5), significant(factor * line.amplitude, 3));
        let excess = significant(line.excess, 2);
        screen.say(
            2,
            &format!("line at {frequency} Hz, amplitude {amplitude} {unit}, {excess} times the noise about it"),
        );
    }
}

fn terms(screen: &mut Screen, reading: &ReadingNoise) {
    let Some(terms) = reading.noise.quotable() else { return };
    let text = format!(
        "noise terms (IEEE Std 952); chi^2 {:.1} with {} degrees of freedom",
        terms.chi_squared, terms.degrees_of_freedom
    );
    screen.say(2, &text);
    let mut table = Table::new(2, &[(Align::Left, &["", ""]), (Align::Words, &[""])]);
    for term in NoiseTerm::ALL {
        let Shown { factor, unit } = Shown::coefficient(reading, term);
        let value = match terms.coefficient(term) {
            Coefficient::Determined { value, standard_uncertainty } => {
                let (value, uncertainty) = with_uncertainty(factor * value, factor * standard_uncertainty);
                format!("{value} ± {uncertainty} {unit}")
            }
            Coefficient::NotDetermined { upper_bound } if upper_bound.is_finite() => {
                format!("undetermined, below {} {unit} (95 %)", significant(factor * upper_bound, 2))
            }
            Coefficient::NotDetermined { .. } => "undetermined".to_owned(),
        };
        table.row([term.symbol().into(), term.name().into(), value.into()]);
    }
    screen.table(table);
}

/// Why the coefficients of a column are not quoted, a sentence for each such column.
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
    let ramps = |reading: &ReadingNoise| {
        let Staircase { stretches, lowest, highest } = reading.staircase?;
        let [low, high] = [lowest, highest].map(|value| significant(value, 4));
        Some(format!(
            "{}: the record stands still {stretches} times, from {low} to {high} {}, and the ramps between are no noise; choose one \
             stretch with --from and --to, or a plateau of a session with --plateau",
            reading.name, reading.unit
        ))
    };
    analysis.readings.iter().filter_map(|reading| ramps(reading).or_else(|| warning(reading))).collect()
}

/// A number to `digits` significant digits; with an exponent only where it would be long without.
fn significant(value: f64, digits: u8) -> String {
    number::significant(value, digits, -4..7)
}
