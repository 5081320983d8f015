//! Power spectral density by Welch's method.

use realfft::RealFftPlanner;
use statrs::distribution::{ChiSquared, ContinuousCDF};

use super::error::NoiseError;
use crate::progress::{OnProgress, advance};
use crate::statistics::{chi_squared_quantiles, median};

/// One-sided power spectral density of a record.
#[derive(Debug, Clone, PartialEq)]
pub struct Spectrum {
    /// Frequencies from 0 to half the sampling rate, Hz.
    pub frequency: Vec<f64>,
    /// Density at each frequency, square of the readings' unit per Hz; its integral is the variance.
    pub density: Vec<f64>,
    /// Segments averaged.
    pub segments: usize,
    /// Segments left out because more than a tenth of them was missing.
    pub skipped: usize,
    /// Equivalent degrees of freedom of a density (those at both ends of the band have half as many).
    pub degrees_of_freedom: f64,
    /// Noise bandwidth of the window, Hz: narrower features are not resolved.
    pub resolution: f64,
}

/// A line that stands out of the noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpectrumLine {
    /// Its frequency, to within the resolution, Hz.
    pub frequency: f64,
    /// Amplitude of a sine of its power, the readings' unit.
    pub amplitude: f64,
    /// Its density over that of the noise about it.
    pub excess: f64,
}

impl Spectrum {
    /// The mean frequency [Hz] and the mean density, square of the readings' unit per Hz, of bands of equal logarithmic width, `per_octave` of them an
    /// octave. They omit the ends of the spectrum:
    /// the mean at frequency 0 is removed, and half the sampling rate has one side only.
    pub fn bands(&self, per_octave: f64) -> Vec<(f64, f64)> {
        let inner = 1..self.density.len().saturating_sub(1).max(1);
        let band = |k: &usize| (self.frequency[*k].log2() * per_octave).floor();
        let places: Vec<usize> = inner.collect();
        let mean = |of: &[f64], part: &[usize]| part.iter().map(|k| of[*k]).sum::<f64>() / part.len() as f64;
        let bands = places.chunk_by(|a, b| band(a) == band(b));
        bands.map(|part| (mean(&self.frequency, part), mean(&self.density, part))).collect()
    }

    /// Lines: peaks above the level that the noise about them exceeds in one of a thousand spectra.
    ///
    /// The noise about a peak is the larger of the medians of the densities on either side, the window's main lobe left
    /// out; densities of noise follow chi^2 with the spectrum's degrees of freedom.
    pub fn lines(&self) -> Vec<SpectrumLine> {
        const CHANCE: f64 = 1e-3;
        /// Bins of the main lobe of the Hann window on either side of a line, and bins that show the noise.
        const LOBE: usize = 2;
        const SIDE: usize = 24;
        let Ok(law) = ChiSquared::new(self.degrees_of_freedom) else { return Vec::new() };
        let bins = self.density.len().saturating_sub(2);
        if bins <= 2 * (SIDE + LOBE) {
            return Vec::new();
        }
        let highest = law.inverse_cdf(1.0 - CHANCE / bins as f64) / law.inverse_cdf(0.5);
        let side = |range: std::ops::Range<usize>| median(&mut self.density[range].to_vec());
        let step = self.frequency[1];
        let line = |k: usize| {
            let near = &self.density[k - LOBE..=k + LOBE];
            let middle = side(k - LOBE - SIDE..k - LOBE).max(side(k + LOBE + 1..k + LOBE + 1 + SIDE));
            let is_peak = near.iter().all(|density| *density <= self.density[k]);
            // The median of chi^2 is below its mean.
            let noise = middle * self.degrees_of_freedom / law.inverse_cdf(0.5);
            let power: f64 = near.iter().map(|density| (density - noise) * step).sum();
            (is_peak && self.density[k] > highest * middle).then(|| SpectrumLine {
                frequency: self.frequency[k],
                amplitude: (2.0 * power.max(0.0)).sqrt(),
                excess: self.density[k] / noise,
            })
        };
        (1 + LOBE + SIDE..bins + 1 - LOBE - SIDE).filter_map(line).collect()
    }

    /// The factors by which a density is multiplied for the ends of its confidence interval at the level
    /// `confidence`: `edf / chi^2_(1-p)` and `edf / chi^2_p`, p = (1 - confidence) / 2.
    ///
    /// # Errors
    /// [`NoiseError::BadConfidence`].
    pub fn interval(&self, confidence: f64) -> Result<(f64, f64), NoiseError> {
        let edf = self.degrees_of_freedom;
        let [low, high] =
            chi_squared_quantiles(edf, confidence).ok_or(NoiseError::BadConfidence { found: confidence })?;
        Ok((edf / high, edf / low))
    }
}

impl Spectrum {
    /// Power spectral density of readings taken every `tau0` seconds, by Welch's method: Hann windows of `length`
    /// readings, half overlapping, each less its mean, averaged.
    ///
    /// `S(f_k) = 2 tau0 / (K sum w^2) sum_segments |sum_j w_j y_j exp(-2 pi i j k / L)|^2`, half that at both ends.
    /// A reading that is not finite is missing and counts as the segment's mean; the density is scaled by the share of
    /// the window that is left, and a segment with more than a tenth missing is skipped.
    ///
    /// Degrees of freedom: `2 K / (1 + 2 rho^2 (K - 1) / K)`, rho = 1/6 the correlation of neighbouring windows for
    /// white readings (P. D. Welch, IEEE Trans. Audio Electroacoust. 15, 1967). K counts segments side by side; runs
    /// broken by gaps only add freedom. `progress` is asked at each segment.
    ///
    /// # Errors
    /// [`NoiseError`] if `tau0` is not positive, `length` is below 8, or no segment of that length is whole enough;
    /// [`NoiseError::Stopped`].
    pub fn of(readings: &[f64], tau0: f64, length: usize, progress: OnProgress<()>) -> Result<Spectrum, NoiseError> {
        const SHORTEST: usize = 8;
        const OVERLAP_CORRELATION: f64 = 1.0 / 6.0;
        if !(tau0.is_finite() && tau0 > 0.0) {
            return Err(NoiseError::BadInterval { found: tau0 });
        }
        if length < SHORTEST {
            return Err(NoiseError::TooShort { found: length, expected: SHORTEST });
        }
        let window = hann(length);
        let mut density = vec![0.0; length / 2 + 1];
        let (mut segments, mut skipped) = (0_usize, 0);
        let transform = RealFftPlanner::<f64>::new().plan_fft_forward(length);
        let mut output = transform.make_output_vec();
        for start in (0..=readings.len().saturating_sub(length)).step_by(length / 2) {
            advance(progress, ())?;
            let Some((mut segment, power)) =
                readings.get(start..start + length).and_then(|segment| windowed(segment, &window))
            else {
                skipped += 1;
                continue;
            };
            // Lengths agree by construction, so the transform cannot fail.
            if transform.process(&mut segment, &mut output).is_ok() {
                density.iter_mut().zip(&output).for_each(|(sum, z)| *sum += z.norm_sqr() / power);
                segments += 1;
            }
        }
        if segments == 0 {
            return Err(NoiseError::Interrupted { expected: length });
        }
        let count = segments as f64;
        for (k, value) in density.iter_mut().enumerate() {
            let sides = if k == 0 || 2 * k == length { 1.0 } else { 2.0 };
            *value *= sides * tau0 / count;
        }
        let bandwidth = window.iter().map(|w| w * w).sum::<f64>() / window.iter().sum::<f64>().powi(2) / tau0;
        Ok(Spectrum {
            frequency: (0..density.len()).map(|k| k as f64 / (length as f64 * tau0)).collect(),
            density,
            segments,
            skipped,
            degrees_of_freedom: 2.0 * count / (1.0 + 2.0 * OVERLAP_CORRELATION.powi(2) * (count - 1.0) / count),
            resolution: bandwidth,
        })
    }
}

/// The periodic Hann window, `w_j = sin^2(pi j / L)`.
fn hann(length: usize) -> Vec<f64> {
    (0..length).map(|j| (std::f64::consts::PI * j as f64 / length as f64).sin().powi(2)).collect()
}

/// The segment less its mean, windowed, and the window's power over what is present; `None` if too little is present.
fn windowed(segment: &[f64], window: &[f64]) -> Option<(Vec<f64>, f64)> {
    let seen = || segment.iter().filter(|y| y.is_finite());
    let count = seen().count();
    if 10 * (segment.len() - count) > segment.len() {
        return None;
    }
    let mean = seen().sum::<f64>() / count as f64;
    let power = segment.iter().zip(window).filter(|(y, _)| y.is_finite()).map(|(_, w)| w * w).sum();
    let values = segment.iter().zip(window).map(|(y, w)| if y.is_finite() { (y - mean) * w } else { 0.0 });
    Some((values.collect(), power))
}
