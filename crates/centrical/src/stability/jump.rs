//! A jump of the bias, as of a sensor that is switched over or warmed for a moment: Hadamard variances take it for a random walk.

use super::error::NoiseError;
use super::phase::Phase;
use crate::progress::{OnProgress, advance};
use crate::statistics::t_tail;

/// Probability with which noise alone is refused.
const CHANCE: f64 = 1e-4;

/// Shortest averaging time, in readings: their means are normal, whatever the law of a reading.
const SHORTEST: usize = 64;

/// Fewest averaging times in a record.
const INTERVALS: usize = 8;

/// Places of a change in an averaging time. A jump between two of them loses a sixteenth of its size at most.
const PLACES: usize = 8;

/// The changes of the mean over one averaging time.
struct Changes<'a> {
    phase: &'a Phase,
    /// Averaging time, in readings.
    m: usize,
    /// Points of the phase, and the mean after each less the mean before it.
    all: Vec<(usize, f64)>,
}

/// Refuses a record whose mean changes once by more than its noise explains, readings having this last `digit` and the phase this `start` [s].
///
/// Changes from one mean to the next follow one normal law in white, flicker, Markov and random-walk noise alike, and each has `m`
/// readings to either side. The largest is set against the deviation of those that share no reading with it, by Student's t. Their number is
/// that of averaging times, less a third: neighbours are correlated by -1/2 (white noise) to 1/4 (random walk). Bonferroni's inequality holds
/// for all places at all octaves of the averaging time, however they are correlated. Louder noise about the place widens the law
/// ([`Changes::loudness`]). `progress` is asked again and again.
///
/// # Errors
/// [`NoiseError::Jump`]; [`NoiseError::Stopped`].
pub(super) fn refuse_jump(phase: &Phase, digit: f64, start: f64, progress: OnProgress<()>) -> Result<(), NoiseError> {
    let whole = Steps::of(phase.points());
    let octaves: Vec<usize> = phase.octaves(INTERVALS).into_iter().filter(|m| *m >= SHORTEST).collect();
    let mut likeliest = (CHANCE / octaves.len() as f64, None);
    for m in octaves {
        advance(progress, ())?;
        let changes = Changes::of(phase, m);
        if let Some((probability, place)) =
            changes.largest(digit, &whole).filter(|(probability, _)| *probability < likeliest.0)
        {
            likeliest = (probability, Some((m, place)));
        }
    }
    let Some((m, place)) = likeliest.1 else { return Ok(()) };
    let near = (place.saturating_sub(m / PLACES).max(m)..=place + m / PLACES).filter(|k| k + m < phase.points().len());
    let changes = near.map(|k| (k, change(phase, k, m)));
    let (place, size) = changes.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs())).unwrap_or((place, f64::NAN));
    Err(NoiseError::Jump { size, place: start + place as f64 * phase.tau0(), time: m as f64 * phase.tau0() })
}

/// The mean of `m` readings after a point of the phase less that of those before it.
fn change(phase: &Phase, k: usize, m: usize) -> f64 {
    let x = phase.points();
    (x[k + m] - 2.0 * x[k] + x[k - m]) / (m as f64 * phase.tau0())
}

impl<'a> Changes<'a> {
    fn of(phase: &'a Phase, m: usize) -> Self {
        let places = (m..phase.points().len() - m).step_by(m / PLACES);
        let seen = places.filter(|k| phase.is_seen(k - m, k + m));
        Self { phase, m, all: seen.map(|k| (k, change(phase, k, m))).collect() }
    }

    /// The probability that any change is as large as the largest, and its place.
    fn largest(&self, digit: f64, whole: &Steps) -> Option<(f64, usize)> {
        let mean = self.all.iter().map(|(_, change)| change).sum::<f64>() / self.all.len() as f64;
        let farthest = |a: &&(usize, f64), b: &&(usize, f64)| (a.1 - mean).abs().total_cmp(&(b.1 - mean).abs());
        let (place, largest) = *self.all.iter().max_by(farthest)?;
        let others = || self.all.iter().filter(|(k, _)| k.abs_diff(place) >= 2 * self.m).map(|(_, change)| change);
        let count = others().count() as f64;
        let mean = others().sum::<f64>() / count;
        let variance = others().map(|change| (change - mean).powi(2)).sum::<f64>() / count;
        let nu = 2.0 / 3.0 * count / PLACES as f64 - 1.0;
        let size = ((largest - mean).abs() - digit).max(0.0);
        let t = size / (variance * self.loudness(place, whole) * (1.0 + 1.0 / (nu + 1.0))).sqrt();
        (nu > 0.0).then(|| (self.all.len() as f64 * t_tail(t, nu), place))
    }

    /// Mean square of the steps from reading to reading about a place, over that elsewhere, 1 at least. The largest step is left out: it is
    /// the jump.
    fn loudness(&self, place: usize, whole: &Steps) -> f64 {
        let near = Steps::of(&self.phase.points()[place - self.m..=place + self.m]);
        let elsewhere = (whole.squares - near.squares) / (whole.count - near.count);
        ((near.squares - near.largest) / (near.count - 1.0) / elsewhere).max(1.0)
    }
}

/// Steps from reading to reading.
#[derive(Default)]
struct Steps {
    count: f64,
    /// Sum of their squares.
    squares: f64,
    /// The largest of these.
    largest: f64,
}

impl Steps {
    fn of(points: &[f64]) -> Self {
        let squares = points.windows(3).map(|x| (x[2] - 2.0 * x[1] + x[0]).powi(2));
        squares.fold(Self::default(), |Self { count, squares, largest }, square| Self {
            count: count + 1.0,
            squares: squares + square,
            largest: largest.max(square),
        })
    }
}
