//! Newton's iteration for the specific force that gives a reading.
//!
//! The unknown is the error `e = f' - f`, the solution of `E(f' - e) = e`: small beside the reading, so that its
//! rounding is too, and `f = f' - e` is exact almost to its last place. With the gain `J = I + E'` a step is
//! `e <- e + J^-1 (E(f' - e) - e)`. The last step may take the gain of the one before, which spares it a quarter of
//! the work. The certificate fixes the number of steps beforehand, whatever the reading.

use crate::certificate::{Certificate, START_REGION, Steps};
use crate::error::{NotInvertible, OutOfRange};
use crate::linear::{Inverse, Linear, solve};
use crate::separable::{Mixed, Separable, is_separable};
use crate::term::{ErrorModel, Term};

/// A range ends a few last places beyond its edge, so that what lies on it is not refused for its rounding.
const EDGE: f64 = 1.0 + 8.0 * f64::EPSILON;

/// The inverse of an error model over a range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Compensation<'t> {
    separable: Separable,
    /// All terms, if some do not fit the fast form.
    terms: Option<&'t [Term]>,
    linear: Linear,
    certificate: Certificate,
    steps: Steps,
}

impl<'t> Compensation<'t> {
    /// The inverse of `f' = f + E(f)`, `E` the sum of `terms`, for all `f` with `|f_i| <= range` [m/s^2].
    ///
    /// # Errors
    /// [`NotInvertible`] when a term makes no sense, the gain at zero is singular, or the non-linear terms are too
    /// strong for an inverse that is certainly unique: then it is said over which part of the range it is.
    pub fn new(terms: &'t [Term], range: f64) -> Result<Self, NotInvertible> {
        check(terms, range)?;
        let linear = Linear::of(terms).ok_or(NotInvertible::Singular)?;
        let certificate = Certificate::new(terms, &linear, range)?;
        // Half a unit in the last place of the range.
        let steps = certificate.steps(0.5 * f64::EPSILON);
        let separable = Separable::part_of(terms);
        let terms = (!terms.iter().all(is_separable)).then_some(terms);
        Ok(Self { separable, terms, linear, certificate, steps })
    }

    /// What was shown of the inverse.
    pub fn certificate(&self) -> &Certificate {
        &self.certificate
    }

    /// The affine part of the error model, where the iteration starts.
    pub fn linear(&self) -> &Linear {
        &self.linear
    }

    /// Specific force `f` [m/s^2] whose reading is `reading` [m/s^2].
    ///
    /// # Errors
    /// [`OutOfRange`] when no `f` of the range has this reading.
    pub fn apply(&self, reading: [f64; 3]) -> Result<[f64; 3], OutOfRange> {
        let mut lane = reading.map(|f| [f]);
        self.invert(&mut lane);
        let f = lane.map(|[f]| f);
        if f[0].is_nan() { Err(OutOfRange { reading, range: self.certificate.range }) } else { Ok(f) }
    }

    /// Takes `W` readings, by axes, to specific forces; NaN on all axes where there is none. No branch depends on a
    /// reading, so that the lanes go into vectors and each is what it would be alone.
    #[inline(always)]
    pub(crate) fn invert<const W: usize>(&self, f: &mut [[f64; W]; 3]) {
        match self.terms {
            None => self.invert_model(&self.separable, f),
            Some(terms) => self.invert_model(&Mixed { separable: self.separable, terms }, f),
        }
    }

    #[inline(always)]
    fn invert_model<const W: usize>(&self, model: &impl ErrorModel, f: &mut [[f64; W]; 3]) {
        let mut error = [[0.0; W]; 3];
        for w in 0..W {
            put(&mut error, w, self.start(get(f, w)));
        }
        for _ in 0..self.steps.newton {
            for w in 0..W {
                let next = newton_step(model, get(f, w), get(&error, w));
                put(&mut error, w, next);
            }
        }
        if self.steps.ends_in_pair {
            for w in 0..W {
                let next = newton_pair(model, get(f, w), get(&error, w));
                put(&mut error, w, next);
            }
        }
        for w in 0..W {
            let compensated = self.finish(get(f, w), get(&error, w));
            put(f, w, compensated);
        }
    }

    /// Error of a reading by the affine part of the model; NaN if that lies too far out.
    #[inline(always)]
    fn start(&self, reading: [f64; 3]) -> [f64; 3] {
        let f = self.linear.invert(reading);
        difference(reading, self.or_nan(f, START_REGION))
    }

    /// Reading less error; NaN if that lies out of range.
    #[inline(always)]
    fn finish(&self, reading: [f64; 3], error: [f64; 3]) -> [f64; 3] {
        self.or_nan(difference(reading, error), EDGE)
    }

    /// `f` within `scale` times the range, else NaN.
    #[inline(always)]
    fn or_nan(&self, f: [f64; 3], scale: f64) -> [f64; 3] {
        let h = scale * self.certificate.range;
        // Not short-circuited: a branch would keep the lanes out of vectors.
        let inside = (f[0].abs() <= h) & (f[1].abs() <= h) & (f[2].abs() <= h);
        if inside { f } else { [f64::NAN; 3] }
    }
}

/// `e + J^-1 (E(f' - e) - e)`.
#[inline(always)]
fn newton_step(model: &impl ErrorModel, reading: [f64; 3], e: [f64; 3]) -> [f64; 3] {
    let (error, gain) = model.error_and_gain(difference(reading, e));
    sum(e, solve(gain, difference(error, e)))
}

/// A Newton step and a second one with the gain of the first.
#[inline(always)]
fn newton_pair(model: &impl ErrorModel, reading: [f64; 3], e: [f64; 3]) -> [f64; 3] {
    let (error, gain) = model.error_and_gain(difference(reading, e));
    let inverse = Inverse::of(gain);
    let e = sum(e, inverse.times(difference(error, e)));
    let (error, _) = model.error_and_gain(difference(reading, e));
    sum(e, inverse.times(difference(error, e)))
}

#[inline(always)]
fn sum(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[inline(always)]
fn difference(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
fn get<const W: usize>(lanes: &[[f64; W]; 3], w: usize) -> [f64; 3] {
    [lanes[0][w], lanes[1][w], lanes[2][w]]
}

#[inline(always)]
fn put<const W: usize>(lanes: &mut [[f64; W]; 3], w: usize, v: [f64; 3]) {
    for i in 0..3 {
        lanes[i][w] = v[i];
    }
}

fn check(terms: &[Term], range: f64) -> Result<(), NotInvertible> {
    for (index, term) in terms.iter().enumerate() {
        for axis in [Some(term.axis), term.sign_of].into_iter().flatten() {
            if axis > 2 {
                return Err(NotInvertible::Axis { term: index, axis });
            }
        }
        if !term.coefficient.is_finite() {
            return Err(NotInvertible::Coefficient { term: index, coefficient: term.coefficient });
        }
        if let Some(axis) = term.sign_of.filter(|j| term.powers[*j] == 0) {
            return Err(NotInvertible::Jump { term: index, axis });
        }
    }
    if range > 0.0 && range.is_finite() { Ok(()) } else { Err(NotInvertible::Range { range }) }
}
