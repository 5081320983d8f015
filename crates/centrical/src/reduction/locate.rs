//! Where the scheduled plateaus are in a surveyed record, and which part of each is averaged.

mod align;
mod block_fit;
mod clock;
mod evidence;
mod hypothesis;
mod path;
mod rotation;
mod shape;
mod window;

use super::error::ReductionError;
use super::plateau::ScheduledPlateau;
use super::survey::{Blocks, Survey};
use crate::statistics::whole;
pub use clock::{ClockOffset, SpeedTrace};
pub(super) use shape::Shape;
pub(super) use window::Window;

/// Most samples of a part of a window.
const PART: f64 = 1e6;

/// The plateaus of a mounting, found in its record.
#[derive(Debug, Clone)]
pub struct Located {
    pub(super) blocks: Blocks,
    /// In the order of the schedule.
    pub(super) windows: Vec<Window>,
    /// Time constant of the settling, common to the mounting [s].
    pub(super) settling_time: Option<f64>,
    /// Speed on each plateau by the telemetry [rad/s].
    pub(super) speeds: Vec<Option<f64>>,
    pub(super) clock_offset: Option<ClockOffset>,
}

/// Finds the scheduled plateaus of a surveyed record; telemetry adds the offset of its clock and the measured speeds.
///
/// # Errors
/// [`ReductionError`] if the record is too short, a scheduled plateau is not in it, or a recording mistake explains it better.
pub fn locate(
    survey: &Survey,
    telemetry: Option<&SpeedTrace>,
    schedule: &[ScheduledPlateau],
) -> Result<Located, ReductionError> {
    let blocks = survey.blocks()?;
    let cores = align::align(&blocks, schedule)?;
    let clock_offset = telemetry.and_then(|telemetry| clock::offset(&blocks, schedule, &cores, telemetry));
    let window::Windows { plateaus: windows, settling_time } = window::refine(&blocks, schedule, &cores)?;
    let speed = |window: &Window| clock::median_speed(telemetry?, clock_offset.as_ref()?, window.span);
    let speeds = windows.iter().map(speed).collect();
    Ok(Located { blocks, windows, settling_time, speeds, clock_offset })
}

impl Located {
    /// The window of each plateau, from and to, the record's clock [s], in the order of the schedule.
    pub fn windows(&self) -> Vec<[f64; 2]> {
        self.windows.iter().map(|window| window.span).collect()
    }

    /// The window of a plateau in parts, from and to [s], each short enough to be held in memory.
    pub fn parts(&self, plateau: usize) -> Vec<[f64; 2]> {
        let [from, to] = self.windows[plateau].span;
        let count = whole(((to - from) / (PART * self.blocks.interval)).ceil()).max(1);
        let end = |k: usize| if k == count { to } else { from + (to - from) * (k as f64 / count as f64) };
        (0..count).map(|k| [if k == 0 { from } else { end(k).next_up() }, end(k + 1)]).collect()
    }
}
