//! Values of chi^2 that stand for its whole law.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Values of chi^2 by degrees of freedom, each made when it is first asked for: that costs more than to use them.
#[derive(Debug, Default)]
pub struct Quantiles {
    by_degrees: Mutex<BTreeMap<usize, Arc<[Node]>>>,
}

/// Weight and value.
pub type Node = (f64, f64);

impl Quantiles {
    /// Those of `nu` degrees, from large to small; `None` of no degree.
    pub(super) fn of(&self, nu: usize) -> Option<Arc<[Node]>> {
        let law = ChiSquared::new(nu as f64).ok()?;
        let mut made = self.by_degrees.lock().unwrap_or_else(PoisonError::into_inner);
        Some(made.entry(nu).or_insert_with(|| nodes(&law)).clone())
    }
}

/// Equal steps of `s` with the probability `p = s^2 (3 - 2 s)`, dense at both ends.
fn nodes(law: &ChiSquared) -> Arc<[Node]> {
    let node = |n: usize| {
        let s = (n as f64 + 0.5) / NODES as f64;
        (6.0 * s * (1.0 - s) / NODES as f64, law.inverse_cdf(s * s * (3.0 - 2.0 * s)))
    };
    (0..NODES).rev().map(node).collect()
}

/// Tails of Student's t of one degree then come out to 0.1 %.
const NODES: usize = 96;
