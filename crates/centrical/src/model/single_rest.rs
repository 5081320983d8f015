//! Unknowns that few equations contain: of the positions, and the attitudes of rests that gravity alone shows.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::Vector3;

use super::experiment::SetPoint;
use super::measurement::MeasurementModel;
use super::parameters::OfPosition;
use super::prior::Prior;
use crate::linalg::least_squares::Own;

impl MeasurementModel {
    /// The attitudes of rests in free positions that one of the plateaus `set_points` is in. Equations are three per plateau, then those of
    /// `priors`.
    pub(crate) fn attitudes_of_single_rests(&self, set_points: &[usize], priors: &[Prior]) -> Vec<Own> {
        let position = |set_point: usize| self.position_of(set_point);
        let mut plateaus = vec![0; self.experiment.positions.len()];
        for &set_point in set_points {
            plateaus[position(set_point)] += 1;
        }
        let of_parameter = self.rows_of_priors(3 * set_points.len(), priors);
        let own = |(n, &set_point): (usize, &usize)| {
            let position = position(set_point);
            let OfPosition::Free { attitude, .. } = self.parameters.of_position(position) else { return None };
            let columns = vec![attitude, attitude + 1];
            let rows =
                (3 * n..3 * n + 3).chain(columns.iter().flat_map(|&j| of_parameter[j].iter().copied())).collect();
            (plateaus[position] == 1).then_some(Own { columns, rows })
        };
        set_points.iter().enumerate().filter_map(own).collect()
    }

    /// The turns and shifts of positions on the arm, those together that have a shift in common, and the attitudes of free positions, with
    /// the equations that contain them: three per plateau, then those of `priors`.
    pub(crate) fn unknowns_of_positions(&self, set_points: &[usize], priors: &[Prior]) -> Vec<Own> {
        let mut groups: BTreeMap<usize, (BTreeSet<usize>, Vec<usize>)> = BTreeMap::new();
        for (n, &set_point) in set_points.iter().enumerate() {
            let (shared, turn) = match self.parameters.of_position(self.position_of(set_point)) {
                OfPosition::OnArm { turn, shift } => (shift.column, turn..turn + 3),
                OfPosition::Free { attitude, .. } => (attitude, 0..0),
            };
            let (columns, rows) = groups.entry(shared).or_default();
            columns.extend([shared, shared + 1].into_iter().chain(turn));
            rows.extend(3 * n..3 * n + 3);
        }
        let of_parameter = self.rows_of_priors(3 * set_points.len(), priors);
        let own = |(columns, mut rows): (BTreeSet<usize>, Vec<usize>)| {
            rows.extend(columns.iter().flat_map(|&j| of_parameter[j].iter().copied()));
            Own { columns: columns.into_iter().collect(), rows }
        };
        groups.into_values().map(own).collect()
    }

    /// The rows of the priors of each parameter, that of the first prior being `first`.
    fn rows_of_priors(&self, first: usize, priors: &[Prior]) -> Vec<Vec<usize>> {
        let mut rows = vec![Vec::new(); self.parameters.len()];
        priors.iter().enumerate().for_each(|(n, prior)| rows[prior.parameter].push(first + n));
        rows
    }

    fn position_of(&self, set_point: usize) -> usize {
        self.experiment.mountings[self.experiment.set_points[set_point].mounting].position
    }

    /// [`Linearisation::normal`] of a plateau with these derivatives by its unknowns.
    pub(super) fn normal(&self, set_point: &SetPoint, columns: &[(usize, Vector3<f64>)]) -> Option<Vector3<f64>> {
        let position = self.experiment.mountings[set_point.mounting].position;
        let OfPosition::Free { attitude, case_turn: None } = self.parameters.of_position(position) else { return None };
        let by =
            |unknown: usize| columns.iter().find(|(column, _)| *column == unknown).map(|(_, derivative)| derivative);
        by(attitude)?.cross(by(attitude + 1)?).try_normalize(0.0)
    }
}
