//! Plots of a watched session: uncertainties after each plateau, readings of the last minutes, measured speeds.

use centrical::Group;
use centrical_session::{GroupProgress, HistoryEntry, LiveReport, LiveSpeed};

use super::drawing::{Figure, of_plot};
use crate::evaluation::expanded_of_normal;
use crate::language::Language;
use crate::plot::{Axis, Plot, Point, Series};

/// Readings of the last minutes; `None` before the first sample.
pub fn live_readings_figure(live: &LiveReport, language: Language) -> Option<Figure> {
    let words = language.live();
    let record = live.record.as_ref().filter(|record| record.t.len() > 1)?;
    let mut plot = Plot::new(words.readings, Axis::linear(words.recorder_time), Axis::linear(words.reading));
    for (i, column) in (1..).zip(&record.f) {
        let points = record.t.iter().zip(column).map(|(t, f)| Point::new(*t, *f)).collect();
        plot = plot.with(Series::line(format!("{} {i}", words.newtonometer), points));
    }
    Some(of_plot("live-readings", words.readings_caption, plot, language))
}

/// Measured less set speeds, relative; `None` where no speed was measured.
pub fn live_speeds_figure(live: &LiveReport, language: Language) -> Option<Figure> {
    let words = language.live();
    let point = |speed: &LiveSpeed| {
        let (deviation, expanded) = (1e6 * speed.deviation()?, 1e6 * expanded_of_normal(speed.uncertainty));
        let x = speed.plateau.set_point as f64 + 1.0;
        Some(Point::new(x, deviation).with_interval(deviation - expanded, deviation + expanded))
    };
    let points: Vec<Point> = live.speeds.iter().filter_map(point).collect();
    if points.is_empty() {
        return None;
    }
    let plot = Plot::new(words.speeds, Axis::linear(words.plateau), Axis::linear(words.speed_deviation))
        .with(Series::markers(words.measured, points));
    Some(of_plot("live-speeds", words.speeds_caption, plot, language))
}

/// Uncertainties over their targets, plateau by plateau; without targets, over those after the last plateau.
pub fn live_uncertainties_figure(live: &LiveReport, history: &[HistoryEntry], language: Language) -> Option<Figure> {
    let targeted: Vec<(&GroupProgress, f64)> =
        live.groups.iter().filter_map(|group| Some((group, group.target?))).collect();
    // Before the first of them is determined there is nothing to draw over its target.
    if !targeted.iter().any(|(group, _)| group.determined == group.unknowns) {
        let of_group = |name: &str| live.groups.iter().find(|group| group.names.iter().any(|own| own == name));
        return history_figure(history, &|name| Some(of_group(name)?.group), language);
    }
    let (words, messages) = (language.live(), language.messages());
    let axes = (Axis::linear(messages.plateaus_used_axis), Axis::log(words.over_target));
    let mut plot = Plot::new(words.over_target, axes.0, axes.1);
    for (group, target) in targeted {
        let point = |entry: &HistoryEntry| {
            let of_group = entry.estimates.iter().filter(|estimate| group.names.contains(&estimate.name));
            let known = of_group.map(|estimate| estimate.standard_uncertainty).collect::<Option<Vec<f64>>>()?;
            let largest = known.into_iter().fold(0.0, f64::max);
            Some(Point::new(entry.plateau as f64, largest * group.scale / target))
        };
        plot = plot.with(Series::line((messages.words.group)(group.group), history.iter().filter_map(point).collect()));
    }
    let last = history.last().map_or(1.0, |entry| entry.plateau as f64);
    plot = plot.with(Series::line(words.target, vec![Point::new(1.0, 1.0), Point::new(last, 1.0)]));
    Some(of_plot("live-uncertainties", words.over_target_caption, plot, language))
}

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
