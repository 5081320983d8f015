//! The estimators built on differences of phase points, each O(N) per tau.

use super::phase::Phase;
use super::total;
use super::variance::{RawVariance, mean_square};
use crate::progress::{Watch, unwatched};

/// A deviation of the Allan family.
///
/// With phase points x_i, `D2_i = x_(i+2m) - 2 x_(i+m) + x_i`, `D3_i` the third difference alike, tau = m tau0, and
/// `< >` the mean over every term that fits into the record (every m-th where it does not say "overlapping"):
///
/// | estimator | variance | source (NIST SP 1065) |
/// |---|---|---|
/// | Allan, overlapping Allan | `<D2^2> / (2 tau^2)` | eq. 7, 11 |
/// | modified Allan | `<(mean of m D2)^2> / (2 tau^2)` | eq. 14 |
/// | time | `tau^2 / 3` times modified Allan | eq. 15 |
/// | Hadamard, overlapping Hadamard | `<D3^2> / (6 tau^2)` | eq. 18, 20 |
/// | total | Allan of the record reflected at both ends | eq. 25 |
/// | modified total | modified Allan of each 3m points, untilted and reflected | eq. 27 |
/// | time total | `tau^2 / 3` times modified total | eq. 28, where the source misprints tau^3 |
/// | Hadamard total | Hadamard of each 3m readings, untilted and reflected | eq. 29 |
///
/// The modified, time and Hadamard totals take O(N m) per tau: for short records.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Estimator {
    /// ADEV: the original two-sample deviation, terms m apart.
    Allan,
    /// OADEV: the general-purpose one.
    OverlappingAllan,
    /// MDEV: separates white from flicker phase noise.
    ModifiedAllan,
    /// TDEV: of the phase rather than the frequency.
    Time,
    /// HDEV: blind to a linear drift, terms m apart.
    Hadamard,
    /// OHDEV: blind to a linear drift.
    OverlappingHadamard,
    /// TOTDEV: Allan with more confidence at long tau.
    Total,
    /// MTOTDEV: modified Allan with more confidence at long tau.
    ModifiedTotal,
    /// TTOTDEV: time deviation with more confidence at long tau.
    TimeTotal,
    /// HTOTDEV: Hadamard with more confidence at long tau; at m = 1 it is the overlapping Hadamard.
    HadamardTotal,
}

impl Estimator {
    /// Every estimator.
    pub const ALL: [Self; 10] = [
        Self::Allan,
        Self::OverlappingAllan,
        Self::ModifiedAllan,
        Self::Time,
        Self::Hadamard,
        Self::OverlappingHadamard,
        Self::Total,
        Self::ModifiedTotal,
        Self::TimeTotal,
        Self::HadamardTotal,
    ];

    /// Its name in files and options: `overlapping-allan`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Allan => "allan",
            Self::OverlappingAllan => "overlapping-allan",
            Self::ModifiedAllan => "modified-allan",
            Self::Time => "time",
            Self::Hadamard => "hadamard",
            Self::OverlappingHadamard => "overlapping-hadamard",
            Self::Total => "total",
            Self::ModifiedTotal => "modified-total",
            Self::TimeTotal => "time-total",
            Self::HadamardTotal => "hadamard-total",
        }
    }

    /// The variance at averaging factor `m`, and the number of terms that it averages. Its unit is the square of that of the readings; for
    /// time deviations, of the phase. `None` if the record, less its gaps, has no term that long.
    pub fn variance(self, phase: &Phase, m: usize) -> Option<(f64, usize)> {
        self.watched_variance(phase, m, &Watch::new(&unwatched)).map(|raw| (raw.value, raw.terms))
    }

    /// The same before any correction; what it gives after it was stopped means nothing.
    pub(super) fn watched_variance(self, phase: &Phase, m: usize, watch: &Watch) -> Option<RawVariance> {
        let tau = m as f64 * phase.tau0();
        let phase_unit = |variance: RawVariance| RawVariance { value: variance.value * tau * tau / 3.0, ..variance };
        match self {
            _ if m == 0 => None,
            Self::Allan => differences(phase, m, 2, m, watch),
            Self::OverlappingAllan => differences(phase, m, 2, 1, watch),
            Self::ModifiedAllan => modified(phase, m, watch),
            Self::Time => modified(phase, m, watch).map(phase_unit),
            Self::Hadamard => differences(phase, m, 3, m, watch),
            Self::OverlappingHadamard => differences(phase, m, 3, 1, watch),
            Self::Total => total::total(phase, m, watch),
            Self::ModifiedTotal => total::modified_total(phase, m, watch),
            Self::TimeTotal => total::modified_total(phase, m, watch).map(phase_unit),
            Self::HadamardTotal if m == 1 => differences(phase, m, 3, 1, watch),
            Self::HadamardTotal => total::hadamard_total(phase, m, watch),
        }
    }

    /// Order of the phase difference the estimator is built on: 2 (Allan) or 3 (Hadamard).
    pub fn order(self) -> usize {
        match self {
            Self::Hadamard | Self::OverlappingHadamard | Self::HadamardTotal => 3,
            _ => 2,
        }
    }

    /// Whether the deviation is of the phase (unit of readings times second), not of the readings.
    pub fn is_of_phase(self) -> bool {
        matches!(self, Self::Time | Self::TimeTotal)
    }
}

/// `<D^2> / (2 tau^2)` for the second, `<D^2> / (6 tau^2)` for the third difference, terms `stride` apart.
fn differences(phase: &Phase, m: usize, order: usize, stride: usize, watch: &Watch) -> Option<RawVariance> {
    let x = phase.points();
    let span = order * m;
    let seen = (0..x.len().checked_sub(span)?).step_by(stride).filter(|&i| phase.is_seen(i, i + span));
    let (sum, terms) = if order == 2 {
        mean_square(seen.map(|i| x[i + 2 * m] - 2.0 * x[i + m] + x[i]), watch)
    } else {
        mean_square(seen.map(|i| x[i + 3 * m] - 3.0 * (x[i + 2 * m] - x[i + m]) - x[i]), watch)
    }?;
    let tau = m as f64 * phase.tau0();
    let norm = if order == 2 { 2.0 } else { 6.0 };
    Some(RawVariance { value: sum / (norm * tau * tau), terms, possible: (x.len() - span).div_ceil(stride) })
}

/// `<(sum of m D2)^2> / (2 m^2 tau^2)`, the sum sliding along the record.
fn modified(phase: &Phase, m: usize, watch: &Watch) -> Option<RawVariance> {
    let x = phase.points();
    let possible = (x.len() + 1).checked_sub(3 * m).filter(|&terms| terms > 0)?;
    let mut sum: f64 = (0..m).map(|i| x[i + 2 * m] - 2.0 * x[i + m] + x[i]).sum();
    let sums = (0..possible).filter_map(|i| {
        let now = sum;
        if i + 3 * m < x.len() {
            sum += x[i + 3 * m] - 3.0 * (x[i + 2 * m] - x[i + m]) - x[i];
        }
        phase.is_seen(i, i + 3 * m - 1).then_some(now)
    });
    let (square, terms) = mean_square(sums, watch)?;
    let scale = (m * m) as f64 * phase.tau0();
    Some(RawVariance { value: square / (2.0 * scale * scale), terms, possible })
}
