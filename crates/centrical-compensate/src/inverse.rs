//! The iteration for the specific force that gives a reading.
//!
//! From `f_0 = C (f' - b)`, which is exact without the non-linear terms `N`, fixed-point steps `f <- f_0 - C N(f)` gain
//! some digits each and cost little; Newton's step then doubles the digits. It goes for the error `e = f' - f`, the
//! solution of `E(f' - e) = e`: small beside the reading, so that its rounding is too, and `f = f' - e` is exact almost
//! to its last place. With the gain `J = I + E'` it is `e <- e + J^-1 (E(f' - e) - e)`. The certificate fixes the
//! numbers of steps beforehand, whatever the reading.
//!
//! Terms come as a slice: the iteration is then compiled in this crate, once, and a caller that is compiled for size loses nothing.

use crate::certificate::{Certificate, START_REGION, Steps};
use crate::error::{NotInvertible, OutOfRange};
use crate::linear::{Linear, corrected};
use crate::model::{Model, others, others_error};
use crate::separable::Shift;
use crate::term::Term;
use crate::vectors::fused::{dot, dot_and};
use crate::vectors::lanes::Lanes;
use crate::vectors::machine::on_this_machine;

/// A range ends a few last places beyond its edge, so that what lies on it is not refused for its rounding.
const EDGE: f64 = 1.0 + 8.0 * f64::EPSILON;

/// What the iteration takes besides the terms of the error model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Inverse {
    model: Model,
    pub linear: Linear,
    shift: Shift,
    pub certificate: Certificate,
    steps: Steps,
    /// The rotation to instrument axes from those of the specific forces, if these are others.
    pub axes: Option<[[f64; 3]; 3]>,
}

impl Inverse {
    /// The inverse for checked `terms` over a range [m/s^2].
    ///
    /// # Errors
    /// As [`Compensation::new`](crate::Compensation::new).
    pub fn new(terms: &[Term], range: f64) -> Result<Self, NotInvertible> {
        let linear = Linear::of(terms).ok_or(NotInvertible::Singular)?;
        let certificate = Certificate::new(terms, &linear, range)?;
        // Half a unit in the last place of the range.
        let steps = certificate.steps(0.5 * f64::EPSILON);
        let model = Model::new(terms);
        let shift = model.separable.shift(&linear.inverse);
        Ok(Self { model, linear, shift, certificate, steps, axes: None })
    }

    /// As [`Compensation::in_axes`](crate::Compensation::in_axes).
    pub fn in_axes(self, c_zb: [[f64; 3]; 3]) -> Self {
        Self { axes: Some(c_zb), ..self }
    }

    /// As [`Compensation::apply`](crate::Compensation::apply).
    pub fn apply(&self, terms: &[Term], reading: [f64; 3]) -> Result<[f64; 3], OutOfRange> {
        let mut lane = Lanes(reading.map(|f| [f]));
        on_this_machine(
            #[inline(always)]
            || self.invert(terms, &mut lane),
        );
        let f = lane.at(0);
        if f[0].is_nan() { Err(OutOfRange { reading, range: self.certificate.range }) } else { Ok(f) }
    }

    /// Takes `W` readings, by axes, to specific forces; NaN on all axes where no force within the range gives the reading. No branch depends on a
    /// reading, so that the lanes go into vectors and each is what it would be alone.
    #[inline(always)]
    pub fn invert<const W: usize>(&self, terms: &[Term], f: &mut Lanes<W>) {
        if self.model.is_fast() {
            self.iterate::<W, true>(terms, f);
        } else {
            self.iterate::<W, false>(terms, f);
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
    fn iterate<const W: usize, const FAST: bool>(&self, terms: &[Term], reading: &mut Lanes<W>) {
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
            self.fixed_point_step::<W, FAST>(terms, &start, &mut f);
        }
        for w in 0..W {
            f.put(w, difference(reading.at(w), f.at(w)));
        }
        let error = &mut f;
        for _ in 0..self.steps.newton {
            self.newton_step::<W, FAST>(terms, reading, error);
        }
        for w in 0..W {
            let f = difference(reading.at(w), error.at(w));
            reading.put(w, if self.is_within(f, EDGE) { f } else { [f64::NAN; 3] });
        }
    }

    /// `f <- f_0 - C N(f)`.
    #[inline(always)]
    fn fixed_point_step<const W: usize, const FAST: bool>(&self, terms: &[Term], start: &Lanes<W>, f: &mut Lanes<W>) {
        let others = (!FAST).then(|| others_error(terms, f));
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
    fn newton_step<const W: usize, const FAST: bool>(&self, terms: &[Term], reading: &Lanes<W>, e: &mut Lanes<W>) {
        let others = (!FAST).then(|| {
            let mut f = Lanes::<W>::ZERO;
            for w in 0..W {
                f.put(w, difference(reading.at(w), e.at(w)));
            }
            others(terms, &f)
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
