//! The live page of a watch. The server sends its panel again and again; numbers that a script may want stand in `data-value`.

use std::fmt::Write;

use centrical_session::{Agreement, HistoryEntry, LivePlateau, LiveReport, LiveStatus, PlateauLabel, rpm};

use super::frame::Column::{Number, Words};
use super::frame::{head, titles};
use crate::document::rival;
use crate::evaluation::expanded_of_normal;
use crate::figure::{Figure, live_readings_figure, live_speeds_figure, live_uncertainties_figure};
use crate::language::{Language, LiveMessages, Messages};
use crate::number::two_digits;
use crate::plot::Escaped;

/// Style of the pages that are served.
pub const LIVE_STYLE: &str =
    concat!(include_str!("html/style.css"), include_str!("html/list.css"), include_str!("html/live.css"));

/// Script of the live page: it takes the panel from the events of the server.
pub const LIVE_SCRIPT: &str = include_str!("html/live.js");

/// Plateaus whose speeds stand in the table.
const LAST_SPEEDS: usize = 8;

/// What loads the script; without scripts the page is loaded again, seldom enough for a reader who has to find the place again.
const SCRIPT: &str = "<script src=\"/live.js\" defer></script>\
                      <noscript><meta http-equiv=\"refresh\" content=\"10\"></noscript>";

/// The page around the panel of `live`, as it is at the time `now` [s since 1970].
pub fn live_page(live: &LiveReport, history: &[HistoryEntry], now: f64, language: Language) -> String {
    let words = language.live();
    let unit = [live.unit_model.as_str(), live.unit_serial.as_str()].join(" ");
    let body = format!(
        "<header><p class=\"kind\">{}</p><h1>{}</h1><p>{}</p><nav class=\"languages\">{}</nav></header>\n\
         <noscript><p id=\"state\">{}</p></noscript>\n\
         <p id=\"connection\" class=\"alarm\" role=\"alert\" hidden>{}</p>\n<div id=\"live\">\n{}</div>\n",
        words.live,
        Escaped(&live.title),
        Escaped(unit.trim()),
        languages(language),
        (words.as_of)(&format!("{}:{:02} UTC", clock(live.written), live.written.rem_euclid(60.0).floor())),
        words.no_connection,
        live_panel(live, history, now, language)
    );
    served(&live.title, &body, true, language)
}

/// A page of a server: its style and script are files of their own.
pub(super) fn served(title: &str, body: &str, is_live: bool, language: Language) -> String {
    let script = if is_live { SCRIPT } else { "" };
    let style = format!("<link rel=\"stylesheet\" href=\"/live.css\">{script}");
    let head = head(language.code(), title, &style);
    format!("{head}<body><main class=\"wall\">\n{body}</main></body></html>\n")
}

/// Links to the other languages.
pub(super) fn languages(language: Language) -> &'static str {
    match language {
        Language::English => "<a href=\"?lang=ru\" lang=\"ru\" hreflang=\"ru\">по-русски</a>",
        Language::Russian => "<a href=\"?lang=en\" lang=\"en\" hreflang=\"en\">in English</a>",
    }
}

/// The panel: everything that changes.
pub fn live_panel(live: &LiveReport, history: &[HistoryEntry], now: f64, language: Language) -> String {
    let panel = Panel { live, language, words: language.live(), messages: language.messages() };
    let mut out = String::new();
    out.push_str("<div class=\"banners\">\n");
    // Writing to a String cannot fail.
    let _ = panel.status(&mut out, now);
    out.push_str("</div>\n<div class=\"cards\">\n");
    let _ = panel.schedule(&mut out);
    let _ = panel.last(&mut out);
    let _ = panel.record(&mut out, now);
    let _ = panel.uncertainties(&mut out);
    let _ = panel.rank(&mut out);
    let _ = panel.rivals(&mut out);
    let _ = panel.speeds(&mut out);
    out.push_str("</div>\n<div class=\"figures\">\n");
    let figures = [
        live_uncertainties_figure(live, history, language),
        live_readings_figure(live, language),
        live_speeds_figure(live, language),
    ];
    for Figure { name, caption, drawings, .. } in figures.into_iter().flatten() {
        let _ = writeln!(
            out,
            "<figure id=\"{name}\">{}<figcaption>{}</figcaption></figure>",
            drawings.concat(),
            Escaped(&caption)
        );
    }
    out.push_str("</div>\n");
    out
}

struct Panel<'a> {
    live: &'a LiveReport,
    language: Language,
    words: &'static LiveMessages,
    messages: &'static Messages,
}

impl Panel<'_> {
    fn status(&self, out: &mut String, now: f64) -> std::fmt::Result {
        let (live, words) = (self.live, self.words);
        let is_silent = live.is_silent(now);
        // The first word is the same in every language.
        let (status, class, text) = match live.status {
            _ if is_silent => ("silent", "bad", words.silent),
            LiveStatus::Following => ("following", "good", words.following),
            LiveStatus::Stopped => ("stopped", "amber", words.stopped),
            LiveStatus::Complete if live.acceptable == Some(false) => ("complete", "bad", words.complete),
            LiveStatus::Complete => ("complete", "good", words.complete),
            LiveStatus::Failed => ("failed", "bad", words.failed),
        };
        write!(
            out,
            "<section id=\"status\" class=\"banner {class}\" role=\"status\"><p data-value=\"{status}\">{text}"
        )?;
        if let Some(acceptable) = live.acceptable {
            write!(out, ": {}", if acceptable { words.acceptable } else { words.not_acceptable })?;
        }
        out.push_str("</p>");
        if let Some(file) = &live.awaited {
            write!(out, "<p lang=\"{}\">{} {}</p>", self.language.code(), words.waiting_for, Escaped(file))?;
        } else if let Some(note) = &live.note {
            // The message of an error.
            write!(out, "<p lang=\"en\">{}</p>", Escaped(note))?;
        }
        out.push_str("</section>\n");
        let is_frozen =
            live.status == LiveStatus::Following && live.record.as_ref().is_some_and(|record| record.frozen);
        if is_frozen {
            writeln!(
                out,
                "<section id=\"frozen\" class=\"banner bad\" role=\"alert\"><p>{}</p></section>",
                words.frozen
            )?;
        }
        if !live.alarms.is_empty() {
            write!(
                out,
                "<section id=\"alarms\" class=\"banner bad\" role=\"alert\" data-value=\"{}\"><p>{}: ",
                live.alarms.len(),
                words.alarms
            )?;
            let labels: Vec<String> = live.alarms.iter().map(|plateau| self.alarm(plateau)).collect();
            writeln!(out, "{}</p></section>", labels.join("; "))?;
        }
        Ok(())
    }

    fn alarm(&self, plateau: &LivePlateau) -> String {
        let held_out = if plateau.held_out { format!(" ({})", self.words.held_out) } else { String::new() };
        format!("{}{held_out}", self.label(&plateau.plateau))
    }

    fn schedule(&self, out: &mut String) -> std::fmt::Result {
        let (live, words) = (self.live, self.words);
        open(out, "schedule", words.schedule)?;
        let (arrived, all) = (live.arrived, live.plateaus);
        write!(
            out,
            "<p class=\"big\"><span id=\"arrived\" data-value=\"{arrived}\">{arrived}</span> {} {all}</p>\
             <progress max=\"{all}\" value=\"{arrived}\" aria-label=\"{}\"></progress><dl>",
            self.messages.of, words.plateaus
        )?;
        fact(out, self.messages.mounting_word, &format!("{} {} {}", live.mounting, self.messages.of, live.mountings))?;
        let ends = match live.ends {
            _ if live.next.is_none() && arrived > 0 => None,
            Some(ends) => Some(format!("<time data-seconds=\"{ends:.0}\">{} UTC</time>", clock(ends))),
            None => Some(words.ends_unknown.to_owned()),
        };
        if let Some(ends) = ends {
            fact(out, words.ends, &ends)?;
        }
        if let Some(next) = &live.next {
            fact(out, words.next, &self.label(next))?;
        }
        for best in &live.best {
            let factor = self.language.fixed(best.factor, 3);
            fact(out, words.best, &format!("{}: {} × {factor}", self.label(&best.plateau), words.factor))?;
        }
        out.push_str("</dl></section>\n");
        Ok(())
    }

    fn last(&self, out: &mut String) -> std::fmt::Result {
        let words = self.words;
        open(out, "last", words.last)?;
        let Some(last) = &self.live.last else {
            return writeln!(out, "<p>{}</p></section>", words.none_yet);
        };
        let test = last.innovation;
        let (class, verdict) = match last.agreement() {
            Agreement::DoesNotFit => ("bad", words.does_not_fit),
            Agreement::Untested => ("plain", words.untested),
            Agreement::Improbable => ("amber", words.improbable),
            Agreement::Fits => ("good", words.fits),
        };
        write!(
            out,
            "<p>{}</p><p class=\"big {class}\" id=\"test\" data-value=\"{}\">{verdict}</p><dl>",
            self.label(&last.plateau),
            test.squared
        )?;
        if test.degrees_of_freedom > 0 {
            let squared = self.language.fixed(test.squared, 2);
            fact(out, words.test, &format!("{squared} (ν = {})", test.degrees_of_freedom))?;
            fact(out, words.probability, &self.language.probability(test.probability))?;
        }
        out.push_str("</dl></section>\n");
        Ok(())
    }

    fn record(&self, out: &mut String, now: f64) -> std::fmt::Result {
        let (live, words) = (self.live, self.words);
        open(out, "record", words.record)?;
        let Some(record) = &live.record else {
            return writeln!(out, "<p>{}</p></section>", words.no_record);
        };
        let name = record.file.rsplit(['/', '\\']).next().unwrap_or(&record.file);
        if let Some(age) = live.age(now).filter(|_| live.status == LiveStatus::Following) {
            let class = if record.frozen { "bad" } else { "plain" };
            write!(
                out,
                "<p>{}</p><p class=\"big {class}\"><span id=\"age\" data-age=\"{age:.1}\">{age:.0}</span> {}</p>",
                words.age, words.second
            )?;
        }
        out.push_str("<dl>");
        fact(out, self.messages.file, &Escaped(name).to_string())?;
        fact(out, words.samples, &format!("<span id=\"samples\" data-value=\"{0}\">{0}</span>", record.samples))?;
        match record.clock_offset {
            Some((offset, uncertainty)) => {
                let expanded = |u| format!(" ± {}", self.language.number(&two_digits(expanded_of_normal(u))));
                let (offset, u) = (self.language.fixed(offset, 3), uncertainty.map(expanded).unwrap_or_default());
                fact(out, words.clock_offset, &format!("{offset}{u} {}", words.second))?;
            }
            None => fact(out, words.clock_offset, words.no_clock)?,
        }
        out.push_str("</dl></section>\n");
        Ok(())
    }

    fn uncertainties(&self, out: &mut String) -> std::fmt::Result {
        let words = self.words;
        open(out, "uncertainties", words.uncertainties)?;
        let columns = [
            Words(words.group),
            Words(self.messages.unit),
            Number(words.determined),
            Number(words.largest),
            Number(words.target),
            Number(words.with_next),
        ];
        write!(out, "<div class=\"scroll\"><table><thead><tr>{}</tr></thead><tbody>", titles(&columns))?;
        let shown = |u: Option<f64>| u.map_or("—".to_owned(), |u| self.language.number(&two_digits(u)));
        let raw = |u: Option<f64>| u.map_or(String::new(), |u| u.to_string());
        for row in &self.live.groups {
            let target = row.target.map_or(String::new(), |target| {
                let (class, word) =
                    if row.is_met == Some(true) { ("good", words.met) } else { ("amber", words.not_met) };
                format!("{} <span class=\"{class}\">{word}</span>", self.language.number(&target.to_string()))
            });
            write!(
                out,
                "<tr data-group=\"{}\"><th scope=\"row\">{}</th><td>{}</td><td class=\"number\">{} {} {}</td>\
                 <td class=\"number\" data-value=\"{}\">{}</td><td class=\"number\">{target}</td><td class=\"number\">{}</td></tr>",
                Escaped(row.group.name()),
                (self.messages.words.group)(row.group),
                Escaped(&self.language.unit(&row.unit)),
                row.determined,
                self.messages.of,
                row.unknowns,
                raw(row.largest),
                shown(row.largest),
                shown(row.next)
            )?;
        }
        out.push_str("</tbody></table></div></section>\n");
        Ok(())
    }

    fn rank(&self, out: &mut String) -> std::fmt::Result {
        let (live, words) = (self.live, self.words);
        open(out, "rank", self.messages.rank)?;
        let (rank, all) = (live.rank, live.unknowns);
        write!(
            out,
            "<p class=\"big\"><span id=\"rank-now\" data-value=\"{rank}\">{rank}</span> {} {all}</p>",
            self.messages.of
        )?;
        if all > 0 && rank == all {
            write!(out, "<p class=\"good\">{}</p>", words.all_determined)?;
        } else if all > 0 {
            write!(out, "<p>{}:</p><ul class=\"lost\">", words.lost)?;
            for lost in &live.lost {
                write!(
                    out,
                    "<li><details><summary>{}</summary><p>{}</p></details></li>",
                    Escaped(&lost.direction),
                    Escaped(&(words.reason)(lost))
                )?;
            }
            out.push_str("</ul>");
            let further = (all - rank).saturating_sub(live.lost.len());
            if further > 0 {
                write!(out, "<p>+ {further} {}</p>", words.further)?;
            }
        }
        out.push_str("</section>\n");
        Ok(())
    }

    fn rivals(&self, out: &mut String) -> std::fmt::Result {
        let (live, words) = (self.live, self.words);
        open(out, "rivals", words.rivals)?;
        if live.rank < live.unknowns || live.unknowns == 0 {
            write!(out, "<p>{}</p>", words.rivals_later)?;
        } else if live.rivals.is_empty() {
            write!(out, "<p class=\"good\">{}</p>", words.no_rivals)?;
        } else {
            out.push_str("<ul>");
            for shown in live.rivals.iter().filter(|shown| shown.explains_most) {
                let chance = self.language.probability(shown.probability);
                let text = rival(shown, self.language);
                write!(out, "<li class=\"amber\">{}; {}: {chance}</li>", Escaped(&text), words.probability)?;
            }
            out.push_str("</ul>");
        }
        out.push_str("</section>\n");
        Ok(())
    }

    fn speeds(&self, out: &mut String) -> std::fmt::Result {
        let (live, words) = (self.live, self.words);
        open(out, "speeds", words.speeds)?;
        let measured: Vec<_> = live.speeds.iter().filter_map(|speed| Some((speed, speed.deviation()?))).collect();
        if measured.is_empty() {
            return writeln!(out, "<p>{}</p></section>", words.no_speeds);
        }
        let columns = [Words(words.plateau), Number(words.set_speed), Number(words.measured), Number(words.deviation)];
        let titles = titles(&columns);
        write!(out, "<div class=\"scroll\"><table><thead><tr>{titles}</tr></thead><tbody>")?;
        for (speed, deviation) in measured.iter().rev().take(LAST_SPEEDS) {
            let (set, found) = (speed.plateau.omega.abs(), speed.measured.abs());
            write!(
                out,
                "<tr><th scope=\"row\">{}:{}</th><td class=\"number\">{}</td><td class=\"number\" data-value=\"{found}\">{}</td>\
                 <td class=\"number\">{} ± {}</td></tr>",
                speed.plateau.mounting,
                speed.plateau.plateau,
                self.language.fixed(rpm(set), 3),
                self.language.fixed(rpm(found), 3),
                self.language.fixed(1e6 * deviation, 1),
                self.language.number(&two_digits(1e6 * expanded_of_normal(speed.uncertainty)))
            )?;
        }
        out.push_str("</tbody></table></div></section>\n");
        Ok(())
    }

    /// `4:3, 189.2 rpm`, without markup.
    fn label(&self, plateau: &PlateauLabel) -> String {
        let PlateauLabel { mounting, plateau, omega, angle, rest, .. } = *plateau;
        let words = self.words;
        if let Some(rest) = rest {
            format!("{} r{rest}", words.rest)
        } else if omega == 0.0 {
            format!("{mounting}:{plateau}, {} {}°", words.rest_at, self.language.fixed(angle.to_degrees(), 0))
        } else {
            format!("{mounting}:{plateau}, {} {}", self.language.fixed(rpm(omega), 1), words.rpm)
        }
    }
}

/// The beginning of a card.
fn open(out: &mut String, id: &str, title: &str) -> std::fmt::Result {
    write!(out, "<section id=\"{id}\" class=\"card\" aria-labelledby=\"{id}-title\"><h2 id=\"{id}-title\">{title}</h2>")
}

/// A fact; `value` is markup.
fn fact(out: &mut String, name: &str, value: &str) -> std::fmt::Result {
    write!(out, "<div><dt>{name}</dt><dd>{value}</dd></div>")
}

/// Hours and minutes of a time in UTC; the script writes those of the reader's clock.
fn clock(seconds: f64) -> String {
    let minutes = (seconds / 60.0).floor();
    format!("{:02}:{:02}", (minutes / 60.0).rem_euclid(24.0).floor(), minutes.rem_euclid(60.0))
}
