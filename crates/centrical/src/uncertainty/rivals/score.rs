//! The score test of every rival, and which of them explains the residuals best.

use super::catalogue::{Rivals, Suspect};
use super::columns::Seen;
use super::order::beyond_rounding;
use crate::model::{Parameter, Rival};
use crate::statistics::{chi_squared_tail, family_wise};
use crate::uncertainty::verdict::Level;

/// Part of what a rival explains that its own curvature may leave, since the score is linear in it: a shift of 10 mm on an arm of 0.5 m
/// leaves 1e-4, as its square.
const CURVATURE: f64 = 1e-3;

/// A rival and what the residuals say of it.
#[derive(Debug, Clone, PartialEq)]
pub struct RivalTest {
    /// Which.
    pub rival: Rival,
    /// Its unknowns, and for each the size that the residuals show with its standard uncertainty, `None` where they cannot
    /// tell it from the others.
    pub sizes: Vec<(Parameter, Option<(f64, f64)>)>,
    /// Part of chi^2 that it explains.
    pub statistic: f64,
    /// Number of its combinations that the data see.
    pub degrees_of_freedom: usize,
    /// Probability of so large a statistic by chance, for this rival alone, by what is stated and by the residuals' own scatter.
    pub probability: f64,
    /// The same, family-wise over all rivals tested (Holm).
    pub family_wise: f64,
    /// Probability by the stated variances of as large a chi^2 as it leaves, beyond what the curvature of the model may leave.
    pub probability_of_rest: f64,
}

/// The rivals that the residuals show.
#[derive(Debug, Clone, PartialEq)]
pub struct Suspects {
    /// Number of rivals that were tested.
    pub tested: usize,
    /// Those whose family-wise probability passes the level asked for: first that which explains most for its number of
    /// unknowns and those which the data cannot tell from it, by their number of unknowns; then the others.
    pub shown: Vec<RivalTest>,
    /// How many of them the data cannot tell apart, the first included.
    pub alike: usize,
}

impl RivalTest {
    /// What it explains, with a price of two for each unknown (Akaike): of two that explain alike, the simpler comes first.
    fn evidence(&self) -> f64 {
        self.statistic - 2.0 * self.degrees_of_freedom as f64
    }
}

impl Rivals<'_> {
    /// Asks the residuals for every rival, and returns those beyond the family-wise `level`.
    pub fn suspects(&self, level: f64) -> Suspects {
        let tested: Vec<&Suspect> = self.list.iter().filter(|suspect| suspect.seen.rank() > 0).collect();
        let mut tests: Vec<RivalTest> = tested.iter().map(|suspect| self.test(suspect)).collect();
        let probabilities: Vec<f64> = tests.iter().map(|test| test.probability).collect();
        let family_wise = family_wise(&probabilities);
        tests.iter_mut().zip(family_wise).for_each(|(test, probability)| test.family_wise = probability);
        tests.retain(|test| test.family_wise < level);
        tests.sort_by(|a, b| beyond_rounding(b.evidence(), a.evidence()));
        let best = tests.first().map(|test| test.rival);
        let (mut alike, others): (Vec<RivalTest>, Vec<RivalTest>) = tests
            .into_iter()
            .partition(|test| best.is_some_and(|best| !self.is_told_from(best, test.rival, tested.len())));
        // Further unknowns explain nothing that chance does not.
        alike.sort_by_key(|test| test.degrees_of_freedom);
        Suspects { tested: tested.len(), alike: alike.len(), shown: [alike, others].concat() }
    }

    /// Whether the residuals tell the rival `best`, the best of `tested`, from another: it explains what the other does not, and
    /// more than the best of `tested` would by chance.
    fn is_told_from(&self, best: Rival, other: Rival, tested: usize) -> bool {
        let (Some(best), Some(other)) = (self.get(best), self.get(other)) else { return true };
        let (redundancy, along) = best.columns.beside(&other.columns, &other.seen.inverse());
        let seen = Seen::of(redundancy, &best.least);
        let chance = tested as f64 * chi_squared_tail(seen.statistic(&along), seen.rank());
        Level::Reported.is_passed_by(chance)
    }

    /// The columns of a rival, and what is seen of them.
    pub(in crate::uncertainty) fn get(&self, rival: Rival) -> Option<&Suspect> {
        self.list.iter().find(|suspect| suspect.rival == rival)
    }

    /// The score test of one rival.
    fn test(&self, suspect: &Suspect) -> RivalTest {
        let fit = self.calibration.fit();
        let rank = suspect.seen.rank();
        let statistic = suspect.statistic();
        let left = fit.degrees_of_freedom.saturating_sub(rank);
        let rest = fit.chi_squared - (1.0 + CURVATURE) * statistic;
        let probability = self.scatter.chance_of_explaining(statistic, rank);
        RivalTest {
            rival: suspect.rival,
            sizes: sizes(suspect),
            statistic,
            degrees_of_freedom: rank,
            probability,
            family_wise: 1.0,
            probability_of_rest: chi_squared_tail(rest.max(0.0), left),
        }
    }
}

/// `S^+ t` with its standard uncertainties, where all unknowns are seen.
fn sizes(suspect: &Suspect) -> Vec<(Parameter, Option<(f64, f64)>)> {
    let Suspect { unknowns, columns, seen, .. } = suspect;
    let inverse = seen.inverse();
    let estimates = &inverse * &columns.along;
    let is_whole = seen.rank() == unknowns.len();
    let size = |c: usize| (estimates[c] / columns.lengths[c], inverse[(c, c)].sqrt() / columns.lengths[c]);
    unknowns.iter().enumerate().map(|(c, p)| (p.clone(), is_whole.then(|| size(c)))).collect()
}
