//! The history of a session that was watched: what was known after each plateau as it came.

use centrical::Group;
use centrical_session::HistoryEntry;

use super::drawing::{Figure, of_plot};
use crate::language::Language;
use crate::plot::{Axis, Plot, Point, Series};

/// Largest standard uncertainty of each group, over that after the last plateau, from the plateau on at which all
/// that the group will determine is determined. `group_of` gives the group of a parameter by name; none if nothing has
/// been determined yet.
pub fn history_figure(
    history: &[HistoryEntry],
    group_of: &dyn Fn(&str) -> Option<Group>,
    language: Language,
) -> Option<Figure> {
    let messages = language.messages();
    let last = history.last()?;
    let axes = (Axis::linear(messages.plateaus_used_axis), Axis::log(messages.convergence_axis));
    let mut plot = Plot::new(messages.history_title, axes.0, axes.1);
    let mut groups: Vec<(Group, Vec<(usize, f64)>)> = Vec::new();
    for (j, estimate) in last.estimates.iter().enumerate() {
        if let Some((group, final_u)) = group_of(&estimate.name).zip(estimate.standard_uncertainty) {
            match groups.iter_mut().find(|(name, _)| *name == group) {
                Some((_, members)) => members.push((j, final_u)),
                None => groups.push((group, vec![(j, final_u)])),
            }
        }
    }
    if groups.is_empty() {
        return None;
    }
    for (group, members) in &groups {
        let point = |entry: &HistoryEntry| {
            let ratio = |(j, final_u): &(usize, f64)| Some(entry.estimates.get(*j)?.standard_uncertainty? / final_u);
            let ratios: Vec<f64> = members.iter().map(ratio).collect::<Option<_>>()?;
            Some(Point::new(entry.plateau as f64, ratios.into_iter().fold(0.0, f64::max)))
        };
        plot = plot.with(Series::line((messages.words.group)(*group), history.iter().filter_map(point).collect()));
    }
    Some(of_plot("watch-history", messages.history_caption, plot, language))
}
