//! The pages of a server of finished results: their list, and two compared.

use std::fmt::Write;

use centrical_session::{CalibrationResult, ComparisonReport};

use super::frame::{Column, shown, titles};
use super::live::{languages, served};
use crate::figure::comparison_plot;
use crate::language::Language;
use crate::plot::Escaped;
use crate::terminal::comparison_text;

/// A result in the list: where it lies, and what it says or why it cannot be read.
#[derive(Debug)]
pub struct ListedResult {
    /// What the address of its page names it by: the same whatever else is in the list.
    pub id: String,
    /// Its file.
    pub file: String,
    /// The result, or the message of the error.
    pub result: Result<Box<CalibrationResult>, String>,
}

/// The list of results. The page of a result is `/report/ID`, of two compared `/compare?first=ID&second=ID`.
pub fn results_page(title: &str, results: &[ListedResult], has_live: bool, language: Language) -> String {
    let (words, messages) = (language.live(), language.messages());
    let mut body = format!(
        "<header><p class=\"kind\">{}</p><h1>{}</h1><nav class=\"languages\">{}</nav></header>\n",
        messages.results,
        Escaped(title),
        languages(language)
    );
    let code = language.code();
    if has_live {
        let _ = writeln!(body, "<p><a href=\"/live?lang={code}\">{}</a></p>", words.live);
    }
    let columns = [words.compare, messages.date, messages.model, words.serial, words.verdict, messages.file];
    let _ = write!(
        body,
        "<form action=\"/compare\"><input type=\"hidden\" name=\"lang\" value=\"{code}\"><div class=\"scroll\"><table id=\"list\">\
         <thead><tr>{}</tr></thead><tbody>",
        titles(&columns.map(Column::Words))
    );
    for listed in results {
        let _ = row(&mut body, listed, language);
    }
    let _ = writeln!(body, "</tbody></table></div><p><button>{}</button></p></form>", words.compare);
    served(title, &body, false, language)
}

fn row(body: &mut String, listed: &ListedResult, language: Language) -> std::fmt::Result {
    let (words, file) = (language.live(), Escaped(&listed.file));
    let result = match &listed.result {
        Ok(result) => result,
        Err(message) => {
            let (unreadable, message) = (words.unreadable, Escaped(message));
            return writeln!(
                body,
                "<tr><td></td><td></td><td></td><td></td><td class=\"bad\">{unreadable}<span lang=\"en\">{message}</span></td>\
                 <td>{file}</td></tr>"
            );
        }
    };
    let session = &result.session;
    let is_acceptable = result.objections().is_empty();
    let (class, verdict) = if is_acceptable { ("good", words.acceptable) } else { ("bad", words.not_acceptable) };
    let date = language.written_date(&session.date);
    let (label, id) = (format!("{} {date}", session.unit_serial), Escaped(&listed.id));
    writeln!(
        body,
        "<tr><td><label><input type=\"radio\" name=\"first\" value=\"{id}\" aria-label=\"1: {0}\"> 1</label> \
         <label><input type=\"radio\" name=\"second\" value=\"{id}\" aria-label=\"2: {0}\"> 2</label></td><td>{1}</td><td>{2}</td>\
         <td>{3}</td><td><span class=\"{class}\">{verdict}</span> <a href=\"/report/{id}?lang={4}\">{5}</a></td><td>{file}</td></tr>",
        Escaped(&label),
        Escaped(&date),
        Escaped(&session.unit_model),
        Escaped(&session.unit_serial),
        language.code(),
        words.report
    )
}

/// Two results compared.
pub fn compared_page(report: &ComparisonReport, language: Language) -> String {
    let words = language.live();
    let (class, verdict) = match (report.agree, report.is_of_one_unit()) {
        (true, _) => ("good", words.agree),
        (false, true) => ("bad", words.disagree),
        (false, false) => ("bad", words.other_units),
    };
    let mut body = compared_header(class, verdict, language);
    let _ =
        writeln!(body, "<figure>{}</figure>\n<div lang=\"{}\">", comparison_plot(report, language), language.code());
    shown(&mut body, &comparison_text(report, language));
    body.push_str("</div>\n");
    served(verdict, &body, false, language)
}

/// The page in place of a comparison for which fewer than two results are chosen.
pub fn unchosen_page(language: Language) -> String {
    let words = language.live();
    served(words.choose_two, &compared_header("bad", words.choose_two, language), false, language)
}

/// What an address without a page is answered with.
pub fn not_found(language: Language) -> &'static str {
    language.live().not_found
}

/// The head of a comparison, with the way back to the list.
fn compared_header(class: &str, verdict: &str, language: Language) -> String {
    let words = language.live();
    format!(
        "<header><p class=\"kind\">{}</p><h1 class=\"{class}\">{verdict}</h1><p><a href=\"/?lang={}\">{}</a></p></header>\n",
        words.differences,
        language.code(),
        language.messages().results
    )
}
