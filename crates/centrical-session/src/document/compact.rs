//! A result as the row of a store.

use centrical::{Group, Source};

use super::documents::ObjectionName;
use super::json::Word;
use super::result::{CalibrationResult, ParameterEstimate, PriorSummary};
use crate::store::{Row, RowPrior, SharedInfluence, Status, days_since_1970, sha256, whole};

impl CalibrationResult {
    /// The row of the result, whose file has these `bytes`.
    pub fn row(&self, bytes: &[u8]) -> Row {
        let inputs = self.inputs.iter().flat_map(|input| [input.sha256.as_str(), " ", input.path.as_str(), "\n"]);
        let inputs: String = inputs.collect();
        let objections = self.objections();
        let of_parameters =
            |text: fn(&ParameterEstimate) -> String| self.parameters.iter().map(text).collect::<Vec<_>>();
        let raw_output = self.raw_output();
        let covariance = self.packed_covariance();
        let (shared, priors) = (self.shared_influences(), self.row_priors());
        Row {
            key: sha256(bytes),
            status: Status::Done,
            unit_model: self.session.unit_model.clone(),
            unit_serial: self.session.unit_serial.clone(),
            title: self.session.title.clone(),
            date: self.session.date.clone(),
            day: days_since_1970(&self.session.date),
            station: self.session.station.clone(),
            gravity: self.model.gravity,
            program: self.program.version.clone(),
            inputs: sha256(inputs.as_bytes()),
            reference: self.model.reference.name().to_owned(),
            range: self.range().to_vec(),
            termination: self.fit.termination.word().to_owned(),
            chi_squared: self.fit.chi_squared,
            degrees_of_freedom: whole(self.fit.degrees_of_freedom),
            rank: whole(self.observability.rank),
            columns: whole(self.observability.columns),
            acceptable: objections.is_empty(),
            objections: objections.iter().map(|objection| ObjectionName::from(objection).word().to_owned()).collect(),
            parameters: of_parameters(|p| p.name.clone()),
            units: of_parameters(|p| p.unit.clone()),
            groups: self.parameters.iter().map(|p| p.group).collect(),
            values: self.parameters.iter().map(|p| p.value.unwrap_or(f64::NAN)).collect(),
            standard_uncertainties: self.standard_uncertainties(),
            covariance,
            output_unit: raw_output.map_or_else(String::new, |output| output.unit.clone()),
            output_scale: raw_output.map_or_else(Vec::new, |output| output.scale.to_vec()),
            output_bias: raw_output.map_or_else(Vec::new, |output| output.bias.to_vec()),
            terms: self.model.error_model.clone(),
            shared_known: shared.is_some(),
            shared: shared.unwrap_or_default(),
            priors_known: priors.is_some(),
            priors: priors.unwrap_or_default(),
            ..Row::default()
        }
    }

    /// By the covariance, which the row states beside them. A linear fit has another budget: that of the estimate which it finds.
    fn standard_uncertainties(&self) -> Vec<f64> {
        let own = |(n, p): (usize, &ParameterEstimate)| {
            let variance = self.covariance.get(n).and_then(|row| *row.get(n)?);
            variance.map(f64::sqrt).or(p.standard_uncertainty).unwrap_or(f64::NAN)
        };
        self.parameters.iter().enumerate().map(own).collect()
    }

    fn packed_covariance(&self) -> Vec<f64> {
        let rows = self.covariance.iter().enumerate();
        rows.flat_map(|(i, row)| row.iter().take(i + 1).map(|c| c.unwrap_or(f64::NAN))).collect()
    }

    /// Largest magnitude of the specific force on each axis; of the readings in results of older programs.
    fn range(&self) -> [f64; 3] {
        let forces =
            |axis: usize| self.plateaus.iter().map(move |p| p.specific_force.as_ref().unwrap_or(&p.mean)[axis].abs());
        [0, 1, 2].map(|axis| forces(axis).fold(0.0, f64::max))
    }

    /// The priors on parameters of the unit; none if the result does not say what they leave.
    fn row_priors(&self) -> Option<Vec<RowPrior>> {
        let with_prior = self.parameters.iter().filter_map(|p| Some((p, p.prior?))).collect::<Vec<_>>();
        if with_prior.is_empty() {
            return Some(Vec::new());
        }
        let sources = &self.budget.as_ref()?.sources;
        let changes = sources.iter().find(|source| source.name == Source::Priors)?.changes.as_ref()?;
        let is_of_unit = |p: &ParameterEstimate| p.group == Group::ProofMass || self.is_coefficient(p);
        let of_unit = with_prior.into_iter().zip(changes).filter(|((p, _), _)| is_of_unit(p));
        let row = |((p, prior), changes): ((&ParameterEstimate, PriorSummary), &Vec<Option<f64>>)| RowPrior {
            parameter: p.name.clone(),
            mean: prior.mean,
            standard_uncertainty: prior.standard_uncertainty,
            changes: changes.iter().map(|change| change.unwrap_or(f64::NAN)).collect(),
        };
        Some(of_unit.map(row).collect())
    }

    /// None if the result does not say.
    fn shared_influences(&self) -> Option<Vec<SharedInfluence>> {
        let mut shared = Vec::new();
        for source in self.budget.as_ref()?.sources.iter().filter(|source| Source::is_shared(source.name)) {
            for influence in source.changes.as_ref()? {
                let changes = influence.iter().map(|change| change.unwrap_or(f64::NAN)).collect();
                shared.push(SharedInfluence { source: source.name.word().to_owned(), changes });
            }
        }
        Some(shared)
    }
}
