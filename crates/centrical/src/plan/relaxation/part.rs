//! A part of many candidates, which grows by those that would gain most (column generation: Dantzig and Wolfe 1960).

use super::point::Point;
use super::polytope::Polytope;
use crate::plan::atom::Atoms;
use crate::plan::scenarios::LinearisedScenarios;

/// Up to this many candidates are searched all at once.
pub(in crate::plan) const FEW: usize = 1000;

/// Candidates of the first part that are evenly spread.
const FIRST: usize = 300;

/// Candidates by which a part grows at most.
const MORE: usize = 250;

/// Candidates that are searched, in rising order.
pub(super) struct Part(Vec<usize>);

impl Part {
    /// The first part: candidates evenly spread over those that may be visited, and those that `start` visits. `None` where there
    /// are few enough for a search among all.
    pub fn first(polytope: &Polytope, start: Option<&[f64]>) -> Option<Self> {
        let Polytope { atoms, low, .. } = polytope;
        let open: Vec<usize> = (0..atoms.candidates).filter(|&c| polytope.is_open(c)).collect();
        if open.len() <= FEW {
            return None;
        }
        let spread = (0..FIRST).map(|k| open[k * open.len() / FIRST]);
        let is_visited = |c: &usize| atoms.of(*c).any(|x| low[x] > 0.0 || start.is_some_and(|start| start[x] > 0.0));
        let visited = (0..atoms.candidates).filter(is_visited);
        let mut chosen: Vec<usize> = spread.chain(visited).collect();
        chosen.sort_unstable();
        chosen.dedup();
        Some(Self(chosen))
    }

    /// Takes in the candidates whose visits would lower the criterion most at a point of a design; whether there are any.
    pub fn grow(&mut self, polytope: &Polytope, point: &Point) -> bool {
        let gain = |c: usize| {
            let of_atom = |x: usize| point.sensitivity[x] - point.lambda * polytope.price[x];
            polytope.atoms.of(c).map(of_atom).fold(0.0, f64::max)
        };
        let is_new = |c: &usize| self.0.binary_search(c).is_err() && polytope.is_open(*c);
        let new = (0..polytope.atoms.candidates).filter(is_new).map(|c| (gain(c), c));
        let mut more: Vec<(f64, usize)> = new.filter(|(gain, _)| *gain > 0.0).collect();
        more.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        more.truncate(MORE);
        self.0.extend(more.iter().map(|(_, c)| c));
        self.0.sort_unstable();
        !more.is_empty()
    }

    /// The scenarios with these candidates.
    pub fn of_scenarios(&self, scenarios: &LinearisedScenarios, atoms: Atoms) -> LinearisedScenarios {
        let all = scenarios.all.iter().map(|scenario| scenario.part(&self.0, atoms)).collect();
        LinearisedScenarios { all, robustness: scenarios.robustness }
    }

    /// The bounds of these candidates.
    pub fn of_polytope(&self, polytope: &Polytope) -> Polytope {
        let Polytope { price, time, low, high, atoms, most } = polytope;
        Polytope {
            price: self.of_atoms(price, *atoms),
            time: *time,
            low: self.of_atoms(low, *atoms),
            high: self.of_atoms(high, *atoms),
            atoms: Atoms { candidates: self.0.len(), ..*atoms },
            most: self.0.iter().map(|&c| most[c]).collect(),
        }
    }

    /// What some numbers, one for each atom, are for the atoms of these candidates.
    pub fn of_atoms(&self, all: &[f64], atoms: Atoms) -> Vec<f64> {
        self.0.iter().flat_map(|&c| atoms.of(c)).map(|x| all[x]).collect()
    }

    /// Visits of these candidates as visits of all.
    pub fn among_all(&self, visits: &[f64], atoms: Atoms) -> Vec<f64> {
        let mut all = vec![0.0; atoms.count()];
        for (visits, &c) in visits.chunks(atoms.durations).zip(&self.0) {
            all[atoms.of(c)].copy_from_slice(visits);
        }
        all
    }
}
