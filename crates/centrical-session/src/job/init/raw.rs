//! Readings at rest and at the fastest speed, and the coarse scale and bias of a raw output that they show.

use centrical::STANDARD_GRAVITY;

/// Mean readings of a mounting at rest and at its fastest speed.
#[derive(Debug, Clone, Copy)]
pub(super) struct Extremes {
    pub rest: [f64; 3],
    pub fast: [f64; 3],
    /// The fastest speed [rad/s].
    pub omega: f64,
}

/// Raw output per m/s^2, and raw output at no force.
#[derive(Debug, Clone, Copy)]
pub(super) struct Raw {
    pub scale: [f64; 3],
    pub bias: [f64; 3],
}

impl Extremes {
    /// In m/s^2.
    pub(super) fn in_si(&self, raw: &Raw) -> Option<Self> {
        let si = |f: [f64; 3]| [0, 1, 2].map(|j| (f[j] - raw.bias[j]) / raw.scale[j]);
        let si = Self { rest: si(self.rest), fast: si(self.fast), omega: self.omega };
        si.rest.iter().chain(&si.fast).all(|f| f.is_finite()).then_some(si)
    }

    /// Radius of the proof mass along the arm [m].
    pub(super) fn radius(&self) -> f64 {
        (0..3).map(|j| (self.fast[j] - self.rest[j]).powi(2)).sum::<f64>().sqrt() / self.omega.powi(2)
    }
}

impl Raw {
    /// Scale and bias from gravity. In most mountings an axis is horizontal: the median of its readings at rest is its bias;
    /// where it is vertical it reads most beside that, which is 1 g. None before three mountings, or without an axis vertical.
    pub(super) fn by_gravity(extremes: &[Option<Extremes>]) -> Option<Self> {
        let rests: Vec<[f64; 3]> = extremes.iter().flatten().map(|e| e.rest).collect();
        if rests.len() < 3 {
            return None;
        }
        let of_axis = |j: usize| {
            let mut readings: Vec<f64> = rests.iter().map(|rest| rest[j]).collect();
            readings.sort_by(f64::total_cmp);
            let bias = readings[readings.len() / 2];
            let most = readings.iter().map(|reading| (reading - bias).abs()).fold(0.0, f64::max);
            (most / STANDARD_GRAVITY, bias)
        };
        let [x, y, z] = [0, 1, 2].map(of_axis);
        let raw = Self { scale: [x.0, y.0, z.0], bias: [x.1, y.1, z.1] };
        let largest = raw.scale.iter().copied().fold(0.0, f64::max);
        raw.scale.iter().all(|scale| *scale > 0.1 * largest).then_some(raw)
    }
}
