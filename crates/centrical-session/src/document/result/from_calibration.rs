//! From a fit to the result's form.

use centrical::uncertainty::Rivals;
use centrical::{
    Calibration, Fit, FitError, MeasurementModel, Mounting, OnProgress, Position, Prior, SetPoint, Termination, advance,
};
use nalgebra::{Matrix3, Vector3};

use super::budget_and_checks::{BudgetSummary, ValiditySummary};
use super::next_attitude::NextAttitudeSummary;
use super::rivals::RestsOn;
use super::schema::{
    CalibrationResult, ConvergenceSummary, FitSummary, Method, ModelSummary, MountingSummary, ObservabilitySummary,
    OutputSummary, ParameterEstimate, PlateauSummary, PositionSummary, PriorSummary, Program, SCHEMA, SessionSummary,
};
use super::speeds::SpeedsSummary;
use super::verdict::is_vague;
use crate::document::json::rows;
use crate::document::steadiness::{DriftSummary, TiltSummary};
use crate::experiment::{OutputUnit, Session};
use crate::record::{Columns, Scale};
use crate::reduced::{Reduced, ReducedPlateau};
use crate::store::TermSummary;

impl CalibrationResult {
    /// Puts a calibration and the reduced session that it rests on into the form of the file: with its budget and, for a fit
    /// on the exact model, its checks. `progress` is called between them.
    ///
    /// # Errors
    /// [`FitError`] when numbers overflow or the caller stops.
    pub fn from(
        calibration: &Calibration,
        session: &Session,
        reduced: &Reduced,
        progress: OnProgress,
    ) -> Result<Self, FitError> {
        let (model, fit) = (calibration.data().model(), calibration.fit());
        let budget = calibration.budget()?;
        advance(progress, 0)?;
        let count = model.parameters().len();
        // A scale that may be off by a tenth and more is not determined, whatever the rank.
        let has_none = |j| fit.standard_uncertainty(j).is_some_and(|u| is_vague(model.parameters()[j].group, u));
        let has_none: Vec<bool> = (0..count).map(has_none).collect();
        let covariance = |i: usize, j: usize| fit.covariance(i, j).filter(|_| !has_none[i] && !has_none[j]);
        let (validity, rests_on) = if fit.termination == Termination::Linear {
            (None, Vec::new())
        } else {
            let asked = |()| progress(0);
            let rivals = Rivals::of(calibration, &asked)?;
            let checks = ValiditySummary::of(calibration, &rivals, session.noise_at_most())?;
            advance(progress, 0)?;
            (Some(checks), RestsOn::all(model, rivals.rests_on(&asked)?))
        };
        advance(progress, 0)?;
        let next_attitude = NextAttitudeSummary::of(calibration)?;
        advance(progress, 0)?;
        let convergence = ConvergenceSummary::of(calibration)?;
        advance(progress, 0)?;
        Ok(Self {
            schema: SCHEMA.to_owned(),
            program: Program::this(),
            inputs: reduced.inputs.clone(),
            session: SessionSummary::new(session),
            model: ModelSummary { nominal_found: session.nominal_found, ..ModelSummary::new(model) },
            output: OutputSummary::of(session),
            axes: None,
            parameters: (0..count)
                .map(|j| ParameterEstimate::new(model, fit, j, covariance(j, j).map(f64::sqrt)))
                .collect(),
            covariance: (0..count).map(|i| (0..count).map(|j| covariance(i, j)).collect()).collect(),
            observability: ObservabilitySummary::new(model, fit),
            next_attitude,
            between_rests: None,
            turning: session.turning(),
            fit: FitSummary::new(calibration),
            mountings: mountings(model, reduced),
            plateaus: plateaus(calibration, session, reduced),
            convergence: Some(convergence),
            budget: Some(BudgetSummary::new(&budget, count, model.priors())),
            validity,
            rests_on,
            drift: DriftSummary::of(calibration, reduced)?,
            tilt: TiltSummary::of(calibration, reduced),
            speeds: SpeedsSummary::of(calibration, session, reduced)?,
            records: reduced.mountings.iter().map(|mounting| mounting.overview.clone()).collect(),
        })
    }
}

impl From<&(Prior, f64)> for PriorSummary {
    fn from((prior, posterior_over_prior): &(Prior, f64)) -> Self {
        let Prior { mean, standard_uncertainty, .. } = *prior;
        Self { mean, standard_uncertainty, posterior_over_prior: *posterior_over_prior }
    }
}

impl SessionSummary {
    fn new(session: &Session) -> Self {
        Self {
            title: session.title.clone(),
            date: session.date.clone(),
            unit_model: session.unit_model.clone(),
            unit_serial: session.unit_serial.clone(),
            station: session.station.clone(),
            text: session.text.clone(),
        }
    }

    /// The unit as messages name it.
    pub fn unit(&self) -> String {
        unit_name(&self.unit_model, &self.unit_serial)
    }
}

/// A unit of that model and serial number as messages name it; either may be empty.
pub fn unit_name(model: &str, serial: &str) -> String {
    match (model, serial) {
        ("", "") => "a unit without a name".to_owned(),
        (model, "") => format!("{model}, without a serial number"),
        ("", serial) => format!("serial {serial}"),
        (model, serial) => format!("{model}, serial {serial}"),
    }
}

impl CalibrationResult {
    /// The raw output that the estimates are relative to; `None` of a unit that puts out an acceleration.
    pub fn raw_output(&self) -> Option<&OutputSummary> {
        self.output.as_ref().filter(|output| output.is_raw())
    }
}

impl OutputSummary {
    /// That of a session, none if its records are in m/s^2. Columns in several units of acceleration have no unit together.
    pub(crate) fn of(session: &Session) -> Option<Self> {
        let columns = &session.columns.f;
        let is_one_unit = columns.iter().all(|column| column.unit == columns[0].unit);
        let is_other = session.output_unit != OutputUnit::Acceleration
            || columns.iter().any(|column| column.scale.factor != 1.0) && is_one_unit;
        // The reciprocal of a reciprocal is the number to 15 digits.
        let written = |scale: f64| format!("{scale:.14e}").parse().unwrap_or(scale);
        is_other.then(|| Self {
            unit: columns[0].unit.clone(),
            scale: [0, 1, 2].map(|axis| written(1.0 / columns[axis].scale.factor)),
            bias: [0, 1, 2].map(|axis| columns[axis].scale.offset),
        })
    }

    /// Whether it is no acceleration.
    pub(crate) fn is_raw(&self) -> bool {
        OutputUnit::named(&self.unit) != OutputUnit::Acceleration
    }

    /// The readings [m/s^2] of outputs.
    pub fn readings(&self, raw: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|axis| (raw[axis] - self.bias[axis]) * (1.0 / self.scale[axis]))
    }

    /// Columns of a record in that unit.
    pub(crate) fn columns(&self) -> Columns {
        let mut columns = Columns::default();
        for (axis, column) in columns.f.iter_mut().enumerate() {
            column.unit.clone_from(&self.unit);
            column.scale = Scale { offset: self.bias[axis], factor: 1.0 / self.scale[axis] };
        }
        columns
    }
}

impl ModelSummary {
    fn new(model: &MeasurementModel) -> Self {
        let experiment = model.experiment();
        let terms = model.error_model().terms.iter().map(|term| TermSummary {
            name: term.name.clone(),
            axis: term.axis + 1,
            powers: term.monomial.powers,
            sign_of: term.monomial.sign_of.map(|axis| axis + 1),
        });
        Self {
            error_model: terms.collect(),
            pair_relation: experiment.pair_relation,
            reference: experiment.unit.reference,
            gravity: experiment.site.gravity,
            latitude: experiment.site.latitude,
            speed_uncertainty: model.experiment().centrifuge.speed_uncertainty,
            nominal_found: false,
            positions: experiment.positions.iter().map(PositionSummary::new).collect(),
        }
    }
}

impl PositionSummary {
    fn new(position: &Position) -> Self {
        let Position { id, p_zy, pair, is_free, attitude_uncertainty, .. } = position;
        Self {
            id: id.clone(),
            pair: pair.clone(),
            matrix: rows(p_zy),
            is_free: *is_free,
            attitude_uncertainty: *attitude_uncertainty,
        }
    }
}

impl ConvergenceSummary {
    /// Stages that are kept: more than a plot can show apart.
    const STAGES: usize = 60;

    fn of(calibration: &Calibration) -> Result<Self, FitError> {
        let stages = calibration.convergence(Self::STAGES)?;
        Ok(Self {
            plateaus: stages.iter().map(|stage| stage.plateaus).collect(),
            standard_uncertainty: stages.into_iter().map(|stage| stage.standard_uncertainty).collect(),
        })
    }
}

impl ParameterEstimate {
    fn new(model: &MeasurementModel, fit: &Fit, j: usize, standard_uncertainty: Option<f64>) -> Self {
        let parameter = &model.parameters()[j];
        Self {
            name: parameter.name.clone(),
            value: fit.value(j).filter(|_| standard_uncertainty.is_some()),
            standard_uncertainty,
            unit: parameter.unit.clone(),
            group: parameter.group,
            estimable: standard_uncertainty.is_some(),
            prior: fit.prior_uses().iter().find(|(prior, _)| prior.parameter == j).map(PriorSummary::from),
            prior_share: if model.priors().is_empty() { None } else { fit.prior_share(j) },
            rests_on_prior: fit.rests_on_prior(j),
        }
    }
}

impl ObservabilitySummary {
    fn new(model: &MeasurementModel, fit: &Fit) -> Self {
        let seen = fit.observability();
        let named = |(j, component): &(usize, f64)| (model.parameters()[*j].name.clone(), (*component).into());
        Self {
            rank: seen.rank(),
            columns: seen.columns(),
            tolerance: centrical::Observability::RANK_TOLERANCE,
            singular_values: seen.singular_values().to_vec(),
            null_directions: seen.null_directions().iter().map(|d| d.terms().iter().map(named).collect()).collect(),
            null_directions_held: fit.null_directions_held,
        }
    }
}

impl FitSummary {
    fn new(calibration: &Calibration) -> Self {
        let fit = calibration.fit();
        let method = match fit.termination {
            Termination::Linear if calibration.is_recursive() => Method::RecursiveLinear,
            Termination::Linear => Method::Linear,
            _ if calibration.is_recursive() => Method::Recursive,
            Termination::Converged | Termination::Stalled | Termination::IterationLimit => Method::Exact,
        };
        Self {
            method,
            termination: fit.termination,
            iterations: fit.iterations,
            chi_squared: fit.chi_squared,
            degrees_of_freedom: fit.degrees_of_freedom,
        }
    }
}

fn mountings(model: &MeasurementModel, reduced: &Reduced) -> Vec<MountingSummary> {
    let experiment = model.experiment();
    let summary = |(n, mounting): (usize, &Mounting)| {
        let findings = reduced.mountings.get(n);
        MountingSummary {
            position: experiment.positions[mounting.position].id.clone(),
            arm: mounting.arm_y.into(),
            settling_time: findings.and_then(|f| f.settling_time),
            clock_offset: findings.and_then(|f| f.agreement?.offset).map(|[seconds, _]| seconds),
            interpolated: findings.and_then(|f| f.interpolated),
            unscheduled: findings.map(|f| f.unscheduled.clone()).unwrap_or_default(),
        }
    };
    experiment.mountings.iter().enumerate().map(summary).collect()
}

fn plateaus(calibration: &Calibration, session: &Session, reduced: &Reduced) -> Vec<PlateauSummary> {
    let (model, fit) = (calibration.data().model(), calibration.fit());
    let mut index = 0;
    let mut previous = None;
    let mut summaries = Vec::with_capacity(reduced.plateaus.len());
    let mut fitted = fit.observation_covariances.iter().zip(&fit.residuals);
    for (n, (set_point, plateau)) in model.experiment().set_points.iter().zip(&reduced.plateaus).enumerate() {
        let held_out = reduced.held_out.contains(&n);
        let next = if held_out { None } else { fitted.next().map(|(c, r)| (*c, *r)) };
        let (covariance, residual) = next.unwrap_or_else(|| against(calibration, set_point, plateau));
        index = if previous == Some(set_point.mounting) { index + 1 } else { 0 };
        previous = Some(set_point.mounting);
        let (seen, steady) = (plateau.seen.as_ref(), plateau.steady());
        let turning = steady.filter(|_| !set_point.is_rest());
        summaries.push(PlateauSummary {
            mounting: set_point.mounting + 1,
            index,
            speed: set_point.omega,
            speed_uncertainty: set_point.speed_uncertainty,
            set_speed: (session.speeds.is_in_files() && !set_point.is_rest())
                .then(|| session.experiment.set_points[n].omega),
            angle: set_point.is_rest().then_some(set_point.angle),
            window: plateau.window(),
            samples: plateau.samples,
            rejected: seen.map_or(0, |seen| seen.rejected as u64),
            mean: plateau.mean.into(),
            covariance: rows(&plateau.covariance),
            fit_covariance: rows(&covariance),
            residual: residual.into(),
            specific_force: Some(model.specific_force(set_point, fit.state()).into()),
            once_per_revolution: seen.and_then(|seen| amplitude(&seen.once_per_revolution)).map(Into::into),
            once_per_revolution_uncertainty: turning
                .map(|seen| seen.once_per_revolution_covariance.diagonal().map(f64::sqrt).into()),
            once_per_revolution_phase: turning.map(|seen| {
                let [c, s] = &seen.once_per_revolution;
                c.zip_map(s, |c, s| (-s).atan2(c)).into()
            }),
            drift: steady.map(|seen| seen.drift.into()),
            drift_uncertainty: steady.map(|seen| seen.drift_uncertainty.into()),
            left_out: steady.map(|seen| seen.left_out.into()),
            measured_speed: seen.and_then(|seen| seen.measured_speed),
            held_out,
        });
    }
    summaries
}

/// Amplitude of a harmonic from its two quadratures; `None` without a harmonic.
fn amplitude([cosine, sine]: &[Vector3<f64>; 2]) -> Option<Vector3<f64>> {
    Some(cosine.zip_map(sine, f64::hypot)).filter(|amplitude| *amplitude != Vector3::zeros())
}

/// Covariance with the speed's term and residual of a plateau against a fit that it has no part in.
fn against(calibration: &Calibration, set_point: &SetPoint, plateau: &ReducedPlateau) -> (Matrix3<f64>, Vector3<f64>) {
    let (covariance, reading) = calibration.expected(set_point, &plateau.covariance);
    (covariance, plateau.mean - reading)
}
