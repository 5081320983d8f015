//! Additions to an experiment: what could be measured, or known, besides.

use std::collections::BTreeSet;

use nalgebra::{Matrix3, Vector3};

use super::study::Study;
use crate::model::{Experiment, FitError, MeasurementModel, Mounting, PairRelation, Position, SetPoint, Weight};

/// One addition to an experiment.
///
/// Variants are ordered by cost: further plateaus in mountings made anyway (minutes); a dimension measured on the
/// bench; further mountings (an hour each); a new attitude, which needs a fixture. A fixture that holds the unit
/// differently in its pairs comes last, because every mounting is repeated with it.
#[derive(Debug, Clone, PartialEq)]
pub enum Addition {
    /// A plateau at rest at one more angle.
    Rest {
        /// Mountings in which it is read.
        mountings: Vec<usize>,
        /// `alpha_3` [rad].
        angle: f64,
    },
    /// A rest in one more free attitude, with up along this direction in instrument axes; known as well as those of the experiment
    /// are, where all of them are known.
    Attitude(Vector3<f64>),
    /// A plateau at one more speed.
    Speed {
        /// Mountings in which it is read.
        mountings: Vec<usize>,
        /// Angular speed [rad/s].
        omega: f64,
    },
    /// Prior knowledge of one parameter.
    Prior {
        /// Name of the parameter.
        parameter: String,
        /// Standard uncertainty, in its unit.
        standard_uncertainty: f64,
    },
    /// A mounting at one more radius, with the schedule of the position's fullest mounting.
    Radius {
        /// Positions that are mounted there, by index.
        positions: Vec<usize>,
        /// `R0_1` [m].
        radius: f64,
    },
    /// One more position, a pair of its own, at every radius of the experiment with its fullest schedule.
    Position(Position),
    /// A fixture with another relation of `dR` in a pair: for the mountings that are there.
    Relation(PairRelation),
}

impl Addition {
    /// The study of the experiment with the addition. New plateaus are as noisy as the experiment's median one.
    ///
    /// # Errors
    /// As [`Study::at_zero`].
    pub fn apply(&self, study: &Study) -> Result<Study, FitError> {
        let (model, weights) = self.added_to(study);
        Study::at_zero(model, weights)
    }

    /// The model and the weights of the experiment with the addition; new mountings stand last.
    pub(super) fn added_to(&self, study: &Study) -> (MeasurementModel, Vec<Weight>) {
        let mut draft = Draft::of(study);
        let mut model = None;
        match self {
            Self::Rest { mountings, angle } => {
                draft.add(mountings.iter().map(|&mounting| SetPoint::at_rest(mounting, *angle)));
            }
            Self::Attitude(up_z) => draft.rest(up_z),
            Self::Speed { mountings, omega } => {
                draft.add(mountings.iter().map(|&mounting| SetPoint::spinning(mounting, *omega)));
            }
            Self::Prior { parameter, standard_uncertainty } => {
                // An invalid prior adds nothing.
                model = study.model().clone().with_prior(parameter, *standard_uncertainty).ok();
            }
            Self::Radius { positions, radius } => {
                for &k in positions {
                    draft.mount(k, *radius);
                }
            }
            Self::Position(position) => {
                draft.experiment.positions.push(position.clone());
                let radii: BTreeSet<u64> = study.model().experiment().mountings.iter().map(radius_key).collect();
                let k = draft.experiment.positions.len() - 1;
                for key in radii {
                    draft.mount(k, f64::from_bits(key));
                }
            }
            Self::Relation(relation) => draft.experiment.pair_relation = *relation,
        }
        let (experiment, weights) = draft.finish();
        (model.unwrap_or_else(|| study.model().in_experiment(experiment)), weights)
    }

    /// Rank of its kind in the order of cost, and the number of plateaus, mountings or fixtures it takes.
    pub fn cost(&self) -> (u8, usize) {
        match self {
            Self::Rest { mountings, .. } => (0, mountings.len()),
            Self::Attitude(_) => (0, 1),
            Self::Speed { mountings, .. } => (1, mountings.len()),
            Self::Prior { .. } => (2, 1),
            Self::Radius { positions, .. } => (3, positions.len()),
            Self::Position(_) => (4, 1),
            Self::Relation(_) => (5, 1),
        }
    }

    /// The addition in words.
    pub fn text(&self, study: &Study) -> String {
        let experiment = study.model().experiment();
        match self {
            Self::Rest { mountings, angle } => {
                format!("rest at {:.0} deg in {}", angle.to_degrees(), mountings_text(mountings, experiment))
            }
            Self::Attitude(up_z) => format!("a rest with {}", attitude_in_words(up_z)),
            Self::Speed { mountings, omega } => {
                let rpm = omega.abs() * 60.0 / std::f64::consts::TAU;
                format!("a speed of {rpm:.1} rpm in {}", mountings_text(mountings, experiment))
            }
            Self::Prior { parameter, standard_uncertainty } => {
                let unit = study.model().parameters().iter().find(|p| p.name == *parameter).map_or("", |p| &p.unit);
                format!("{parameter} measured by other means to {standard_uncertainty:.1e} {unit}")
            }
            Self::Radius { positions, radius } => {
                format!("a radius of {radius:.4} m in {}", positions_text(positions, experiment))
            }
            Self::Position(position) => format!("{}, with a schedule as in the others", attitude_text(position)),
            Self::Relation(PairRelation::Common) => {
                "a fixture that keeps the shift with the seat on the arm when the unit is turned (pair relation \
                 \"common\")"
                    .to_owned()
            }
            Self::Relation(PairRelation::Opposite) => {
                "a fixture that keeps the shift with the unit when it is turned (pair relation \"opposite\")".to_owned()
            }
            Self::Relation(PairRelation::Free) => "unrelated shifts in a pair (pair relation \"free\")".to_owned(),
        }
    }
}

/// An experiment and its weights while something is added.
struct Draft {
    experiment: Experiment,
    /// Set points with their covariance, if they are read at all.
    plateaus: Vec<(SetPoint, Option<Matrix3<f64>>)>,
    usual: Matrix3<f64>,
}

impl Draft {
    fn of(study: &Study) -> Self {
        let experiment = study.model().experiment().clone();
        let mut plateaus: Vec<_> = experiment.set_points.iter().map(|s| (*s, None)).collect();
        for weight in study.weights() {
            plateaus[weight.set_point].1 = Some(weight.covariance);
        }
        let mut covariances: Vec<Matrix3<f64>> = study.weights().iter().map(|w| w.covariance).collect();
        covariances.sort_by(|a, b| a.trace().total_cmp(&b.trace()));
        let usual = covariances.get(covariances.len() / 2).copied().unwrap_or_else(Matrix3::identity);
        Self { experiment, plateaus, usual }
    }

    fn add(&mut self, set_points: impl Iterator<Item = SetPoint>) {
        self.plateaus.extend(set_points.map(|set_point| (set_point, Some(self.usual))));
    }

    /// A rest in a free attitude.
    fn rest(&mut self, up_z: &Vector3<f64>) {
        let position = self.experiment.positions.len();
        let id = new_id(&self.experiment.positions);
        let free = self.experiment.positions.iter().filter(|position| position.is_free);
        let known: Option<Vec<f64>> = free.map(|position| position.attitude_uncertainty).collect();
        let uncertainty = known.and_then(|known| known.into_iter().max_by(f64::total_cmp));
        self.experiment.positions.push(match uncertainty {
            Some(uncertainty) => Position::known(id, up_z, uncertainty),
            None => Position::free(id, up_z),
        });
        let mounting = self.experiment.mountings.len();
        self.experiment.mountings.push(Mounting { position, arm_y: Vector3::zeros() });
        self.add(std::iter::once(SetPoint::at_rest(mounting, 0.0)));
    }

    /// A mounting of position `k` at `radius` with the fullest schedule of the position, or of any.
    fn mount(&mut self, k: usize, radius: f64) {
        let mountings = &self.experiment.mountings;
        let length = |m: &usize| self.plateaus.iter().filter(|(s, _)| s.mounting == *m).count();
        let own = (0..mountings.len()).rev().filter(|&m| mountings[m].position == k).max_by_key(length);
        let Some(model) = own.or_else(|| (0..mountings.len()).rev().max_by_key(length)) else { return };
        let arm_y = Vector3::new(radius, mountings[model].arm_y.y, mountings[model].arm_y.z);
        let mounting = mountings.len();
        let schedule: Vec<SetPoint> = self.plateaus.iter().map(|(s, _)| *s).filter(|s| s.mounting == model).collect();
        self.experiment.mountings.push(Mounting { position: k, arm_y });
        self.add(schedule.into_iter().map(|s| SetPoint { mounting, ..s }));
    }

    /// Set points in the order of mountings, and the weights of those that are read.
    fn finish(mut self) -> (Experiment, Vec<Weight>) {
        self.plateaus.sort_by_key(|(set_point, _)| set_point.mounting);
        self.experiment.set_points = self.plateaus.iter().map(|(set_point, _)| *set_point).collect();
        let read = self.plateaus.iter().enumerate();
        let weights = read.filter_map(|(n, (_, c))| c.map(|covariance| Weight { set_point: n, covariance })).collect();
        (self.experiment, weights)
    }
}

/// A radius of zero or more as a key that sorts as it does.
fn radius_key(mounting: &Mounting) -> u64 {
    mounting.arm_y.x.abs().to_bits()
}

fn mountings_text(mountings: &[usize], experiment: &Experiment) -> String {
    match mountings {
        [m] => {
            let Mounting { position, arm_y } = &experiment.mountings[*m];
            format!("mounting {} (position {}, {:.4} m)", m + 1, experiment.positions[*position].id, arm_y.x)
        }
        _ if mountings.len() == experiment.mountings.len() => "every mounting".to_owned(),
        _ => format!("mountings {}", listed(mountings.iter().map(|m| (m + 1).to_string()))),
    }
}

/// `position 1`, `positions 1, 2`, `every position`.
pub(super) fn positions_text(positions: &[usize], experiment: &Experiment) -> String {
    let ids = positions.iter().map(|&k| experiment.positions[k].id.clone());
    match positions {
        [_] => format!("position {}", listed(ids)),
        _ if positions.len() == experiment.positions.len() => "every position".to_owned(),
        _ => format!("positions {}", listed(ids)),
    }
}

fn listed(items: impl Iterator<Item = String>) -> String {
    items.collect::<Vec<_>>().join(", ")
}

/// Where the first two instrument axes point in arm axes, which says where the third does.
fn attitude_text(position: &Position) -> String {
    const NAMES: [[&str; 2]; 3] = [["outward", "inward"], ["along the motion", "against the motion"], ["up", "down"]];
    let along = |i: usize| {
        let row = position.p_zy.row(i);
        let axis = (0..3).find(|&j| (row[j].abs() - 1.0).abs() < 1e-9)?;
        Some(format!("axis {} {}", i + 1, NAMES[axis][usize::from(row[axis] < 0.0)]))
    };
    let oblique = |i: usize| {
        let row = position.p_zy.row(i).map(|c| (c * 1e3).round() / 1e3 + 0.0);
        format!("axis {} along ({}, {}, {}) in arm axes", i + 1, row[0], row[1], row[2])
    };
    let axes: Vec<String> = (0..2).map(|i| along(i).unwrap_or_else(|| oblique(i))).collect();
    format!("a position with {}", axes.join(", "))
}

/// The faces, edges and corners of a cube, in this order, as directions.
pub fn cube_directions() -> Vec<Vector3<f64>> {
    let signs = || [0.0, 1.0, -1.0].into_iter();
    let all = signs().flat_map(|x| signs().flat_map(move |y| signs().map(move |z| Vector3::new(x, y, z))));
    let mut directions: Vec<Vector3<f64>> = all.filter(|direction| *direction != Vector3::zeros()).collect();
    directions.sort_by(|a, b| a.norm_squared().total_cmp(&b.norm_squared()));
    directions.into_iter().map(|direction| direction.normalize()).collect()
}

/// Where the axes point in an attitude in which up is `up_z`: `axes 1, 2 up, axis 3 down, each 55 deg from the vertical`.
pub fn attitude_in_words(up_z: &Vector3<f64>) -> String {
    let along = |sign: f64| (0..3).filter(|&i| up_z[i] * sign > 0.1).map(|i| (i + 1).to_string()).collect::<Vec<_>>();
    let part = |axes: Vec<String>, way: &str| match axes.len() {
        0 => None,
        1 => Some(format!("axis {} {way}", axes[0])),
        _ => Some(format!("axes {} {way}", axes.join(", "))),
    };
    let parts: Vec<String> = [part(along(1.0), "up"), part(along(-1.0), "down")].into_iter().flatten().collect();
    let from_vertical = up_z.amax().min(1.0).acos().to_degrees();
    let oblique =
        if from_vertical < 1.0 { String::new() } else { format!(", each {from_vertical:.0} deg from the vertical") };
    format!("{}{oblique}", parts.join(", "))
}

/// A name that no position and no pair has.
pub(super) fn new_id(known: &[Position]) -> String {
    let mut id = format!("new {}", known.len() + 1);
    while known.iter().any(|p| p.id == id || p.pair == id) {
        id.push('+');
    }
    id
}
