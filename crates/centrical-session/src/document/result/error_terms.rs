//! The error model that a result holds, as compensation takes it.

use std::path::Path;

use centrical_compensate::{Compensation, Monomial, NotInvertible, Term};

use super::schema::CalibrationResult;
use crate::error::{Error, NoErrorModel};
use crate::store::TermSummary;

impl CalibrationResult {
    /// The terms of the error model with their estimated coefficients, in the order of the model.
    ///
    /// # Errors
    /// [`NoErrorModel`] naming the coefficient that is not known.
    pub fn error_terms(&self) -> Result<Vec<Term>, NoErrorModel> {
        self.model.error_model.iter().map(|term| self.error_term(term)).collect()
    }

    /// Largest magnitude of a plateau's mean reading on any axis [m/s^2]: how far the calibration reaches.
    pub fn calibrated_range(&self) -> f64 {
        self.plateaus.iter().flat_map(|plateau| plateau.mean).fold(0.0, |largest, f| f.abs().max(largest))
    }

    /// Largest magnitude on each axis of readings that the calibration covers [m/s^2]: that of the plateaus' means, and a
    /// hundredth more, since samples scatter about their mean. Beyond it the error model is extrapolated.
    pub fn calibrated_readings(&self) -> [f64; 3] {
        [0, 1, 2]
            .map(|axis: usize| 1.01 * self.plateaus.iter().map(|plateau| plateau.mean[axis].abs()).fold(0.0, f64::max))
    }

    /// Range over which to compensate if none is asked for [m/s^2]: twice the calibrated range, since ramps and
    /// vibration go beyond plateaus, or as far as the inverse of the model with `terms` is certain.
    ///
    /// # Errors
    /// [`NotInvertible`] when it is not certain over the calibrated range.
    pub fn compensation_range(&self, terms: &[Term]) -> Result<f64, NotInvertible> {
        let calibrated = self.calibrated_range();
        let margin = Compensation::new(terms, calibrated)?.certificate().margin;
        // At the margin itself rounding decides whether the inverse is certain.
        Ok(calibrated * (margin * (1.0 - 1e-9)).min(2.0))
    }

    /// The compensation by this result, which is in `file`, over `range` [m/s^2], by default over that of
    /// [`CalibrationResult::compensation_range`]. It gives specific forces in the axes that the result is stated in.
    ///
    /// # Errors
    /// [`Error`] where the result lacks a coefficient, or its model is not certain to be invertible over the range.
    pub fn compensation(&self, file: &Path, range: Option<f64>) -> Result<Compensation<Vec<Term>>, Error> {
        let no_model = |source| Error::ErrorModel { file: file.to_owned(), source };
        let terms = self.error_terms().map_err(no_model)?;
        let range = range.map_or_else(|| self.compensation_range(&terms), Ok);
        let compensation = range.and_then(|range| Compensation::new(terms, range));
        compensation.map(|compensation| self.in_its_axes(compensation)).map_err(|source| match source {
            NotInvertible::Jump { term, axis } => {
                let name = self.model.error_model[term].name.clone();
                no_model(NoErrorModel::Jump { name, number: axis + 1 })
            }
            source => Error::NotInvertible { file: file.to_owned(), source },
        })
    }

    /// A compensation by this result that gives specific forces in the axes that it is stated in.
    #[must_use]
    pub fn in_its_axes<T: AsRef<[Term]>>(&self, compensation: Compensation<T>) -> Compensation<T> {
        match &self.axes {
            Some(axes) => compensation.in_axes(axes.matrix),
            None => compensation,
        }
    }

    fn error_term(&self, term: &TermSummary) -> Result<Term, NoErrorModel> {
        let value = self.parameter(&term.name).and_then(|parameter| parameter.value);
        let not_estimable = || NoErrorModel::NotEstimable { name: term.name.clone() };
        let (axis, monomial) = (term.index_of(term.axis)?, term.monomial()?);
        Ok(Term { axis, monomial, coefficient: value.ok_or_else(not_estimable)? })
    }
}

impl TermSummary {
    /// The term with a value of its coefficient, and its name.
    ///
    /// # Errors
    /// As [`TermSummary::monomial`].
    pub(crate) fn with_coefficient(&self, coefficient: f64) -> Result<(String, Term), NoErrorModel> {
        Ok((self.name.clone(), Term { axis: self.index_of(self.axis)?, monomial: self.monomial()?, coefficient }))
    }

    /// What multiplies the coefficient.
    ///
    /// # Errors
    /// [`NoErrorModel::Axis`] when it takes the sign of a newtonometer that does not exist.
    pub fn monomial(&self) -> Result<Monomial, NoErrorModel> {
        let sign_of = self.sign_of.map(|number| self.index_of(number)).transpose()?;
        Ok(Monomial { powers: self.powers, sign_of })
    }

    /// Index of newtonometer 1, 2 or 3.
    fn index_of(&self, number: usize) -> Result<usize, NoErrorModel> {
        let index = number.checked_sub(1).filter(|axis| *axis < 3);
        index.ok_or_else(|| NoErrorModel::Axis { name: self.name.clone() })
    }
}
