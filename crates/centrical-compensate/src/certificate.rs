//! Where the inverse is unique, and how fast Newton's iteration finds it: bounds from the coefficients alone.
//!
//! Let the reading be `F(f) = A f + b + N(f)`, `N` the non-linear terms, `C = A^-1`, `h` the range, `B_s` the
//! cube `|f_i| <= s h`, and `|v| = max_i |v_i| / h`. A monomial `m` of degree `d` and its derivatives are largest
//! at the corner of a cube, where Euler's theorem on homogeneous functions sums them:
//! `s h sum_j |m_,j| <= d m(s h)`, `s^2 h^2 sum_jk |m_,jk| <= d (d - 1) m(s h)`. With the weights
//! `w_it = |C_i,axis(t)| |c_t| m_t(s h) / h` this bounds, over `B_s`, in one sum over the terms,
//!
//! - shift: `|C N| <= eta = max_i sum_t w_it`;
//! - change of gain: `|C N'| <= kappa = max_i sum_t d w_it / s`;
//! - curvature: `|C N''| <= gamma = max_i sum_t d (d - 1) w_it / s^2`.
//!
//! A term with a kink (`|f1|`, `|f1| f2`) has no curvature there; its own change of gain `kappa'` takes its place.
//! The certificate is `kappa + 2 kappa' <= 1/3` over `B_2`, from which follow
//!
//! 1. uniqueness: `|C (F(u) - F(v)) - (u - v)| <= kappa |u - v|`, so `F` takes each value at most once in `B_2`;
//! 2. a start: `f_0 = C (f' - b)` lies within `eta` of the solution, so in `B_4/3` for every `f` of the range. And
//!    for every `f_0` in `B_4/3` there is a solution in `B_5/3` (`v -> f_0 - C N(v)` is a contraction there, its
//!    shift being at most `1/3` over `B_2`), so what comes out is never an artefact;
//! 3. convergence: let `e` be the distance to the solution. A fixed-point step `f <- f_0 - C N(f)` leaves at most
//!    `kappa e`, from `eta` on. A Newton step leaves at most `e (gamma e / 2 + 2 kappa') / (1 - kappa)`, which falls
//!    from the start on (it is required to halve at least). Both keep the iterates in `B_2`. The numbers of steps that
//!    reach rounding follow, once for all readings; a Newton step costs as much as three of the others.

use crate::error::NotInvertible;
use crate::linear::{Linear, is_affine};
use crate::term::Term;

/// Largest change of gain over twice the range, relative to the gain at zero, that makes an inverse certain.
pub const GAIN_CHANGE_LIMIT: f64 = 1.0 / 3.0;

/// A start `C (f' - b)` within this multiple of the range leads to a solution; one beyond it comes from out of range.
pub const START_REGION: f64 = 4.0 / 3.0;

/// The map is shown to be one-to-one within this multiple of the range.
const UNIQUE_REGION: f64 = 2.0;

/// What was shown of an inverse.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Certificate {
    /// Range `h`: readings of `|f_i| <= h` are inverted [m/s^2]. Over twice this cube no two specific forces give the
    /// same reading.
    pub range: f64,
    /// Bound on the change of the gain over twice the range, relative to the gain at zero; a kinked term counts
    /// three times. At most [`GAIN_CHANGE_LIMIT`].
    pub gain_change: f64,
    /// Factor by which the range could still grow; infinite for a linear model.
    pub margin: f64,
    /// Bound on the error of the start, relative to the range.
    start: f64,
    /// Bounds over the region of the starts.
    bounds: Bounds,
}

impl Certificate {
    /// Certifies the inverse of the model with `terms` and its affine part over `range`.
    pub(crate) fn new(terms: &[Term], linear: &Linear, range: f64) -> Result<Self, NotInvertible> {
        let over = |scale| Bounds::over(terms, linear, range, scale);
        let gain_change = over(UNIQUE_REGION).gain_change();
        let margin = largest_factor(|factor| over(factor * UNIQUE_REGION).is_certain(factor));
        if margin < 1.0 {
            return Err(NotInvertible::TooNonlinear { gain_change, limit: GAIN_CHANGE_LIMIT, factor: margin, range });
        }
        Ok(Self { range, gain_change, margin, start: over(1.0).shift, bounds: over(START_REGION) })
    }

    /// Newton steps from `C (f' - b)` after which the error, relative to the range, is at most `accuracy`, for the
    /// reading of every `f` of the range. At least one.
    pub fn newton_steps(&self, accuracy: f64) -> usize {
        self.newton_steps_from(self.start, accuracy)
    }

    /// Bound on the error of an iterate, relative to the range, after `steps` fixed-point steps `f <- f_0 - C N(f)`
    /// from `f_0 = C (f' - b)`.
    pub fn error_after(&self, steps: usize) -> f64 {
        (0..steps).fold(self.start, |error, _| error * self.bounds.gain)
    }

    /// The cheapest steps after which the error, relative to the range, is at most `accuracy`. The last one is Newton's:
    /// it corrects what rounding did to those before.
    pub(crate) fn steps(&self, accuracy: f64) -> Steps {
        let with = |fixed_point| Steps {
            fixed_point,
            newton: self.newton_steps_from(self.error_after(fixed_point), accuracy),
        };
        let newton = with(0);
        (1..newton.cost()).map(with).fold(newton, |best, steps| if steps.cost() < best.cost() { steps } else { best })
    }

    /// Newton steps, at least one, that bring an error to `accuracy`.
    fn newton_steps_from(&self, mut error: f64, accuracy: f64) -> usize {
        let mut steps = 0;
        while steps == 0 || error > accuracy {
            error *= self.bounds.rate(error);
            steps += 1;
        }
        steps
    }
}

/// How the iteration goes: fixed-point steps, then Newton's.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Steps {
    /// Steps `f <- f_0 - C N(f)`.
    pub fixed_point: usize,
    /// Newton steps.
    pub newton: usize,
}

impl Steps {
    /// In fixed-point steps, by the operations in each.
    fn cost(self) -> usize {
        self.fixed_point + 3 * self.newton
    }
}

/// Bounds over `B_s`, in units of the range.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Bounds {
    /// `eta`.
    shift: f64,
    /// `kappa`.
    gain: f64,
    /// `gamma`.
    curvature: f64,
    /// `kappa'`.
    kink: f64,
}

impl Bounds {
    fn over(terms: &[Term], linear: &Linear, range: f64, s: f64) -> Self {
        let mut bounds = Self { shift: 0.0, gain: 0.0, curvature: 0.0, kink: 0.0 };
        for i in 0..3 {
            let mut row = Self { shift: 0.0, gain: linear_defect(linear, i), curvature: 0.0, kink: 0.0 };
            for term in terms.iter().filter(|term| !is_affine(term)) {
                let d = f64::from(term.monomial.degree());
                let w = linear.inverse[i][term.axis].abs() * term.largest(s * range) / range;
                row.shift += w;
                row.gain += d * w / s;
                row.curvature += d * (d - 1.0) * w / (s * s);
                row.kink += if has_kink(term) { d * w / s } else { 0.0 };
            }
            bounds = bounds.or_larger(row);
        }
        bounds
    }

    fn or_larger(self, row: Self) -> Self {
        Self {
            shift: self.shift.max(row.shift),
            gain: self.gain.max(row.gain),
            curvature: self.curvature.max(row.curvature),
            kink: self.kink.max(row.kink),
        }
    }

    /// `kappa + 2 kappa'`.
    fn gain_change(&self) -> f64 {
        self.gain + 2.0 * self.kink
    }

    /// What a Newton step leaves of an error, relative to it.
    fn rate(&self, error: f64) -> f64 {
        (0.5 * self.curvature * error + 2.0 * self.kink) / (1.0 - self.gain)
    }

    /// Whether these bounds, taken over twice `factor` times the range, make the inverse certain there. A sum of
    /// positive numbers rounds in its last places only, and the three points have more room than that.
    fn is_certain(&self, factor: f64) -> bool {
        self.shift.is_finite()
            && factor.is_finite()
            && self.gain_change() <= GAIN_CHANGE_LIMIT
            && self.rate(self.shift) <= 0.5
    }
}

/// Bound on row `i` of `C A - E`: what rounding leaves of the inverse of the linear part.
fn linear_defect(linear: &Linear, i: usize) -> f64 {
    let mut sum = 0.0;
    for k in 0..3 {
        for j in 0..3 {
            sum += (linear.inverse[i][k] * linear.gain[k][j]).abs();
        }
    }
    // Three products and two sums in each cross product, the determinant and the entries.
    16.0 * f64::EPSILON * sum
}

/// Whether the derivative of a term jumps where its sign does.
fn has_kink(term: &Term) -> bool {
    term.monomial.sign_of.is_some_and(|j| term.monomial.powers[j] == 1)
}

/// Largest factor for which `is_certain`, which holds up to some factor and not beyond.
fn largest_factor(is_certain: impl Fn(f64) -> bool) -> f64 {
    let (mut certain, mut doubtful) = (0.0, 1.0);
    while is_certain(doubtful) {
        (certain, doubtful) = (doubtful, 2.0 * doubtful);
        if doubtful == f64::INFINITY {
            return f64::INFINITY;
        }
    }
    for _ in 0..50 {
        let middle = 0.5 * (certain + doubtful);
        if is_certain(middle) { certain = middle } else { doubtful = middle }
    }
    // The same sum over a range that is itself multiplied rounds otherwise.
    certain * (1.0 - 64.0 * f64::EPSILON)
}
