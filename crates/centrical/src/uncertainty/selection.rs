//! Choice of the model: rivals fitted to the same plateaus and compared by F test, BIC and hold-out score.
//!
//! With stated weights `BIC = chi^2 + k ln n` (Schwarz) for `k` unknowns determined and `n` readings. One more unknown pays
//! when it lowers chi^2 by more than `ln n`: 5.8 for the 324 readings of 108 plateaus, 2.4 standard uncertainties. A term
//! that is not there gets so far once in sixty sessions, one of five standard uncertainties fails to once in two hundred.

use std::collections::HashSet;

use centrical_compensate::Monomial;

use super::rivals::columns::{Columns, columns_of};
use super::verdict::Level;
use crate::fit::{Calibration, Data, Termination};
use crate::model::{ErrorModel, FitError, Kind, MeasurementModel, Observation, Parameter, Rival};
use crate::progress::{OnProgress, advance, unwatched};
use crate::statistics::{Test, chi_squared_tail, f_tail};

/// A model that could be meant.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidate {
    /// Its name for people.
    pub name: String,
    /// What it adds to the model as stated.
    pub rivals: Vec<Rival>,
    /// The model.
    pub model: MeasurementModel,
}

/// A candidate after its fit.
#[derive(Debug, Clone, PartialEq)]
pub struct FittedCandidate {
    /// Its name.
    pub name: String,
    /// What it adds to the model as stated.
    pub rivals: Vec<Rival>,
    /// Unknowns that the data determine.
    pub rank: usize,
    /// Unknowns that it has.
    pub unknowns: usize,
    /// Whether the fit converged; a candidate that did not is never recommended.
    pub converged: bool,
    /// Sum of squared whitened residuals.
    pub chi_squared: f64,
    /// Its degrees of freedom.
    pub degrees_of_freedom: usize,
    /// `chi^2 + (rank + traced) ln n`.
    pub bic: f64,
    /// Combinations beyond the rank that second-order traces determine at the estimate, in part or in whole: the fit follows them too.
    pub traced: f64,
    /// Score of the prediction of each mounting from the others ([`super::Validity::hold_out_score`]): the lower the better.
    pub hold_out_score: f64,
    /// Index of the largest candidate nested in it, if there is one, and the F test of the further unknowns that are determined: whether they
    /// are all zero.
    pub against: Option<(usize, Test)>,
}

/// The candidates and what follows.
#[derive(Debug, Clone, PartialEq)]
pub struct ModelSelection {
    /// In the order of the candidates, without rivals that the data determine nothing of.
    pub candidates: Vec<FittedCandidate>,
    /// Index of the candidate recommended: the lowest BIC of those that converged, the simplest of those alike.
    pub recommended: usize,
    /// Rivals that the data determine nothing of at `X = 0`: they are no candidates.
    pub undetermined: Vec<Rival>,
    /// The optional terms one by one: those of the recommended model, then those that richer candidates have beyond it.
    pub terms: Vec<TermVerdict>,
}

/// Whether a term is there.
#[derive(Debug, Clone, PartialEq)]
pub struct TermVerdict {
    /// Name of its coefficient.
    pub name: String,
    /// Estimate over standard uncertainty, in the recommended model or as its one further term; `None` if it is not
    /// determined.
    pub significance: Option<f64>,
    /// Whether it is worth an unknown: its square exceeds `ln n`; of a further term, at a family-wise error of 5 % too.
    pub kept: bool,
}

/// The candidates beside a model: the linear part of its error model alone, with squares, with cubes, the model itself, and the
/// model with each rival of the catalogue that it leaves out.
fn candidates_of(model: &MeasurementModel) -> Vec<Candidate> {
    let part = |keep: &dyn Fn(&Monomial) -> bool| ErrorModel {
        terms: model.error_model().terms.iter().filter(|t| keep(&t.monomial)).cloned().collect(),
    };
    let parts = [
        ("linear", part(&|m| m.degree() <= 1)),
        ("linear + squares", part(&|m| m.degree() <= 2)),
        ("linear + cubes", part(&|m| m.degree() != 2)),
        (AS_STATED, model.error_model().clone()),
    ];
    let mut candidates: Vec<Candidate> = Vec::new();
    for (name, error_model) in parts {
        let Some(model) = model.with_error_model(error_model) else { continue };
        let names = |m: &MeasurementModel| m.parameters().iter().map(|p| p.name.clone()).collect::<Vec<_>>();
        if candidates.iter().all(|c| names(&c.model) != names(&model)) {
            candidates.push(Candidate { name: name.to_owned(), rivals: Vec::new(), model });
        }
    }
    let of_session = |rival: &Rival| Rival::COMMON.contains(rival);
    candidates.extend(model.left_out().into_iter().filter(of_session).map(|rival| with_rivals(model, vec![rival])));
    candidates
}

const AS_STATED: &str = "as stated";

fn with_rivals(model: &MeasurementModel, rivals: Vec<Rival>) -> Candidate {
    let names: Vec<String> = rivals.iter().map(|rival| rival.name()).collect();
    Candidate { name: format!("{AS_STATED} + {}", names.join(" + ")), model: model.with_rivals(&rivals), rivals }
}

impl ModelSelection {
    /// Compares the candidates beside `model`, and the model with pairs of the three rivals that lower BIC most.
    ///
    /// # Errors
    /// [`FitError`] when an observation is invalid.
    pub fn beside(
        model: &MeasurementModel,
        observations: &[Observation],
        progress: OnProgress<usize>,
    ) -> Result<Self, FitError> {
        let single = candidates_of(model);
        let data = data_of(&single, observations)?;
        let mut fits = fits(&single, &data, progress)?;
        let paired = pairs(model, &fits)?;
        let data_of_pairs = data_of(&paired, observations)?;
        fits.extend(self::fits(&paired, &data_of_pairs, progress)?);
        conclude(&fits)
    }

    /// Fits all `candidates` to the same plateaus and compares them.
    ///
    /// # Errors
    /// [`FitError`] when an observation is invalid, or without a candidate ([`FitError::Empty`]).
    pub fn of(
        candidates: &[Candidate],
        observations: &[Observation],
        progress: OnProgress<usize>,
    ) -> Result<Self, FitError> {
        let data = data_of(candidates, observations)?;
        conclude(&fits(candidates, &data, progress)?)
    }
}

/// Rivals that are tried in pairs.
const PAIRED: usize = 3;

/// The model with pairs of the rivals that lower BIC most by themselves.
fn pairs(model: &MeasurementModel, single: &[(&Candidate, Calibration)]) -> Result<Vec<Candidate>, FitError> {
    let with_bic =
        |(candidate, calibration): &(_, Calibration)| Ok((*candidate, bic(calibration, traced(calibration)?)));
    let bics: Vec<(&Candidate, f64)> = single.iter().map(with_bic).collect::<Result<_, FitError>>()?;
    let as_stated = bics.iter().find(|(candidate, _)| candidate.name == AS_STATED).map(|(_, bic)| *bic);
    let lowered = |(candidate, bic): &(&Candidate, f64)| match candidate.rivals[..] {
        [rival] => Some((*bic, rival)).filter(|_| as_stated.is_some_and(|stated| *bic < stated)),
        _ => None,
    };
    let mut lower: Vec<(f64, Rival)> = bics.iter().filter_map(lowered).collect();
    lower.sort_by(|a, b| a.0.total_cmp(&b.0));
    lower.truncate(PAIRED);
    let with_later = |(n, (_, first)): (usize, &(f64, Rival))| {
        let later = lower[n + 1..].iter();
        later.map(|(_, second)| with_rivals(model, vec![*first, *second])).collect::<Vec<_>>()
    };
    Ok(lower.iter().enumerate().flat_map(with_later).collect())
}

/// The plateaus with the model of each candidate.
fn data_of<'c>(candidates: &'c [Candidate], observations: &[Observation]) -> Result<Vec<Data<'c>>, FitError> {
    candidates.iter().map(|candidate| Data::new(&candidate.model, observations.to_vec())).collect()
}

/// The candidates with their fits to `data`, in the same order.
fn fits<'c>(
    candidates: &'c [Candidate],
    data: &'c [Data<'c>],
    progress: OnProgress<usize>,
) -> Result<Vec<(&'c Candidate, Calibration<'c>)>, FitError> {
    let fit = |(candidate, data): (&'c Candidate, &'c Data<'c>)| {
        let calibration = Calibration::exact(data)?;
        advance(progress, 1)?;
        Ok((candidate, calibration))
    };
    candidates.iter().zip(data).map(fit).collect()
}

/// Compares the fits.
fn conclude(all: &[(&Candidate, Calibration)]) -> Result<ModelSelection, FitError> {
    let fits = with_further_unknowns(all);
    let is_kept = |rivals: &[Rival]| fits.iter().any(|(candidate, _)| candidate.rivals == rivals);
    // An effect that finds nothing to act on in the experiment has no unknowns: it is not undetermined.
    let acts = |Candidate { model, rivals, .. }: &Candidate| match rivals[..] {
        [Rival::Effect(effect)] => !effect.parameters(model.experiment(), model.error_model()).is_empty(),
        [Rival::Terms(_)] => true,
        _ => false,
    };
    let dropped = all.iter().filter(|(candidate, _)| acts(candidate) && !is_kept(&candidate.rivals));
    let undetermined = dropped.flat_map(|(candidate, _)| candidate.rivals.iter().copied()).collect();
    let mut fitted: Vec<FittedCandidate> = fits
        .iter()
        .map(|(candidate, calibration)| candidate_fitted(candidate, calibration))
        .collect::<Result<_, _>>()?;
    let candidates: Vec<&Candidate> = fits.iter().map(|(candidate, _)| *candidate).collect();
    for n in 0..fitted.len() {
        fitted[n].against = nested_test(&candidates, &fitted, n);
    }
    let least = |all: &mut dyn Iterator<Item = usize>| all.min_by(|&a, &b| fitted[a].bic.total_cmp(&fitted[b].bic));
    let converged = || (0..fitted.len()).filter(|&n| fitted[n].converged);
    // Where no model fits, the stated weights make every gain large. The F test compares it with the chi^2 of the richer model.
    let is_gain = |n: &usize| {
        let by_chance = fitted[*n].against.map_or(1.0, |(_, test)| test.probability);
        fitted[*n].rivals.is_empty() || Level::Reported.is_passed_by(by_chance)
    };
    let recommended =
        least(&mut converged().filter(is_gain)).or_else(|| least(&mut converged())).ok_or(FitError::Empty)?;
    let best = Best(&fits[recommended].1);
    let mut terms = best.own_terms();
    terms.extend(best.further_terms(&candidates)?);
    Ok(ModelSelection { candidates: fitted, recommended, undetermined, terms })
}

fn candidate_fitted(candidate: &Candidate, calibration: &Calibration) -> Result<FittedCandidate, FitError> {
    let (fit, data) = (calibration.fit(), calibration.data());
    let (rank, traced) = (fit.observability().rank(), traced(calibration)?);
    Ok(FittedCandidate {
        name: candidate.name.clone(),
        rivals: candidate.rivals.clone(),
        rank,
        unknowns: data.model().parameters().len(),
        converged: fit.termination == Termination::Converged,
        chi_squared: fit.chi_squared,
        degrees_of_freedom: fit.degrees_of_freedom,
        bic: bic(calibration, traced),
        traced,
        hold_out_score: calibration.validity()?.hold_out_score,
        against: None,
    })
}

/// Combinations beyond the rank that a fit follows: the lost ones, as far as second-order traces determine them at the estimate.
fn traced(calibration: &Calibration) -> Result<f64, FitError> {
    let seen = calibration.fit().observability();
    if seen.lost() == 0 {
        return Ok(0.0);
    }
    let followed = seen.rank() + calibration.data().model().influences().len();
    Ok((calibration.gain()?.leverage() - followed as f64).clamp(0.0, seen.lost() as f64))
}

/// `chi^2 + k ln n` for `k` combinations that the fit follows and `n` readings, three per plateau (Schwarz).
fn bic(calibration: &Calibration, traced: f64) -> f64 {
    let fit = calibration.fit();
    let followed = fit.observability().rank() as f64 + traced;
    fit.chi_squared + followed * (3.0 * calibration.data().observations().len() as f64).ln()
}

/// The candidates whose unknowns are a part of those of candidate `n`, and those before it that have the same.
fn nested_in(candidates: &[&Candidate], n: usize) -> Vec<usize> {
    let names = |m: usize| candidates[m].model.parameters().iter().map(|p| p.name.as_str()).collect::<HashSet<_>>();
    let own = names(n);
    let is_part = |m: &usize| names(*m).is_subset(&own) && (*m < n || names(*m).len() < own.len());
    (0..candidates.len()).filter(is_part).collect()
}

/// The fits without those of rivals that the data determine nothing of: they fit as well as the model without the rival.
fn with_further_unknowns<'f, 'c>(
    fits: &'f [(&'c Candidate, Calibration<'c>)],
) -> Vec<&'f (&'c Candidate, Calibration<'c>)> {
    let candidates: Vec<&Candidate> = fits.iter().map(|(candidate, _)| *candidate).collect();
    let rank = |n: usize| fits[n].1.fit().observability().rank();
    let determines_more = |n: usize| nested_in(&candidates, n).iter().all(|&m| rank(m) < rank(n));
    let is_kept = |n: &usize| candidates[*n].rivals.is_empty() || determines_more(*n);
    (0..fits.len()).filter(is_kept).map(|n| &fits[n]).collect()
}

/// Test of candidate `n` against the largest one nested in it that determines less; `None` where no degree of freedom remains for it.
fn nested_test(candidates: &[&Candidate], fitted: &[FittedCandidate], n: usize) -> Option<(usize, Test)> {
    let determines_less = |m: &usize| fitted[*m].rank < fitted[n].rank;
    let nested = nested_in(candidates, n).into_iter().filter(determines_less).max_by_key(|&m| fitted[m].rank)?;
    let (simple, rich) = (&fitted[nested], &fitted[n]);
    let further = rich.rank - simple.rank;
    // Counted by the rank alone, what traces of lost combinations explain by chance would pass for a gain.
    let followed = further as f64 + (rich.traced - simple.traced).max(0.0);
    let left = Some(rich.degrees_of_freedom as f64 - rich.traced).filter(|left| *left > 0.0)?;
    let statistic = ((simple.chi_squared - rich.chi_squared) / followed) / (rich.chi_squared / left);
    Some((nested, Test { statistic, degrees_of_freedom: further, probability: f_tail(statistic, followed, left) }))
}

/// The calibration with the recommended model.
struct Best<'a>(&'a Calibration<'a>);

impl Best<'_> {
    /// What one more unknown has to lower chi^2 by.
    fn threshold(&self) -> f64 {
        (3.0 * self.0.data().observations().len() as f64).ln()
    }

    /// The terms of the model that could be left out, each by its own uncertainty.
    fn own_terms(&self) -> Vec<TermVerdict> {
        let optional = self
            .0
            .data()
            .model()
            .parameters()
            .iter()
            .enumerate()
            .filter(|(_, p)| can_go(self.0.data().model(), p.kind));
        let verdict = optional.map(|(j, parameter)| {
            let significance =
                self.0.fit().value(j).zip(self.0.fit().standard_uncertainty(j)).map(|(value, u)| value / u);
            let kept = significance.is_some_and(|t| t * t > self.threshold());
            TermVerdict { name: parameter.name.clone(), significance, kept }
        });
        verdict.collect()
    }

    /// The terms that richer candidates have beyond the model, each as the one further unknown of it: by what is
    /// redundant of its column in the readings and of the residuals. As there are many, each has to pass a family-wise
    /// error of 5 % as well.
    fn further_terms(&self, candidates: &[&Candidate]) -> Result<Vec<TermVerdict>, FitError> {
        let mut terms: Vec<TermVerdict> = Vec::new();
        for richer in candidates.iter().map(|c| &c.model) {
            let (further, columns) = self.further_columns(richer)?;
            let square = columns.redundancy();
            for (c, j) in further.into_iter().enumerate() {
                let name = &richer.parameters()[j].name;
                if terms.iter().all(|t| t.name != *name) {
                    let is_seen = square[(c, c)] > REDUNDANT * REDUNDANT;
                    let significance = is_seen.then(|| columns.along[c] / square[(c, c)].sqrt());
                    terms.push(TermVerdict { name: name.clone(), significance, kept: false });
                }
            }
        }
        let count = terms.len() as f64;
        for term in &mut terms {
            let square = term.significance.map_or(0.0, |t| t * t);
            let is_real = Level::Reported.is_passed_by(count * chi_squared_tail(square, 1));
            term.kept = square > self.threshold() && is_real;
        }
        Ok(terms)
    }

    /// The optional unknowns of `richer` that the model lacks, with their columns at the estimate; none if `richer` lacks
    /// any of the model's own.
    fn further_columns(&self, richer: &MeasurementModel) -> Result<(Vec<usize>, Columns), FitError> {
        let (own, observations) = (self.0.data().model().parameters(), self.0.data().observations());
        let is_further = |p: &Parameter| own.find(&p.name).is_none() && can_go(richer, p.kind);
        let has_own = own.iter().all(|p| richer.parameters().find(&p.name).is_some());
        let further = richer.parameters().iter().enumerate().filter(|(_, p)| has_own && is_further(p));
        let further: Vec<usize> = further.map(|(j, _)| j).collect();
        let mut x = vec![0.0; richer.parameters().len()];
        for (parameter, value) in own.iter().zip(self.0.fit().state()) {
            if let Some(j) = richer.parameters().find(&parameter.name) {
                x[j] = *value;
            }
        }
        let columns = columns_of(&further, (richer, &x), observations, &unwatched)?;
        let columns = Columns::new(self.0.gain()?, columns);
        Ok((further, columns))
    }
}

/// A column is untestable when less than this part of it is redundant: the unknowns follow the rest.
const REDUNDANT: f64 = 1e-6;

/// Whether an unknown can be left out: squares and more, and the extensions.
fn can_go(model: &MeasurementModel, kind: Kind) -> bool {
    match kind {
        Kind::Term(index) => model.error_model().terms[index].monomial.degree() >= 2,
        Kind::Effect(_) => true,
        Kind::Tilt(_)
        | Kind::Turn { .. }
        | Kind::Shift { .. }
        | Kind::Attitude { .. }
        | Kind::CaseTurn(_)
        | Kind::ProofMass(_) => false,
    }
}
