//! Reduction of continuous records to plateau means.
//!
//! A record is one stream per mounting: plateaus of constant speed, ramps between them, and settling after
//! each ramp. Every scheduled plateau is found in the record itself, and its reading is estimated by
//!
//! `f'(t) = mean + a exp(-(t - t_0) / tau) + c cos(Omega (t - t_0)) + s sin(Omega (t - t_0)) + noise`,
//!
//! The second term is the remaining settling, the next two are the once-per-revolution term (tilt of the axis of rotation); at
//! rest the mean is the only term. The noise is coloured, and one plateau is too short to show its colour. It is pooled over all
//! plateaus of the session, or over those of each speed where they differ ([`NoiseModel`]). It then gives every mean its
//! covariance ([`ReducedMounting::means`]).
//!
//! Samples are taken with equal weight or rejected: spikes (off the fit by more than `sqrt(2 ln 20 n)` robust standard deviations of
//! `n` samples), stuck readings, and readings that are not numbers. Fewer than one in twenty plateaus loses a good sample on an axis.
//! So the mean has an efficiency above `1 - (2 ln 20 n) / (20 n)` of that of least squares, 0.999 of a thousand samples. Up to half of
//! the samples may be spikes.
//!
//! A record that a recording mistake explains decisively better, such as exchanged axes, is refused with the name of
//! that mistake ([`Mistake`]).
//!
//! Two passes, so that a record need never be held as a whole. The first condenses it to blocks ([`Survey`]), in which
//! the windows are found ([`Survey::locate`]); the second takes the samples of one window at a time ([`Averaging`]). [`Record::reduce`]
//! does both for a record in memory.

#![allow(
    clippy::inline_always,
    reason = "what is not inlined into the function with the wide vectors is compiled for the narrow ones"
)]

mod average;
mod block;
mod colour;
mod copies;
mod ellipsoid;
mod error;
mod locate;
mod mistake;
mod plateau;
mod record;
mod rests;
mod simd;
mod speed;
mod steady;
mod survey;
mod terms;
mod trembling;
mod turning;

pub use average::{Averaging, PlateauFit, ReducedMounting};
pub use colour::NoiseModel;
pub use copies::RepeatedRests;
pub use ellipsoid::CoarseScale;
pub use error::{ReductionError, Stretch};
pub use locate::{ClockAgreement, Located, PulseTrain, SpeedTrace};
pub use mistake::Mistake;
pub use plateau::{Arc, LeftOut, PlateauMean, ScheduledPlateau};
pub use record::{Record, RecordSlice};
pub use rests::Rests;
pub use speed::MeasuredSpeed;
pub use steady::{Staircase, SteadyStretch};
pub use survey::{Extremes, Survey};

impl Record {
    /// Finds and averages the scheduled plateaus of one mounting.
    ///
    /// The plateaus are found by the record and the schedule alone. Telemetry adds the offset of its clock and the measured
    /// speeds.
    ///
    /// # Errors
    /// [`ReductionError`] if the record is invalid (lengths, times), or a scheduled plateau is not in it.
    pub fn reduce(
        &self,
        telemetry: Option<&SpeedTrace>,
        schedule: &[ScheduledPlateau],
    ) -> Result<ReducedMounting, ReductionError> {
        let mut located = Survey::of(self.as_slice())?.locate(schedule)?;
        if let Some(telemetry) = telemetry {
            located.time_telemetry(telemetry);
        }
        located.averaged(self.as_slice())
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;
    use crate::reduction::simd::tests::on_all;
    use crate::statistics::Random;

    const RATE: f64 = 250.0;
    const PLATEAU: f64 = 12.0;
    const RAMP: f64 = 4.0;
    /// Samples of a plateau and the ramp after it.
    const STRETCH: usize = 4000;
    const OMEGA: [f64; 4] = [0.0, 20.0, 45.0, 30.0];
    const ARM: f64 = 0.5;

    /// Half a metre from the axis: settling, revolutions, coloured noise, spikes, a gap, a repeated stamp, a missing reading.
    fn record(seed: u64) -> Record {
        let mut random = Random::stream(seed, 0);
        let mut colour = Vector3::zeros();
        let mut record = Record::default();
        for i in (0..OMEGA.len() * STRETCH).filter(|i| !(700..720).contains(i)) {
            let t = i as f64 / RATE;
            let (plateau, since) = (i / STRETCH, (i % STRETCH) as f64 / RATE);
            let (omega, next) = (OMEGA[plateau], OMEGA[(plateau + 1) % OMEGA.len()]);
            let ramp = ((since - PLATEAU) / RAMP).max(0.0);
            let settling = if plateau == 0 { 0.0 } else { 2e-3 * (-since / 0.5).exp() };
            let omega = omega * (1.0 + settling) + ramp * (next - omega);
            colour = colour * 0.99 + Vector3::from_fn(|_, _| 1e-4 * random.normal());
            let turn = Vector3::new((omega * t).cos(), (omega * t).sin(), 0.0) * 3e-3;
            let noise = Vector3::from_fn(|_, _| 1e-3 * random.normal());
            let mut f = Vector3::new(omega * omega * ARM, 0.0, 9.81) + turn + colour + noise;
            if random.uniform() < 1e-3 {
                f.y += 20.0;
            }
            record.t.push(if i == 4000 { (i - 1) as f64 / RATE } else { t });
            for (axis, column) in record.f_z.iter_mut().enumerate() {
                column.push(if i == 5000 { f64::NAN } else { (f[axis] * 1e5).round() / 1e5 });
            }
        }
        record
    }

    #[test]
    fn a_reduction_is_the_same_on_any_processor() {
        let nominal = |omega: f64| Vector3::new(omega * omega * ARM, 0.0, 9.81);
        let schedule = OMEGA.map(|omega| ScheduledPlateau { omega, nominal_z: nominal(omega) });
        on_all(|| {
            let mountings = [1, 2].map(|seed| record(seed).reduce(None, &schedule).unwrap());
            let noise = NoiseModel::pool(&mountings);
            let means = mountings.each_ref().map(|mounting| (mounting.settling_time(), mounting.means(&noise)));
            assert!(means.iter().flat_map(|(_, means)| means).any(|mean| mean.left_out.spikes > 0));
            // Every number in the shortest form that distinguishes it from all others.
            format!("{noise:?} {means:?}")
        });
    }
}
