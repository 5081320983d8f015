//! Measured speeds of a session: the readings of all plateaus with their scatter pooled.

use super::average::ReducedMounting;
use super::locate::SpeedReading;

/// The speed of a plateau as measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasuredSpeed {
    /// Settled speed, without sign [rad/s].
    pub speed: f64,
    /// Its relative standard uncertainty from the scatter and the step of the reports.
    pub uncertainty: f64,
    /// Degrees of freedom of the scatter.
    pub degrees_of_freedom: usize,
    /// Part of the uncertainty that is the step of the reports: the same wherever the same speed is set.
    pub step_uncertainty: f64,
    /// Slope over the plateau beyond the settling, and its standard uncertainty, relative to the speed [1/s];
    /// `None` where the samples are too few.
    pub slope: Option<[f64; 2]>,
}

impl MeasuredSpeed {
    /// The speeds of the plateaus of some mountings, which were set to `set` [rad/s], any sign. Plateaus set alike have one variance of a sample: a
    /// plateau alone has a dozen degrees of freedom, too few for a weight in the fit.
    pub fn of_all(set: &[f64], mountings: &[ReducedMounting]) -> Vec<Option<MeasuredSpeed>> {
        let readings = || mountings.iter().flat_map(|mounting| &mounting.timing.readings);
        let pairs = || set.iter().zip(readings()).filter_map(|(set, reading)| Some((set.abs(), reading.as_ref()?)));
        let pooled = |speed: f64| {
            let alike = pairs().filter(|(set, _)| (set - speed).abs() <= 1e-9 * speed);
            let (freedom, squares) = alike.fold((0, 0.0), |(freedom, squares), (_, reading)| {
                let own = reading.degrees_of_freedom;
                (freedom + own, squares + own as f64 * reading.sample_variance)
            });
            (squares / freedom as f64, freedom)
        };
        let measured = |(set, reading): (&f64, &Option<SpeedReading>)| {
            let reading = reading.as_ref().filter(|reading| reading.speed > 0.0)?;
            let (variance, degrees_of_freedom) = pooled(set.abs());
            // A step is a rectangular error (GUM, F.2.2.1).
            let step_uncertainty = reading.resolution / 12.0_f64.sqrt() / reading.speed;
            let scatter = (variance * reading.gain).sqrt() / reading.speed;
            let uncertainty = scatter.hypot(step_uncertainty);
            let slope = reading.slope.map(|slope| slope.map(|slope| slope / reading.speed));
            Some(MeasuredSpeed { speed: reading.speed, uncertainty, degrees_of_freedom, step_uncertainty, slope })
        };
        set.iter().zip(readings()).map(measured).collect()
    }
}
