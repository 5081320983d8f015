//! What a result rests on: for every rival the smallest size that the session would have shown, and what one of that size,
//! unseen, does to the result.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{DMatrix, Vector3};

use super::catalogue::{Rivals, Suspect};
use super::columns::Columns;
use super::order::beyond_rounding;
use super::power::non_centrality;
use crate::model::{FitError, Kind, Parameter, Rival, Weight};
use crate::observability::study::Study;
use crate::progress::{OnProgress, advance};
use crate::uncertainty::verdict::Level;

/// Power with which the smallest size is shown.
const POWER: f64 = 0.8;

/// A rival that cannot be seen at all is mentioned when one typical magnitude moves a parameter of the instrument by more than
/// this part of its standard uncertainty.
const HARMFUL: f64 = 0.1;

/// Below this part of its length a combination may be seen in second-order traces alone, which the structure of an experiment does not count.
const SECOND_ORDER: f64 = 1e-2;

/// A change below this part of a standard uncertainty is rounding.
const ROUNDING: f64 = 1e-6;

/// What a result rests on the absence of: the worst unknown of one rival.
#[derive(Debug, Clone, PartialEq)]
pub struct Unseen {
    /// The rival.
    pub rival: Rival,
    /// Its worst unknown.
    pub unknown: Parameter,
    /// Smallest size that the session shows with a power of 80 % at the level of an objection [unit of the unknown]; `None`
    /// when it would show none.
    pub size: Option<f64>,
    /// Index of the parameter of the instrument that a rival of that size, or of typical magnitude, moves most.
    pub parameter: usize,
    /// How far it moves it [unit of the parameter].
    pub shift: f64,
    /// The same over the standard uncertainty of the parameter.
    pub standard_uncertainties: f64,
    /// Largest error of a compensated reading at the forces of the session [m/s^2].
    pub reading: f64,
    /// Factor on the standard uncertainty of the parameter if the rival were an unknown of the fit; `None` if the data would then
    /// not determine every parameter of the instrument that they determine now.
    pub price: Option<f64>,
}

impl Unseen {
    /// The same for a smaller size, if there is one.
    fn shrink_to(&mut self, smaller: Option<f64>) {
        if let Some((size, smaller)) = self.size.zip(smaller).filter(|(size, smaller)| smaller < size) {
            let factor = smaller / size;
            self.size = Some(smaller);
            self.shift *= factor;
            self.standard_uncertainties *= factor;
            self.reading *= factor;
        }
    }
}

impl Rivals<'_> {
    /// What the result rests on, the worst first; effects with a stated uncertainty are left out. `progress` is called for each rival.
    ///
    /// # Errors
    /// [`FitError`] when numbers overflow or the caller stops.
    pub fn rests_on(&self, progress: OnProgress<()>) -> Result<Vec<Unseen>, FitError> {
        let ranks = self.list.iter().map(|suspect| suspect.seen.rank()).filter(|rank| *rank > 0);
        let level = Level::Objection.probability() / ranks.clone().count().max(1) as f64;
        let of_all = self.calibration.fit().degrees_of_freedom;
        let needed: BTreeMap<usize, Option<f64>> = ranks
            .collect::<BTreeSet<usize>>()
            .into_iter()
            .map(|rank| (rank, non_centrality(rank, of_all.saturating_sub(rank), level, POWER)))
            .collect();
        let needed = |suspect: &Suspect| needed.get(&suspect.seen.rank()).copied().flatten();
        let forces_z = self.forces();
        let mut list = Vec::new();
        for suspect in self.list.iter().filter(|suspect| !self.is_stated(suspect)) {
            advance(progress, ())?;
            if let Some((c, mut unseen)) = self.worst_of(suspect, needed(suspect), &forces_z)? {
                unseen.shrink_to(self.smallest_shown(&suspect.columns.only(c), needed));
                list.push(unseen);
            }
        }
        list.sort_by(|a, b| beyond_rounding(b.standard_uncertainties, a.standard_uncertainties));
        Ok(list)
    }

    /// Whether the laboratory states an uncertainty of each unknown of a rival: the budget then includes it.
    fn is_stated(&self, suspect: &Suspect) -> bool {
        let influences = self.calibration.data().model().influences();
        suspect
            .unknowns
            .iter()
            .all(|unknown| influences.iter().any(|stated| Kind::Effect(stated.effect) == unknown.kind))
    }

    /// Smallest size of a single column that any rival shows: with what of it lies within a rival's columns, `s_r^T s_c`, the
    /// rival's test has the non-centrality `a^2 (s_r^T s_c)^T (s_r^T s_r)^+ s_r^T s_c`.
    fn smallest_shown(&self, column: &Columns, needed: impl Fn(&Suspect) -> Option<f64>) -> Option<f64> {
        let sizes = self.list.iter().filter_map(|rival| {
            let across = rival.columns.redundancy_with(column).column(0).into_owned();
            let per_square = rival.seen.statistic(&across);
            let size = (needed(rival)? / per_square).sqrt() / column.lengths[0];
            size.is_finite().then_some(size)
        });
        sizes.min_by(f64::total_cmp)
    }

    /// The unknown of a rival that does most harm unseen, where its own test alone would show it, with its place.
    fn worst_of(
        &self,
        suspect: &Suspect,
        needed: Option<f64>,
        forces_z: &[Vector3<f64>],
    ) -> Result<Option<(usize, Unseen)>, FitError> {
        let Suspect { rival, unknowns, columns, least, .. } = suspect;
        let redundancy = columns.redundancy();
        let shifts = self.calibration.gain()?.shifts(&columns.followed);
        let candidates = unknowns.iter().enumerate().filter(|(c, _)| columns.lengths[*c] > 0.0);
        let candidates = candidates.filter_map(|(c, unknown)| {
            let is_seen = redundancy[(c, c)] > least[(c, c)];
            let size =
                needed.filter(|_| is_seen).map(|needed| (needed / redundancy[(c, c)]).sqrt() / columns.lengths[c]);
            let moved = shifts.column(c) * (columns.lengths[c] * size.unwrap_or(unknown.typical));
            let (parameter, harm) = self.most_moved(moved.as_slice())?;
            (size.is_some() || harm > HARMFUL).then_some((c, size, moved, parameter, harm))
        });
        let worst = candidates.max_by(|(.., a), (.., b)| beyond_rounding(*a, *b));
        let Some((c, size, moved, parameter, harm)) = worst else { return Ok(None) };
        let unseen = Unseen {
            rival: *rival,
            unknown: unknowns[c].clone(),
            size,
            parameter,
            shift: moved[parameter],
            standard_uncertainties: harm,
            reading: self.reading_error(moved.as_slice(), forces_z),
            price: self.price(suspect, &shifts, parameter)?,
        };
        Ok(Some((c, unseen)))
    }

    /// With the rival as an unknown the variance of a parameter grows by `g^T (s^T s)^+ g`, where `g` is its change by one unit
    /// of each column. There is no price where the fit would lose a parameter of the instrument that it determines now.
    fn price(&self, suspect: &Suspect, shifts: &DMatrix<f64>, parameter: usize) -> Result<Option<f64>, FitError> {
        let Some(u) = self.calibration.fit().standard_uncertainty(parameter) else { return Ok(None) };
        let g = shifts.row(parameter).transpose();
        let is_hardly_seen = suspect.seen.beyond(&g, 0.0).norm() > ROUNDING * u;
        let is_lost = match self.study_with(suspect, shifts)? {
            Some(study) => self.loses_instrument(&study) || is_hardly_seen && !self.loses_more(&study),
            None => is_hardly_seen,
        };
        Ok((!is_lost).then(|| (1.0 + suspect.seen.statistic(&g) / (u * u)).sqrt()))
    }

    /// The design with the unknowns of a rival at `X = 0`, where no second-order traces pass for knowledge: of one that concerns the whole
    /// session, and if what is hardly seen moves a parameter of the instrument.
    fn study_with(&self, suspect: &Suspect, shifts: &DMatrix<f64>) -> Result<Option<Study>, FitError> {
        let data = self.calibration.data();
        let moves = |(j, u): (usize, f64)| {
            suspect.seen.beyond(&shifts.row(j).transpose(), SECOND_ORDER.powi(2)).norm() > ROUNDING * u
        };
        if !Rival::COMMON.contains(&suspect.rival) || !self.instrument().any(moves) {
            return Ok(None);
        }
        let richer = data.model().with_rivals(&[suspect.rival]);
        // A plateau run again adds weight, which changes no rank.
        let (alike, mut kinds) = (richer.alike(), BTreeSet::new());
        let first = data.observations().iter().filter(|observation| kinds.insert(alike[observation.set_point]));
        let weights = first.map(Weight::from).collect();
        Study::at_zero(richer, weights).map(Some)
    }

    /// Whether a richer design loses a parameter of the instrument that is determined now.
    fn loses_instrument(&self, richer: &Study) -> bool {
        let parameters = self.calibration.data().model().parameters();
        let is_lost = |(j, _): (usize, f64)| {
            let there = richer.model().parameters().find(&parameters[j].name);
            there.is_none_or(|j| !richer.observability().is_estimable(j))
        };
        self.instrument().any(is_lost)
    }

    /// Whether a richer design loses more combinations than this one: a fit holds them, and what is hardly seen is among them.
    fn loses_more(&self, richer: &Study) -> bool {
        richer.observability().lost() > self.calibration.fit().observability().lost()
    }

    /// The parameters of the instrument that the data determine, each with its standard uncertainty.
    fn instrument(&self) -> impl Iterator<Item = (usize, f64)> {
        let (fit, parameters) = (self.calibration.fit(), self.calibration.data().model().parameters());
        let instrument = (0..parameters.len()).filter(|&j| parameters[j].is_of_instrument());
        instrument.filter_map(|j| Some((j, fit.standard_uncertainty(j)?)))
    }

    /// The estimable parameter of the instrument that moves most, and by how many standard uncertainties.
    fn most_moved(&self, moved: &[f64]) -> Option<(usize, f64)> {
        let uncertain = self.instrument().filter(|(_, u)| *u > 0.0);
        uncertain.map(|(j, u)| (j, (moved[j] / u).abs())).max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// The specific forces of the plateaus [m/s^2].
    fn forces(&self) -> Vec<Vector3<f64>> {
        let (data, x) = (self.calibration.data(), self.calibration.fit().state());
        let (model, set_points) = (data.model(), &data.model().experiment().set_points);
        data.observations().iter().map(|o| model.specific_force(&set_points[o.set_point], x)).collect()
    }

    /// Largest error of a compensated reading at the forces `forces_z`, where the coefficients are off by `moved`.
    fn reading_error(&self, moved: &[f64], forces_z: &[Vector3<f64>]) -> f64 {
        let model = self.calibration.data().model();
        let coefficients = &moved[model.parameters().first_term()..];
        let error = |f: &Vector3<f64>| {
            let mut error = Vector3::zeros();
            for (term, coefficient) in model.error_model().terms.iter().zip(coefficients) {
                error[term.axis] += coefficient * term.monomial.value((*f).into());
            }
            error.amax()
        };
        forces_z.iter().map(error).fold(0.0, f64::max)
    }
}
