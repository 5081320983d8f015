//! Sentences about the speeds of plateaus, in each language.

use centrical_session::{
    DifferenceExtent, FollowedSpeeds, SpeedDifference, SpeedFinding, SpeedSource, SpeedsSummary, rpm,
};

use crate::number::converted;

/// Plateaus and mountings that a sentence names; of more it says how many.
const NAMED: usize = 5;

/// What the telemetry shows.
pub(super) fn in_english(finding: &SpeedFinding) -> String {
    match finding {
        SpeedFinding::Difference(found) => difference_in_english(found),
        SpeedFinding::Clock { shown_by, mountings, rate: Some(rate), .. } => format!(
            "the clock of the {} runs {} times as fast as that of the record in {}: a wrong sampling rate or unit of time",
            english_witness(*shown_by),
            three(1.0 / rate),
            mountings_in_english(mountings)
        ),
        SpeedFinding::Clock { shown_by, mountings, ramps, agreeing, rate: None } => {
            let (witness, of) = (english_witness(*shown_by), mountings_in_english(mountings));
            format!(
                "{witness} of {of} has {agreeing} of the {ramps} ramps of the record at their times: that of another \
                 mounting, or a wrong clock"
            )
        }
        SpeedFinding::Missing { shown_by, mounting, plateaus, span: [from, to] } => {
            let witness = english_witness(*shown_by);
            format!(
                "{witness} of mounting {mounting} covers {from:.1} s to {to:.1} s of the record: {plateaus} plateaus without a speed"
            )
        }
    }
}

/// As [`in_english`].
pub(super) fn in_russian(finding: &SpeedFinding) -> String {
    match finding {
        SpeedFinding::Difference(found) => difference_in_russian(found),
        SpeedFinding::Clock { shown_by, mountings, rate: Some(rate), .. } => format!(
            "часы {} идут в {} раз быстрее часов записи (установки {}): неверная частота отсчётов или единица времени",
            russian_witness(*shown_by)[1],
            comma(&three(1.0 / rate)),
            list(mountings.iter(), "и др.")
        ),
        SpeedFinding::Clock { shown_by, mountings, ramps, agreeing, rate: None } => {
            let witness = russian_witness(*shown_by)[1];
            let of = list(mountings.iter(), "и др.");
            format!(
                "по данным {witness} совпадают по времени с записью разгоны: {agreeing} из {ramps} (установки {of}): данные другой \
                 установки или неверные часы"
            )
        }
        SpeedFinding::Missing { shown_by, mounting, plateaus, span: [from, to] } => {
            let witness = russian_witness(*shown_by)[0];
            let [from, to] = [from, to].map(|t| comma(&format!("{t:.1}")));
            format!(
                "{witness} установки {mounting} охватывает запись от {from} с до {to} с; площадок без скорости: {plateaus}"
            )
        }
    }
}

/// How the speeds are known.
pub(super) fn measured_in_english(speeds: &SpeedsSummary) -> String {
    let by = match speeds.measured_by {
        Some(SpeedSource::Pulses) => "by a counter of revolutions",
        Some(SpeedSource::Plateaus) => "as the plateaus state",
        Some(SpeedSource::Telemetry) | None => "by the telemetry",
    };
    let SpeedsSummary { measured, spinning, scale_uncertainty, .. } = speeds;
    format!("measured {by} on {measured} of {spinning} plateaus that spin; common scale {}", ppm(*scale_uncertainty))
}

/// As [`measured_in_english`].
pub(super) fn measured_in_russian(speeds: &SpeedsSummary) -> String {
    let by = match speeds.measured_by {
        Some(SpeedSource::Pulses) => "счётчиком оборотов",
        Some(SpeedSource::Plateaus) => "как указано для площадок",
        Some(SpeedSource::Telemetry) | None => "по телеметрии",
    };
    let SpeedsSummary { measured, spinning, scale_uncertainty, .. } = speeds;
    let scale = comma(&ppm(*scale_uncertainty)).replace("ppm", "млн⁻¹");
    format!("измерены {by} на площадках с вращением: {measured} из {spinning}; общий масштаб {scale}")
}

fn english_witness(shown_by: SpeedSource) -> &'static str {
    if shown_by == SpeedSource::Pulses { "counter of revolutions" } else { "telemetry" }
}

/// Nominative and genitive.
fn russian_witness(shown_by: SpeedSource) -> [&'static str; 2] {
    if shown_by == SpeedSource::Pulses {
        ["счётчик оборотов", "счётчика оборотов"]
    } else {
        ["телеметрия", "телеметрии"]
    }
}

fn difference_in_english(found: &SpeedDifference) -> String {
    let count = found.plateaus.len();
    let place = match found.extent {
        DifferenceExtent::All if count == found.of => format!("in all {count} plateaus"),
        DifferenceExtent::All => format!("in {count} of {} plateaus", found.of),
        DifferenceExtent::Mountings => format!("in all {count} plateaus of {}", mountings_in_english(&found.mountings)),
        DifferenceExtent::Speeds if found.speeds.len() == 1 => format!("in all {count} plateaus of this speed"),
        DifferenceExtent::Speeds => format!("in all {count} plateaus of {} speeds", found.speeds.len()),
        DifferenceExtent::Plateaus => {
            format!("in {count} of {} plateaus ({})", found.of, list(found.plateaus.iter(), "and others"))
        }
    };
    let cause = match &found.units {
        Some([own, read]) => format!("speeds in {own} are read in {read}"),
        None if matches!(found.extent, DifferenceExtent::Plateaus | DifferenceExtent::Speeds) => {
            "a wrong set-point, or the tachometer".to_owned()
        }
        None => "a wrong unit, a wrong set-point, or a tachometer's scale".to_owned(),
    };
    let record = match found.record_follows {
        Some(FollowedSpeeds::Telemetry) => "; the record follows the telemetry",
        Some(FollowedSpeeds::Schedule) => "; the record follows the schedule",
        None => "",
    };
    format!(
        "{} says {:.2} rpm, the schedule {:.2} ({}{}, {} times the stated uncertainty) {place}: {cause}{record}",
        english_witness(found.shown_by),
        rpm(found.shown),
        rpm(found.set),
        if is_mean(found) { "mean " } else { "" },
        percent(found.difference),
        times(found),
    )
}

fn difference_in_russian(found: &SpeedDifference) -> String {
    let count = found.plateaus.len();
    let place = match found.extent {
        DifferenceExtent::All => format!("на площадках: {count} из {}", found.of),
        DifferenceExtent::Mountings => format!("на всех площадках установок {}", list(found.mountings.iter(), "и др.")),
        DifferenceExtent::Speeds => format!("на всех площадках с такими скоростями: {count}"),
        DifferenceExtent::Plateaus => {
            format!("на площадках {} ({count} из {})", list(found.plateaus.iter(), "и др."), found.of)
        }
    };
    let cause = match &found.units {
        Some([own, read]) => format!("скорости в {} прочитаны в {}", russian_unit(own), russian_unit(read)),
        None if matches!(found.extent, DifferenceExtent::Plateaus | DifferenceExtent::Speeds) => {
            "неверная уставка или тахометр".to_owned()
        }
        None => "неверная единица, неверная уставка или масштаб тахометра".to_owned(),
    };
    let record = match found.record_follows {
        Some(FollowedSpeeds::Telemetry) => "; запись согласуется с телеметрией",
        Some(FollowedSpeeds::Schedule) => "; запись согласуется с программой",
        None => "",
    };
    let witness = russian_witness(found.shown_by)[0];
    let numbers = format!("{witness} показывает {:.2} об/мин, программа {:.2}", rpm(found.shown), rpm(found.set));
    let mean = if is_mean(found) { "в среднем " } else { "" };
    let off = format!("{mean}{}, в {} раз больше заявленной неопределённости", percent(found.difference), times(found));
    format!("{} ({}) {place}: {cause}{record}", comma(&numbers), comma(&off))
}

/// Whether the difference is the mean one of several plateaus.
fn is_mean(found: &SpeedDifference) -> bool {
    found.plateaus.len() > 1 && !matches!(found.extent, DifferenceExtent::Plateaus)
}

/// `mounting 4`, or `mountings 1, 2`.
fn mountings_in_english(mountings: &[usize]) -> String {
    let plural = if mountings.len() == 1 { "" } else { "s" };
    format!("mounting{plural} {}", list(mountings.iter(), "and others"))
}

fn russian_unit(unit: &str) -> &str {
    match unit {
        "rad/s" => "рад/с",
        "rpm" => "об/мин",
        "deg/s" => "град/с",
        "rev/s" => "об/с",
        other => other,
    }
}

fn times(found: &SpeedDifference) -> String {
    three((found.difference / found.standard_uncertainty).abs())
}

/// Some names, and a word for those beyond them.
fn list(names: impl ExactSizeIterator<Item = impl ToString>, others: &str) -> String {
    let more = if names.len() > NAMED { format!(" {others}") } else { String::new() };
    let named: Vec<String> = names.take(NAMED).map(|name| name.to_string()).collect();
    format!("{}{more}", named.join(", "))
}

/// A relative difference in percent, to two significant digits at least.
fn percent(difference: f64) -> String {
    let percent = 100.0 * difference;
    let places = if percent.abs() >= 0.095 { 2 } else { 4 };
    format!("{percent:+.places$} %")
}

/// A relative uncertainty.
fn ppm(uncertainty: f64) -> String {
    format!("{} ppm", converted(1e6 * uncertainty))
}

/// A positive number to two or three significant digits.
fn three(number: f64) -> String {
    let hundredths = format!("{number:.2}");
    match hundredths.as_str() {
        _ if number >= 10.0 => format!("{number:.0}"),
        // What is wrong has to show.
        "1.00" => format!("{number:.5}"),
        _ => hundredths,
    }
}

fn comma(text: &str) -> String {
    text.replace('.', ",")
}
