//! All mountings of a session together: the noise of their records, the covariances of their means, the measured speeds.

use std::borrow::Cow;

use centrical::reduction::{MeasuredSpeed, NoiseModel, PlateauMean, ReducedMounting};

use super::mounting::OfRecord;
use super::own_readings::refuse_copies;
use crate::error::{Error, Place};
use crate::experiment::Session;
use crate::record::RecordOverview;
use crate::reduced::{MountingFindings, Reduced, ReducedPlateau};
use crate::units::rpm;

/// A measured speed farther than this from the one that was set, relative, is in another unit. The record bears out the
/// schedule better than that, or its plateaus would not be found.
const OTHER_UNIT: f64 = 0.1;

/// From the mountings to the noise of all of them together, then to the covariances.
pub(super) fn pooled(session: &Session, mountings: Vec<OfRecord>) -> Result<Reduced, Error> {
    let interpolated: Vec<Option<[u64; 3]>> = mountings.iter().map(|mounting| mounting.interpolated).collect();
    let (reduced, records): (Vec<ReducedMounting>, Vec<RecordOverview>) =
        mountings.into_iter().map(|mounting| (mounting.reduced, mounting.overview)).unzip();
    let noise = NoiseModel::pool(&reduced);
    let means: Vec<Vec<PlateauMean>> = reduced.iter().map(|mounting| mounting.means(&noise)).collect();
    refuse_copies(session, means.len(), &|| Cow::Borrowed(&means))?;
    let findings = |(m, interpolated): (&ReducedMounting, &Option<[u64; 3]>)| MountingFindings {
        settling_time: m.settling_time(),
        clock_offset: m.clock_offset(),
        agreement: m.clock_agreement(),
        interpolated: *interpolated,
        unscheduled: m.unscheduled().to_vec(),
    };
    let experiment = &session.experiment;
    let on_arm = experiment.set_points.iter().filter(|set_point| experiment.is_on_arm(set_point.mounting));
    let set: Vec<f64> = on_arm.map(|set_point| set_point.omega).collect();
    let speeds = MeasuredSpeed::of_all(&set, &reduced);
    refuse_other_units(session, &speeds)?;
    Ok(Reduced {
        speeds,
        plateaus: means.into_iter().flatten().map(ReducedPlateau::from).collect(),
        mountings: reduced.iter().zip(&interpolated).map(findings).collect(),
        records,
        held_out: Vec::new(),
        inputs: Vec::new(),
    })
}

/// Refuses measured speeds that cannot be those of the plateaus: a wrong unit, or a wrong number of pulses.
fn refuse_other_units(session: &Session, speeds: &[Option<MeasuredSpeed>]) -> Result<(), Error> {
    if !session.speeds.is_in_files() {
        return Ok(());
    }
    let pairs =
        session.experiment.set_points.iter().zip(speeds).filter_map(|(set, speed)| Some((set, speed.as_ref()?)));
    let Some((set, speed)) =
        pairs.into_iter().find(|(set, speed)| (speed.speed / set.omega.abs() - 1.0).abs() > OTHER_UNIT)
    else {
        return Ok(());
    };
    let of_mounting = session.mountings.get(set.mounting);
    let file = of_mounting.and_then(|m| m.pulses.as_deref().or(m.telemetry.as_deref())).unwrap_or(&session.file);
    let found = format!("{:.2} rpm", rpm(speed.speed));
    let expected = format!(
        "about {:.2} rpm, the speed that is set (speed_unit in [columns], pulses_per_revolution in [centrifuge])",
        rpm(set.omega.abs())
    );
    Err(Error::content(file, Place::Whole, found, expected))
}
