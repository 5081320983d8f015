//! The part of a record that is averaged, and the shape of its reading in time: the columns of its design.

use pulp::{Simd, WithSimd};

use super::simd::{cos_sin, exp, widest};

/// Time constants after which the settling is below the rounding of a reading.
pub(super) const FADED: f64 = 40.0;

/// Terms of a unit that turns, beside the constant.
pub(super) const TURNING: usize = 3;

/// The part of the record that a mean is taken over.
#[derive(Debug, Clone, Copy)]
pub(super) struct Window {
    /// From, to [s].
    pub span: [f64; 2],
    /// The fitted terms.
    pub shape: Shape,
}

/// The terms of a plateau: `[cos, sin,] [settling,] 1`, or `P_1, P_2, P_3, 1` of a unit that turns. The constant stands last.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shape {
    /// Origin of phase and settling [s].
    pub start: f64,
    /// Speed [rad/s]; 0 for no once-per-revolution term.
    pub omega: f64,
    /// The remaining settling.
    pub settling: Option<Settling>,
    /// The unit turns slowly: Legendre polynomials in its place, no other terms.
    pub turning: Option<Interval>,
}

/// An interval of time, on which Legendre polynomials are orthogonal.
#[derive(Debug, Clone, Copy)]
pub(super) struct Interval {
    /// Its middle [s].
    pub middle: f64,
    /// Half of its length [s].
    pub half: f64,
}

/// Settling of the speed by `epsilon exp(-x)`, `x = (t - start) / time`: the force, that goes with the square of the
/// speed, settles by
/// `2 epsilon (exp(-x) + epsilon/2 exp(-2x))`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Settling {
    /// Time constant [s].
    pub time: f64,
    /// `epsilon / 2`: a quarter of the relative error of the force at the start.
    pub bend: f64,
}

impl Settling {
    /// The same counted from `delay` later.
    pub fn after(self, delay: f64) -> Self {
        Self { bend: self.bend * (-delay / self.time).exp(), ..self }
    }

    /// Derivative of the value by the logarithm of the time constant.
    pub fn rate(self, since: f64) -> f64 {
        let x = since / self.time;
        let fading = (-x).exp();
        x * fading * (1.0 + 2.0 * self.bend * fading)
    }

    /// The settling after a time, relative to its linear part at the start.
    #[inline(always)]
    pub fn value(self, since: f64) -> f64 {
        let fading = exp(-since / self.time);
        fading * (1.0 + self.bend * fading)
    }

    /// The same at many instants.
    #[inline(always)]
    fn values(self, start: f64, t: &[f64], values: &mut [f64]) {
        if t.first().is_some_and(|first| first - start > FADED * self.time) {
            values.fill(0.0);
        } else {
            for (t, value) in t.iter().zip(values) {
                *value = self.value(t - start);
            }
        }
    }
}

impl Shape {
    /// Terms of the reading.
    pub fn terms(&self) -> usize {
        let turning = if self.turning.is_some() { TURNING } else { 0 };
        2 * usize::from(self.omega != 0.0) + usize::from(self.settling.is_some()) + turning + 1
    }

    /// The design at the times `t`, one column a term.
    pub fn columns(&self, t: &[f64]) -> Vec<Vec<f64>> {
        let mut columns = vec![vec![0.0; t.len()]; self.terms()];
        let mut rooms = columns.iter_mut().map(Vec::as_mut_slice).collect::<Vec<_>>();
        widest(Design { shape: self, t, columns: &mut rooms });
        columns
    }

    /// The same into existing `columns`, each as long as `t`.
    #[inline(always)]
    pub fn design(&self, t: &[f64], columns: &mut [&mut [f64]]) {
        let mut columns = columns.iter_mut();
        if self.omega != 0.0
            && let (Some(cos), Some(sin)) = (columns.next(), columns.next())
        {
            cos_sin(self.omega, self.start, t, cos, sin);
        }
        if let Some(settling) = self.settling
            && let Some(column) = columns.next()
        {
            settling.values(self.start, t, column);
        }
        if let Some(Interval { middle, half }) = self.turning
            && let (Some(p1), Some(p2), Some(p3)) = (columns.next(), columns.next(), columns.next())
        {
            for (((t, p1), p2), p3) in t.iter().zip(p1.iter_mut()).zip(p2.iter_mut()).zip(p3.iter_mut()) {
                let x = (t - middle) / half;
                (*p1, *p2, *p3) = (x, 1.5 * x * x - 0.5, (2.5 * x * x - 1.5) * x);
            }
        }
        if let Some(constant) = columns.next() {
            constant.fill(1.0);
        }
    }
}

/// A design to be filled in.
struct Design<'a, 'b> {
    shape: &'a Shape,
    t: &'a [f64],
    columns: &'a mut [&'b mut [f64]],
}

impl WithSimd for Design<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        self.shape.design(self.t, self.columns);
    }
}
