//! The shape of a plateau's reading in time: the columns of its design.

use super::revolution::cos_sin;

/// Which terms a plateau has: `[cos, sin,] [settling,] 1`. The constant stands last.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shape {
    /// Where phase and settling count from [s].
    pub start: f64,
    /// Speed [rad/s]; 0 for no once-per-revolution term.
    pub omega: f64,
    /// What is left of the settling.
    pub settling: Option<Settling>,
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

    /// What is left after a time, over the straight part at the start.
    pub fn value(self, since: f64) -> f64 {
        let fading = (-since / self.time).exp();
        fading * (1.0 + self.bend * fading)
    }
}

impl Shape {
    /// The design at the times `t`, one column a term.
    pub fn columns(&self, t: &[f64]) -> Vec<Vec<f64>> {
        let mut columns = Vec::with_capacity(4);
        if self.omega != 0.0 {
            let (cos, sin) = cos_sin(self.omega, self.start, t);
            columns.extend([cos, sin]);
        }
        columns.extend(self.settling.map(|settling| {
            // Beyond forty time constants less is left of the settling than rounding leaves of a reading.
            let over = t.partition_point(|t| t - self.start < 40.0 * settling.time);
            let mut column: Vec<f64> = t[..over].iter().map(|t| settling.value(t - self.start)).collect();
            column.resize(t.len(), 0.0);
            column
        }));
        columns.push(vec![1.0; t.len()]);
        columns
    }
}
