//! A noise analysis as JSON, schema `centrical-noise/1`.

use std::path::PathBuf;

use centrical::reduction::Staircase;
use centrical::stability::{Analysis, Coefficient, Deviation, Estimator, NoiseTerm, NoiseTerms, Spectrum};
use centrical_table::escaped;
use serde_json::{Value, json};

use super::result::Program;

/// Name of the schema's present version.
pub(crate) const NOISE_SCHEMA: &str = "centrical-noise/1";

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
    /// Whether the record moves from one steady stretch to another, as a record with ramps does.
    pub staircase: Option<Staircase>,
    /// Its noise.
    pub noise: Analysis,
}

impl NoiseAnalysis {
    /// The file's name without its folders.
    pub fn file_name(&self) -> String {
        self.file.file_name().unwrap_or(self.file.as_os_str()).to_string_lossy().into_owned()
    }

    /// The analysis as JSON: values in the readings' unit (m/s^2) and seconds; the same input gives the same bytes.
    pub fn to_json(&self) -> String {
        let whole = json!({
            "schema": NOISE_SCHEMA,
            "program": Program::this(),
            "file": self.file_name(),
            "window": self.window,
            "confidence": self.confidence,
            "readings": self.readings.iter().map(|reading| of_reading(reading, self.confidence)).collect::<Vec<Value>>(),
        });
        escaped(format!("{whole:#}\n"))
    }
}

fn of_reading(reading: &ReadingNoise, confidence: f64) -> Value {
    let noise = &reading.noise;
    json!({
        "name": reading.name,
        "unit": reading.unit,
        "mean": noise.mean,
        "interval": noise.interval,
        "samples": noise.samples,
        "spikes": noise.spikes,
        "repeated": noise.repeated,
        "staircase": reading.staircase.map(|s| json!({"stretches": s.stretches, "lowest": s.lowest, "highest": s.highest})),
        "gaps": {"runs": noise.gaps.runs, "missing": noise.gaps.missing, "longest": noise.gaps.longest},
        "deviations": noise.deviations.iter().map(|(estimator, family)| of_family(*estimator, family)).collect::<Vec<_>>(),
        "spectrum": noise.spectrum.as_ref().map_or_else(refused, |spectrum| of_spectrum(spectrum, confidence)),
        "terms": noise.terms.as_ref().map_or_else(refused, of_terms),
    })
}

/// What could not be computed says why.
fn refused(error: &centrical::stability::NoiseError) -> Value {
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
