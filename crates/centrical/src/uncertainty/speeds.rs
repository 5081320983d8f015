//! The speeds that the telemetry shows against those that were set.
//!
//! With `s_n` set and `t_n` shown, the relative difference of a plateau is
//!
//! `d_n = t_n / s_n - 1 = c + e_n`,
//!
//! `c` the common part, of the standard uncertainty of the two scales, and `e_n` that of the plateau, of the uncertainty of a
//! set speed and of the reports. Every plateau is tested, and the mean of all; the probabilities are family-wise over these
//! tests (Šidák). Where the common part alone is off, one statement says so for all plateaus.

use statrs::distribution::{ContinuousCDF, Normal};

use super::coverage::Degrees;
use super::verdict::Level;
use crate::reduction::MeasuredSpeed;
use crate::statistics::{median, sidak, t_tail};

/// A plateau whose speed is shown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShownSpeed {
    /// Index of its set point.
    pub set_point: usize,
    /// Index of its mounting.
    pub mounting: usize,
    /// Speed that was set, without sign [rad/s].
    pub set: f64,
    /// Speed that is shown.
    pub shown: MeasuredSpeed,
}

/// What is stated of speeds, relative standard uncertainties.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StatedSpeeds {
    /// Of a plateau's speed, set against shown, beyond the scatter of the reports.
    pub plateau: f64,
    /// Of the scale of the shown speeds against that of the set ones.
    pub scale: f64,
}

/// The plateaus that a contradiction holds for.
#[derive(Debug, Clone, PartialEq)]
pub enum Extent {
    /// All of them alike.
    All,
    /// All plateaus of these mountings.
    Mountings(Vec<usize>),
    /// All plateaus that were set to these speeds [rad/s].
    Speeds(Vec<f64>),
    /// These plateaus, none of the above.
    Plateaus,
}

/// Speeds that contradict the schedule.
#[derive(Debug, Clone, PartialEq)]
pub struct SpeedContradiction {
    /// What the plateaus have in common.
    pub extent: Extent,
    /// Their set points.
    pub set_points: Vec<usize>,
    /// Speed that was set on the plateau whose difference is nearest to the mean one, without sign [rad/s].
    pub set: f64,
    /// Speed that is shown there [rad/s].
    pub shown: f64,
    /// Mean relative difference.
    pub difference: f64,
    /// Its standard uncertainty as stated.
    pub standard_uncertainty: f64,
    /// Family-wise probability of one so large by chance, the smallest of the plateaus.
    pub probability: f64,
}

/// A plateau farther than this many standard uncertainties from the median takes no part in the common difference.
const ALIKE: f64 = 5.0;

impl StatedSpeeds {
    /// The contradictions that are reported, family-wise at [`Level::Reported`].
    pub fn contradictions(&self, speeds: &[ShownSpeed]) -> Vec<SpeedContradiction> {
        if speeds.is_empty() {
            return Vec::new();
        }
        let tested = Tested::new(speeds, self);
        let mut found = Vec::new();
        let common = tested.common();
        if let Some(common) = &common {
            found.push(common.clone());
        }
        let offset = common.as_ref().map(|common| common.difference);
        let mut off: Vec<usize> =
            (0..speeds.len()).filter(|n| Level::Reported.is_passed_by(tested.probability(*n, offset))).collect();
        for extent in tested.extents(&off, offset.unwrap_or(0.0)) {
            let group: Vec<usize> = off.iter().copied().filter(|n| tested.is_in(&extent, *n)).collect();
            found.push(tested.contradiction(extent, &group, offset));
            off.retain(|n| !group.contains(n));
        }
        found
    }
}

struct Tested<'a> {
    speeds: &'a [ShownSpeed],
    stated: &'a StatedSpeeds,
    difference: Vec<f64>,
    /// Of the plateau alone.
    uncertainty: Vec<f64>,
    /// Plateaus that agree about the common difference.
    alike: Vec<usize>,
}

impl<'a> Tested<'a> {
    fn new(speeds: &'a [ShownSpeed], stated: &'a StatedSpeeds) -> Self {
        let difference: Vec<f64> = speeds.iter().map(|s| s.shown.speed / s.set - 1.0).collect();
        // Rounding of a speed in a file is below this.
        let uncertainty: Vec<f64> =
            speeds.iter().map(|s| s.shown.uncertainty.hypot(stated.plateau).max(f64::EPSILON)).collect();
        let middle = median(&mut difference.clone());
        let is_alike = |n: &usize| (difference[*n] - middle).abs() <= ALIKE * uncertainty[*n];
        let alike = (0..speeds.len()).filter(is_alike).collect();
        Self { speeds, stated, difference, uncertainty, alike }
    }

    /// Number of tests: of every plateau and of the mean.
    fn family(&self) -> f64 {
        (self.speeds.len() + 1) as f64
    }

    /// The difference that most plateaus have in common, if it is more than stated.
    fn common(&self) -> Option<SpeedContradiction> {
        let Self { speeds, alike, .. } = self;
        if 2 * alike.len() < speeds.len() {
            return None;
        }
        let (mean, standard_uncertainty) = self.mean(alike);
        let probability = sidak(two_sided(mean / standard_uncertainty, Degrees::Infinite), self.family());
        let example = self.nearest(alike, mean)?;
        Level::Reported.is_passed_by(probability).then(|| SpeedContradiction {
            extent: Extent::All,
            set_points: alike.iter().map(|n| speeds[*n].set_point).collect(),
            set: speeds[example].set,
            shown: speeds[example].shown.speed,
            difference: mean,
            standard_uncertainty,
            probability,
        })
    }

    /// Weighted mean of the differences of some plateaus, and its standard uncertainty with that of the scales. Steps of the
    /// reports are the same wherever the same speed is set: they count as common.
    fn mean(&self, plateaus: &[usize]) -> (f64, f64) {
        let weight = |n: usize| self.uncertainty[n].powi(-2);
        let total: f64 = plateaus.iter().map(|n| weight(*n)).sum();
        let of = |value: &dyn Fn(usize) -> f64| plateaus.iter().map(|n| weight(*n) * value(*n)).sum::<f64>() / total;
        let step = of(&|n| self.speeds[n].shown.step_uncertainty);
        let variance = 1.0 / total + self.stated.scale.powi(2) + step * step;
        (of(&|n| self.difference[n]), variance.sqrt())
    }

    /// Family-wise probability of the difference of plateau `n`: from the common one, or from none within the scales.
    fn probability(&self, n: usize, common: Option<f64>) -> f64 {
        let scale = if common.is_some() { 0.0 } else { self.stated.scale };
        let shown = &self.speeds[n].shown;
        let scatter = (shown.uncertainty.powi(2) - shown.step_uncertainty.powi(2)).max(0.0).sqrt();
        let others = self.stated.plateau.hypot(scale).hypot(shown.step_uncertainty);
        let degrees = Degrees::effective(&[
            (others, Degrees::Infinite),
            (scatter, Degrees::Finite(shown.degrees_of_freedom as f64)),
        ]);
        let deviation = (self.difference[n] - common.unwrap_or(0.0)) / self.uncertainty[n].hypot(scale);
        sidak(two_sided(deviation, degrees), self.family())
    }

    /// What the plateaus that are off from the `common` difference have in common: whole mountings first, then whole speeds, then the others.
    fn extents(&self, off: &[usize], common: f64) -> Vec<Extent> {
        if off.is_empty() {
            return Vec::new();
        }
        // One cause moves speeds one way: those that are off either way have nothing in common.
        let all_off = |is_of: &dyn Fn(&ShownSpeed) -> bool| {
            let of: Vec<usize> = (0..self.speeds.len()).filter(|n| is_of(&self.speeds[*n])).collect();
            let above = of.iter().filter(|n| self.difference[**n] > common).count();
            !of.is_empty() && (above == 0 || above == of.len()) && of.iter().all(|n| off.contains(n))
        };
        if all_off(&|_| true) {
            return vec![Extent::All];
        }
        let mut mountings: Vec<usize> = off.iter().map(|n| self.speeds[*n].mounting).collect();
        mountings.dedup();
        mountings.retain(|m| all_off(&|s| s.mounting == *m));
        let mut speeds: Vec<f64> = off.iter().map(|n| self.speeds[*n].set).collect();
        speeds.sort_by(f64::total_cmp);
        speeds.dedup();
        speeds.retain(|speed| all_off(&|s| s.set == *speed));
        let mut extents = Vec::new();
        if !mountings.is_empty() {
            extents.push(Extent::Mountings(mountings));
        }
        let is_left = |n: &usize| !extents.iter().any(|extent| self.is_in(extent, *n));
        let left: Vec<usize> = off.iter().copied().filter(is_left).collect();
        speeds.retain(|speed| left.iter().any(|n| self.speeds[*n].set == *speed));
        if !speeds.is_empty() {
            extents.push(Extent::Speeds(speeds));
        }
        if off.iter().any(|n| !extents.iter().any(|extent| self.is_in(extent, *n))) {
            extents.push(Extent::Plateaus);
        }
        extents
    }

    fn is_in(&self, extent: &Extent, n: usize) -> bool {
        match extent {
            Extent::All | Extent::Plateaus => true,
            Extent::Mountings(mountings) => mountings.contains(&self.speeds[n].mounting),
            Extent::Speeds(speeds) => speeds.contains(&self.speeds[n].set),
        }
    }

    /// The first of the plateaus whose difference is nearest to a mean.
    fn nearest(&self, plateaus: &[usize], mean: f64) -> Option<usize> {
        let distance = |n: usize| (self.difference[n] - mean).abs();
        plateaus.iter().copied().min_by(|a, b| distance(*a).total_cmp(&distance(*b)))
    }

    fn contradiction(&self, extent: Extent, group: &[usize], common: Option<f64>) -> SpeedContradiction {
        // The plateau that is farthest off stands for them.
        let far = |n: &usize| (self.difference[*n] - common.unwrap_or(0.0)).abs() / self.uncertainty[*n];
        let worst = group.iter().copied().max_by(|a, b| far(a).total_cmp(&far(b))).unwrap_or(0);
        let (difference, standard_uncertainty) = match extent {
            Extent::Plateaus => (self.difference[worst], self.uncertainty[worst].hypot(self.stated.scale)),
            _ => self.mean(group),
        };
        let example = if matches!(extent, Extent::Plateaus) { None } else { self.nearest(group, difference) };
        let example = example.unwrap_or(worst);
        SpeedContradiction {
            extent,
            set_points: group.iter().map(|n| self.speeds[*n].set_point).collect(),
            set: self.speeds[example].set,
            shown: self.speeds[example].shown.speed,
            difference,
            standard_uncertainty,
            probability: self.probability(worst, common),
        }
    }
}

/// Probability of a deviation at least as large either way, in standard uncertainties.
fn two_sided(deviation: f64, degrees: Degrees) -> f64 {
    match degrees {
        Degrees::Infinite => 2.0 * Normal::standard().cdf(-deviation.abs()),
        Degrees::Finite(nu) => t_tail(deviation, nu),
    }
}
