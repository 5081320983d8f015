//! A plan as the plan file of a session.

use std::path::Path;

use crate::document::{ChosenRest, ChosenRests, PlanReport, PlannedMounting, PlannedPlateau};
use crate::error::Error;
use crate::settings::toml_text;
use crate::settings::{editable, read_settings};
use crate::units::Dimension::{self, Angle, Speed, Time};

impl PlanReport {
    /// The plan as the plan file of a session: the text that it was planned from, with mountings in place of candidates.
    ///
    /// # Errors
    /// [`Error`] when the file cannot be read any more.
    pub fn session_text(&self, file: &Path) -> Result<String, Error> {
        let mut document = editable(file, &read_settings(file, "a plan")?)?;
        for key in ["candidates", "cost", "target", "robust"] {
            document.remove(key);
        }
        // The plan may be written to another folder than the one it was read from.
        let nominal = document.get_mut("plan").and_then(|plan| plan.get_mut("nominal"));
        if let Some(nominal) = nominal.filter(|item| item.is_str()) {
            let from = file.parent().unwrap_or(Path::new("")).join(nominal.as_str().unwrap_or_default());
            let whole = std::path::absolute(&from).unwrap_or(from);
            *nominal = toml_edit::value(whole.to_string_lossy().into_owned());
        }
        // A position that is not used has no mounting, and no parameters.
        if let Some(toml_edit::Item::ArrayOfTables(positions)) = document.get_mut("position") {
            positions.retain(|table| {
                let id = table.get("id").map(|id| id.as_str().map_or_else(|| id.to_string(), str::to_owned));
                id.is_some_and(|id| self.mountings.iter().any(|m| m.position == id.trim()))
            });
        }
        let mut text = document.to_string();
        text.truncate(text.trim_end().len());
        text.push('\n');
        self.mountings.iter().for_each(|mounting| text.push_str(&mounting.text()));
        self.rests.iter().for_each(|rests| text.push_str(&rests.text()));
        Ok(text)
    }
}

impl PlannedMounting {
    fn text(&self) -> String {
        let plateau = |p: &PlannedPlateau| {
            let angle =
                if p.speed == 0.0 { format!(", angle = {}", text(p.angle, Angle, "deg")) } else { String::new() };
            let (speed, duration) = (text(p.speed, Speed, "rpm"), text(p.duration, Time, "s"));
            format!("  {{ speed = {speed}{angle}, duration = {duration} }},\n")
        };
        let plateaus: String = self.plateaus.iter().map(plateau).collect();
        let (position, radius) = (toml_text(&self.position), self.radius);
        format!("\n[[mounting]]\nposition = {position}\narm = [{radius:?}, 0, 0]\nplateaus = [\n{plateaus}]\n")
    }
}

impl ChosenRests {
    fn text(&self) -> String {
        let list = |of: fn(&ChosenRest) -> String| {
            let lines: Vec<String> = self.rests.iter().map(of).collect();
            format!("[\n  {},\n]\n", lines.join(",\n  "))
        };
        let attitudes = list(|rest| format!("{:?}", rest.up));
        let durations = list(|rest| text(rest.duration, Time, "s"));
        let known = |u| format!("attitude_uncertainty = {}\n", text(u, Angle, "deg"));
        let known = self.attitude_uncertainty.map_or(String::new(), known);
        format!("\n[[tumble]]\n{known}attitudes = {attitudes}durations = {durations}")
    }
}

/// A quantity [SI] as TOML text, read as the same number: [`Dimension::written`].
fn text(value: f64, dimension: Dimension, unit: &str) -> String {
    dimension.written(value, unit).map_or_else(|| format!("{value:?}"), |text| format!("{text:?}"))
}
