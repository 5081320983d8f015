//! A noise analysis as JSON, schema `centrical-noise/1`.

use std::path::{Path, PathBuf};

use centrical::noise::{Coefficient, Deviation, Estimator, Gaps, NoiseError, NoiseTerm, NoiseTerms, Spectrum};
use serde_json::{Value, json};

use crate::error::Error;
use crate::write::write_whole;

/// Name of the schema's present version.
pub const NOISE_SCHEMA: &str = "centrical-noise/1";

/// The noise of a record.
#[derive(Debug, Clone)]
pub struct NoiseAnalysis {
    /// The file.
    pub file: PathBuf,
    /// From, to: the part that was analysed, the record's clock [s].
    pub window: [f64; 2],
    /// Probability of the intervals.
    pub confidence: f64,
    /// One for each column of readings.
    pub readings: Vec<ReadingNoise>,
}

/// The noise of one column of readings.
#[derive(Debug, Clone)]
pub struct ReadingNoise {
    /// The column.
    pub name: String,
    /// Its unit: m/s^2 for accelerations, as in the file otherwise.
    pub unit: String,
    /// Mean of what was used [unit].
    pub mean: f64,
    /// Sampling interval [s].
    pub interval: f64,
    /// Readings used.
    pub samples: usize,
    /// Readings left out as spikes.
    pub spikes: usize,
    /// Samples left out as repeated.
    pub repeated: usize,
    /// What was missing and bridged, spikes among it.
    pub gaps: Gaps,
    /// Deviations by estimator, at averaging factors 1, 2, 4, ...
    pub deviations: Vec<(Estimator, Vec<Deviation>)>,
    /// The spectrum, or why there is none.
    pub spectrum: Result<Spectrum, NoiseError>,
    /// The noise terms, or why there are none.
    pub terms: Result<NoiseTerms, NoiseError>,
}

impl NoiseAnalysis {
    /// The file's name without its folders.
    pub fn file_name(&self) -> String {
        self.file.file_name().unwrap_or(self.file.as_os_str()).to_string_lossy().into_owned()
    }

    /// Writes the analysis as JSON; the file appears whole or not at all.
    ///
    /// # Errors
    /// [`Error::Io`] when the folder does not take it.
    pub fn write(&self, file: &Path) -> Result<(), Error> {
        write_whole(file, self.to_json().as_bytes())
    }

    /// The analysis as JSON: values in the readings' unit (m/s^2) and seconds; the same input gives the same bytes.
    pub fn to_json(&self) -> String {
        let whole = json!({
            "schema": NOISE_SCHEMA,
            "program": {"name": "centrical", "version": env!("CARGO_PKG_VERSION")},
            "file": self.file_name(),
            "window": self.window,
            "confidence": self.confidence,
            "readings": self.readings.iter().map(|reading| of_reading(reading, self.confidence)).collect::<Vec<Value>>(),
        });
        format!("{whole:#}\n")
    }
}

impl ReadingNoise {
    /// The noise terms, if they describe the deviations: what may be quoted.
    pub fn quotable(&self) -> Option<&NoiseTerms> {
        self.terms.as_ref().ok().filter(|terms| terms.is_consistent())
    }
}

fn of_reading(reading: &ReadingNoise, confidence: f64) -> Value {
    json!({
        "name": reading.name,
        "unit": reading.unit,
        "mean": reading.mean,
        "interval": reading.interval,
        "samples": reading.samples,
        "spikes": reading.spikes,
        "repeated": reading.repeated,
        "gaps": {"runs": reading.gaps.runs, "missing": reading.gaps.missing, "longest": reading.gaps.longest},
        "deviations": reading.deviations.iter().map(|(estimator, family)| of_family(*estimator, family)).collect::<Vec<_>>(),
        "spectrum": reading.spectrum.as_ref().map_or_else(refused, |spectrum| of_spectrum(spectrum, confidence)),
        "terms": reading.terms.as_ref().map_or_else(refused, of_terms),
    })
}

/// What could not be computed says why.
fn refused(error: &centrical::noise::NoiseError) -> Value {
    json!({"refused": error.to_string()})
}

fn of_family(estimator: Estimator, family: &[Deviation]) -> Value {
    let row = |d: &Deviation| {
        json!({
            "tau": d.tau, "value": d.value, "lower": d.lower, "upper": d.upper, "terms": d.terms,
            "degrees_of_freedom": d.degrees_of_freedom, "alpha": d.law.alpha(), "alpha_is_identified": d.is_identified,
            "bias": d.bias,
        })
    };
    json!({
        "estimator": estimator.name(),
        "is_of_phase": estimator.is_of_phase(),
        "deviations": family.iter().map(row).collect::<Vec<Value>>(),
    })
}

fn of_spectrum(spectrum: &Spectrum, confidence: f64) -> Value {
    let (lower, upper) = spectrum.interval(confidence).unwrap_or((f64::NAN, f64::NAN));
    let lines: Vec<Value> = (spectrum.lines().iter())
        .map(|line| json!({"frequency": line.frequency, "amplitude": line.amplitude, "excess": line.excess}))
        .collect();
    json!({
        "frequency": spectrum.frequency,
        "density": spectrum.density,
        "segments": spectrum.segments,
        "skipped": spectrum.skipped,
        "degrees_of_freedom": spectrum.degrees_of_freedom,
        "resolution": spectrum.resolution,
        "interval": [lower, upper],
        "lines": lines,
    })
}

/// Coefficients are null where the terms do not describe the deviations: such numbers are not to be quoted.
fn of_terms(terms: &NoiseTerms) -> Value {
    let coefficient = |term: NoiseTerm| match terms.coefficient(term) {
        Coefficient::Determined { value, standard_uncertainty } => {
            json!({"term": term.name(), "symbol": term.symbol(), "value": value, "standard_uncertainty": standard_uncertainty})
        }
        Coefficient::NotDetermined { upper_bound } => {
            json!({"term": term.name(), "symbol": term.symbol(), "value": null, "upper_bound": upper_bound})
        }
    };
    let coefficients = || NoiseTerm::ALL.into_iter().map(coefficient).collect::<Vec<Value>>();
    json!({
        "is_consistent": terms.is_consistent(),
        "chi_squared": terms.chi_squared,
        "degrees_of_freedom": terms.degrees_of_freedom,
        "taus": terms.taus,
        "coefficients": terms.is_consistent().then(coefficients),
    })
}
