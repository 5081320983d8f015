//! The source's sufficient conditions for observability (its section 6, point 3) as a checklist: met or not, and
//! whether this very experiment needs them.
//!
//! The conditions are sufficient, not necessary. A condition that is met is needed if the experiment without what
//! meets it loses more; one that is not met is needed if something is lost that meeting it would bring back.

use nalgebra::Matrix3;

use super::addition::{Addition, new_id};
use super::remedy::{axis_attitudes, new_angle, new_radius, new_speed};
use super::study::Study;
use crate::model::{Position, SetPoint};

/// "An order of magnitude or more" above gravity.
const LOAD_RATIO: f64 = 10.0;

/// An axis is along a direction "up to mounting errors" within 5 deg: ten times what a fixture errs by, and far
/// from any attitude that is meant to be another. The number is the cosine.
const ALONG: f64 = 0.996;

/// One of the source's conditions.
#[derive(Debug, Clone, PartialEq)]
pub struct Condition {
    /// What the source asks for.
    pub requirement: &'static str,
    /// What the experiment has.
    pub found: String,
    /// Whether that is enough.
    pub is_met: bool,
    /// Whether this experiment needs it.
    pub need: Need,
}

/// Whether an experiment needs a condition.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Need {
    /// Met; without it this number of further combinations would be lost.
    Holds(usize),
    /// Met, and without it no more would be lost.
    Spare,
    /// Not met; meeting it would bring back this number of the lost combinations.
    WouldBringBack(usize),
    /// Not met, and meeting it would bring nothing back, if anything is lost at all.
    Dispensable,
}

impl Study {
    /// The source's conditions, in its order; none where nothing is on an arm.
    pub fn conditions(&self) -> Vec<Condition> {
        if !self.model().experiment().has_arm() {
            return Vec::new();
        }
        vec![self.rest_angles(), self.vertical_axes(), self.radii(), self.speeds(), self.directions()]
    }

    fn rest_angles(&self) -> Condition {
        let is_meant = |s: &SetPoint| s.is_rest() && self.is_on_arm(s);
        let angles = SetPoint::distinct_angles(self.read().filter(|s| is_meant(s)).enumerate());
        // The angle that is read most is the one that a poorer experiment would keep.
        let kept = angles
            .iter()
            .map(|(_, angle)| *angle)
            .max_by_key(|a| self.read().filter(|s| is_meant(s) && s.rests_at(*a)).count());
        let is_met = angles.len() >= 2;
        Condition {
            requirement: "plateaus at rest at two or more angles about the rotation axis",
            found: counted(angles.len(), "angle at rest", "angles at rest"),
            is_met,
            need: self.need(
                is_met,
                &[&|s| is_meant(s) && !kept.is_some_and(|a| s.rests_at(a))],
                new_angle(self).as_slice(),
            ),
        }
    }

    fn vertical_axes(&self) -> Condition {
        let vertical = |s: &SetPoint, i: usize| s.is_rest() && self.attitude(s)[(i, 2)].abs() > ALONG;
        let missing: Vec<usize> = (0..3).filter(|&i| !self.read().any(|s| vertical(s, i))).collect();
        let additions: Vec<Addition> = missing.iter().filter_map(|&i| self.rest_with_vertical(i)).collect();
        Condition {
            requirement: "at rest, each sensitive axis along the vertical",
            found: axes_text(&missing),
            is_met: missing.is_empty(),
            need: self.need(
                missing.is_empty(),
                &[&|s| vertical(s, 0), &|s| vertical(s, 1), &|s| vertical(s, 2)],
                &additions,
            ),
        }
    }

    fn radii(&self) -> Condition {
        let radius = |s: &SetPoint| self.model().experiment().arm_of(s).x.abs();
        let radii = distinct(self.read().filter(|s| self.is_on_arm(s)).map(radius));
        let largest = radii.iter().copied().fold(0.0, f64::max);
        let is_met = radii.len() >= 2;
        Condition {
            requirement: "two or more distances from the rotation axis, with a known difference",
            found: counted(radii.len(), "radius", "radii"),
            is_met,
            need: self.need(
                is_met,
                &[&|s| self.is_on_arm(s) && radius(s) < 0.999 * largest],
                new_radius(self).as_slice(),
            ),
        }
    }

    fn speeds(&self) -> Condition {
        let experiment = self.model().experiment();
        let load = |s: &SetPoint| s.omega * s.omega * experiment.arm_of(s).x.abs() / experiment.site.gravity;
        // The normalised experiment loads the unit with exactly ten g: rounding must not take it away.
        let fast = |s: &&SetPoint| load(s) >= LOAD_RATIO * (1.0 - 1e-9);
        let speeds = distinct(self.read().filter(fast).map(|s| s.omega.abs()));
        let fastest = self.read().map(|s| s.omega.abs()).fold(0.0, f64::max);
        let is_met = speeds.len() >= 2;
        Condition {
            requirement: "several constant speeds with a load of ten times gravity or more",
            found: counted(speeds.len(), "such speed", "such speeds"),
            is_met,
            need: self.need(
                is_met,
                &[&|s| !s.is_rest() && s.omega.abs() < 0.999 * fastest],
                new_speed(self).as_slice(),
            ),
        }
    }

    fn directions(&self) -> Condition {
        let along = |p: &Matrix3<f64>, (i, sign): (usize, f64)| p[(i, 0)] * sign > ALONG;
        let all: Vec<(usize, f64)> = (0..3).flat_map(|i| [(i, 1.0), (i, -1.0)]).collect();
        let spins = |s: &SetPoint, d| !s.is_rest() && along(&self.attitude(s), d);
        let missing: Vec<(usize, f64)> = all.iter().copied().filter(|&d| !self.read().any(|s| spins(s, d))).collect();
        let additions: Vec<Addition> = missing.iter().filter_map(|&d| self.new_position(|p| along(p, d))).collect();
        let without = |n: usize| move |s: &SetPoint| along(&self.attitude(s), (n / 2, [1.0, -1.0][n % 2]));
        let removals: Vec<_> = (0..6).map(without).collect();
        let removals: Vec<&dyn Fn(&SetPoint) -> bool> =
            removals.iter().map(|r| r as &dyn Fn(&SetPoint) -> bool).collect();
        let names =
            missing.iter().map(|(i, sign)| format!("{} {}", i + 1, if *sign > 0.0 { "outward" } else { "inward" }));
        let names: Vec<String> = names.collect();
        Condition {
            requirement: "spinning, each sensitive axis along the arm in both directions",
            found: if names.is_empty() { "all six".to_owned() } else { format!("not axis {}", names.join(", ")) },
            is_met: missing.is_empty(),
            need: self.need(missing.is_empty(), &removals, &additions),
        }
    }

    /// Whether a plateau is on the arm, and no rest beside it.
    fn is_on_arm(&self, set_point: &SetPoint) -> bool {
        !self.model().experiment().position_of(set_point).is_free
    }

    /// Whether the experiment needs a condition: what it loses without any one of the sets of plateaus that meet it,
    /// or regains by all the additions that would.
    fn need(&self, is_met: bool, removals: &[&dyn Fn(&SetPoint) -> bool], additions: &[Addition]) -> Need {
        if is_met {
            let losses = removals.iter().map(|removed| self.lost_without(removed)).max().unwrap_or(0);
            return match losses.saturating_sub(self.observability().lost()) {
                0 => Need::Spare,
                more => Need::Holds(more),
            };
        }
        let mut study = self.clone();
        for addition in additions {
            study = addition.apply(&study).unwrap_or(study);
        }
        match self.observability().lost().saturating_sub(study.observability().lost()) {
            0 => Need::Dispensable,
            back => Need::WouldBringBack(back),
        }
    }

    /// Combinations lost without the plateaus `removed`, apart from the turns and shifts of positions that go with them. What a prior
    /// knows is not lost.
    fn lost_without(&self, removed: &dyn Fn(&SetPoint) -> bool) -> usize {
        let set_points = &self.model().experiment().set_points;
        let weights: Vec<_> = self.weights().iter().filter(|w| !removed(&set_points[w.set_point])).copied().collect();
        let Ok(study) = Self::at_zero(self.model().clone(), weights) else {
            return self.observability().columns();
        };
        let has_prior = |j: usize| self.model().priors().iter().any(|prior| prior.parameter == j);
        let is_unused = |j: usize| !has_prior(j) && !study.acts(j) && self.acts(j);
        let parameters = self.model().parameters().iter().enumerate();
        let unused = parameters.filter(|(j, parameter)| parameter.kind.is_of_position() && is_unused(*j));
        study.observability().lost() - unused.count()
    }

    /// Whether any plateau depends on parameter `j`.
    fn acts(&self, j: usize) -> bool {
        self.linearisations().iter().any(|l| l.columns.iter().any(|(column, d)| *column == j && d.amax() > 0.0))
    }

    /// The plateaus that are read.
    fn read(&self) -> impl Iterator<Item = &SetPoint> {
        self.weights().iter().map(|w| &self.model().experiment().set_points[w.set_point])
    }

    fn attitude(&self, s: &SetPoint) -> Matrix3<f64> {
        self.model().experiment().position_of(s).p_zy
    }

    /// Rest in a mounting that has axis `i` along the vertical, or else a position that has.
    fn rest_with_vertical(&self, i: usize) -> Option<Addition> {
        let suits = |p: &Matrix3<f64>| p[(i, 2)].abs() > ALONG;
        let experiment = self.model().experiment();
        let mounting = experiment.mountings.iter().position(|m| suits(&experiment.positions[m.position].p_zy));
        let rest = |m| Addition::Rest { mountings: vec![m], angle: 0.0 };
        mounting.map(rest).or_else(|| self.new_position(suits))
    }

    /// A position of its own along the arm axes that does what is asked for.
    fn new_position(&self, suits: impl Fn(&Matrix3<f64>) -> bool) -> Option<Addition> {
        let p_zy = axis_attitudes().into_iter().find(suits)?;
        let id = new_id(&self.model().experiment().positions);
        Some(Addition::Position(Position::on_arm(id.clone(), p_zy, id)))
    }
}

fn counted(count: usize, one: &str, many: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}

fn axes_text(missing: &[usize]) -> String {
    let names: Vec<String> = missing.iter().map(|i| (i + 1).to_string()).collect();
    if names.is_empty() { "all three".to_owned() } else { format!("not axis {}", names.join(", ")) }
}

/// Values that differ by more than a thousandth of the largest, rising.
fn distinct(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    let apart = 1e-3 * values.last().copied().unwrap_or(0.0).abs();
    values.dedup_by(|later, kept| *later - *kept <= apart);
    values
}
