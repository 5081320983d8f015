//! The iteration for the specific force that gives a reading.
//!
//! From `f_0 = C (f' - b)`, which is exact without the non-linear terms `N`, fixed-point steps `f <- f_0 - C N(f)` gain
//! some digits each and cost little; Newton's step then doubles the digits. It goes for the error `e = f' - f`, the
//! solution of `E(f' - e) = e`: small beside the reading, so that its rounding is too, and `f = f' - e` is exact almost
//! to its last place. With the gain `J = I + E'` it is `e <- e + J^-1 (E(f' - e) - e)`. The certificate fixes the
//! numbers of steps beforehand, whatever the reading.

use crate::certificate::{Certificate, START_REGION, Steps};
use crate::error::{NotInvertible, OutOfRange};
use crate::fused::{dot, dot_and};
use crate::lanes::Lanes;
use crate::linear::{Linear, corrected};
use crate::machine::on_this_machine;
use crate::model::Model;
use crate::monomial::Monomial;
use crate::separable::Shift;
use crate::term::Term;

/// A range ends a few last places beyond its edge, so that what lies on it is not refused for its rounding.
const EDGE: f64 = 1.0 + 8.0 * f64::EPSILON;

/// The inverse of an error model over a range; its terms are borrowed, `&[Term]`, or its own, `Vec<Term>`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Compensation<T> {
    model: Model<T>,
    linear: Linear,
    shift: Shift,
    certificate: Certificate,
    steps: Steps,
    axes: Option<[[f64; 3]; 3]>,
}

impl<T: AsRef<[Term]>> Compensation<T> {
    /// The inverse of `f' = f + E(f)`, `E` the sum of `terms`, for all `f` with `|f_i| <= range` [m/s^2].
    ///
    /// # Errors
    /// [`NotInvertible`] when a term makes no sense, the gain at zero is singular, or the non-linear terms are too
    /// strong for an inverse that is certainly unique: then it is said over which part of the range it is.
    pub fn new(terms: T, range: f64) -> Result<Self, NotInvertible> {
        check(terms.as_ref(), range)?;
        let linear = Linear::of(terms.as_ref()).ok_or(NotInvertible::Singular)?;
        let certificate = Certificate::new(terms.as_ref(), &linear, range)?;
        // Half a unit in the last place of the range.
        let steps = certificate.steps(0.5 * f64::EPSILON);
        let model = Model::new(terms);
        let shift = model.separable.shift(&linear.inverse);
        Ok(Self { model, linear, shift, certificate, steps, axes: None })
    }

    /// The same with specific forces in other axes: `c_zb`, a rotation by its rows, takes coordinates there to coordinates in
    /// instrument axes, so that `f_b = c_zb^T f_z`. The range stays one of the instrument axes.
    #[must_use]
    pub fn in_axes(self, c_zb: [[f64; 3]; 3]) -> Self {
        Self { axes: Some(c_zb), ..self }
    }

    /// The rotation to instrument axes from those of the specific forces, if these are others.
    pub fn axes(&self) -> Option<&[[f64; 3]; 3]> {
        self.axes.as_ref()
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
        let mut lane = Lanes(reading.map(|f| [f]));
        on_this_machine(
            #[inline(always)]
            || self.invert(&mut lane),
        );
        let f = lane.at(0);
        if f[0].is_nan() { Err(OutOfRange { reading, range: self.certificate.range }) } else { Ok(f) }
    }

    /// Takes `W` readings, by axes, to specific forces; NaN on all axes where no force within the range gives the reading. No branch depends on a
    /// reading, so that the lanes go into vectors and each is what it would be alone.
    #[inline(always)]
    pub(crate) fn invert<const W: usize>(&self, f: &mut Lanes<W>) {
        if self.model.is_fast() {
            self.iterate::<W, true>(f);
        } else {
            self.iterate::<W, false>(f);
        }
        if let Some(c_zb) = &self.axes {
            for w in 0..W {
                let f_z = f.at(w);
                f.put(w, [0, 1, 2].map(|j| dot([c_zb[0][j], c_zb[1][j], c_zb[2][j]], f_z)));
            }
        }
    }

    /// The iteration; `FAST` when all terms fit the fast form, so that no lane asks for others.
    #[inline(always)]
    fn iterate<const W: usize, const FAST: bool>(&self, reading: &mut Lanes<W>) {
        let (mut start, mut f) = (Lanes::ZERO, Lanes::ZERO);
        let Linear { inverse, bias, .. } = &self.linear;
        let origin = self.linear.inverse_times(bias.map(|b| -b));
        for w in 0..W {
            let mut f_0 = [0, 1, 2].map(|i| dot_and(inverse[i], reading.at(w), origin[i]));
            // One is enough: every step mixes all components, and a coefficient of zero does not stop a NaN.
            f_0[0] = if self.is_within(f_0, START_REGION) { f_0[0] } else { f64::NAN };
            start.put(w, f_0);
            f.put(w, f_0);
        }
        for _ in 0..self.steps.fixed_point {
            self.fixed_point_step::<W, FAST>(&start, &mut f);
        }
        for w in 0..W {
            f.put(w, difference(reading.at(w), f.at(w)));
        }
        let error = &mut f;
        for _ in 0..self.steps.newton {
            self.newton_step::<W, FAST>(reading, error);
        }
        for w in 0..W {
            let f = difference(reading.at(w), error.at(w));
            reading.put(w, if self.is_within(f, EDGE) { f } else { [f64::NAN; 3] });
        }
    }

    /// `f <- f_0 - C N(f)`.
    #[inline(always)]
    fn fixed_point_step<const W: usize, const FAST: bool>(&self, start: &Lanes<W>, f: &mut Lanes<W>) {
        let others = (!FAST).then(|| self.model.others_error(f));
        for w in 0..W {
            let mut next = self.shift.step(start.at(w), f.at(w));
            if let Some(others) = &others {
                next = difference(next, self.linear.inverse_times(others.at(w)));
            }
            f.put(w, next);
        }
    }

    /// `e <- e + J^-1 (E(f' - e) - e)`.
    #[inline(always)]
    fn newton_step<const W: usize, const FAST: bool>(&self, reading: &Lanes<W>, e: &mut Lanes<W>) {
        let others = (!FAST).then(|| {
            let mut f = Lanes::<W>::ZERO;
            for w in 0..W {
                f.put(w, difference(reading.at(w), e.at(w)));
            }
            self.model.others(&f)
        });
        for w in 0..W {
            let e_w = e.at(w);
            let (mut misfit, mut gain) = self.model.separable.misfit_and_gain(difference(reading.at(w), e_w), e_w);
            if let Some(others) = &others {
                misfit = sum(misfit, others.error.at(w));
                gain = [0, 1, 2].map(|j| sum(gain[j], others.gain[j].at(w)));
            }
            e.put(w, corrected(e_w, gain, misfit));
        }
    }

    /// Whether `f` lies within `scale` times the range.
    #[inline(always)]
    fn is_within(&self, f: [f64; 3], scale: f64) -> bool {
        let h = scale * self.certificate.range;
        // Not short-circuited: a branch would keep the lanes out of vectors.
        (f[0].abs() <= h) & (f[1].abs() <= h) & (f[2].abs() <= h)
    }
}

#[inline(always)]
fn sum(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[inline(always)]
fn difference(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn check(terms: &[Term], range: f64) -> Result<(), NotInvertible> {
    for (index, term) in terms.iter().enumerate() {
        let Monomial { powers, sign_of } = term.monomial;
        for axis in [Some(term.axis), sign_of].into_iter().flatten() {
            if axis > 2 {
                return Err(NotInvertible::Axis { term: index, axis });
            }
        }
        if !term.coefficient.is_finite() {
            return Err(NotInvertible::Coefficient { term: index, coefficient: term.coefficient });
        }
        if let Some(axis) = sign_of.filter(|j| powers[*j] == 0) {
            return Err(NotInvertible::Jump { term: index, axis });
        }
    }
    if range > 0.0 && range.is_finite() { Ok(()) } else { Err(NotInvertible::Range { range }) }
}
