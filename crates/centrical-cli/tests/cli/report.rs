//! `centrical report` and the documents of `calibrate --out`.

use std::fs;

use crate::session::{Copy, example};

/// A calibrated copy: `calibrate --out .` with the laboratory's data.
fn calibrated(language: &str) -> Copy {
    let copy = Copy::new();
    let laboratory = example().join("laboratory.toml");
    let run = copy.calibrate(&["--out", ".", "--laboratory", laboratory.to_str().unwrap(), "--language", language]);
    assert_eq!(run.status.code(), Some(0), "{}", String::from_utf8_lossy(&run.stderr));
    copy
}

#[test]
fn calibrate_writes_everything_and_report_writes_the_same() {
    let copy = calibrated("en");
    for plot in ["before", "after", "residuals", "normalised", "correlation", "singular-values", "convergence"] {
        let svg = fs::read_to_string(copy.out().join(format!("plots/{plot}.svg"))).unwrap();
        assert!(svg.starts_with("<svg") && svg.contains("<title>"), "{plot}");
    }
    assert!(copy.out().join("plots/records-12.svg").exists());
    let laboratory = example().join("laboratory.toml");
    let arguments = ["--html", "h", "--pdf", "p", "--dcc", "d", "--laboratory", laboratory.to_str().unwrap()];
    let run = copy.run(&[&["report", "result.json"], &arguments[..]].concat());
    assert_eq!(run.status.code(), Some(0), "{}", String::from_utf8_lossy(&run.stderr));
    for (file, again) in [("report.html", "h"), ("certificate.pdf", "p"), ("certificate.xml", "d")] {
        let read = |name: &str| fs::read(copy.out().join(name)).unwrap();
        assert!(read(file) == read(again), "{file} differs");
    }
}

/// Verdict first, then the parameters; nothing from the network; every plot with its sentence.
#[test]
fn the_page_is_whole_and_alone() {
    let copy = calibrated("en");
    let page = fs::read_to_string(copy.out().join("report.html")).unwrap();
    let place = |text: &str| page.find(text).unwrap_or_else(|| panic!("{text} is not in the page"));
    assert!(place("Acceptable") < place("G0_11") && place("Acceptable") < place("Session"));
    let addresses = page.matches("http").count();
    assert_eq!(
        addresses,
        page.matches("xmlns=\"http://www.w3.org/2000/svg\"").count(),
        "nothing but the SVG name space"
    );
    assert!(!page.contains("<script"));
    assert_eq!(page.matches("<figure").count(), 9);
    assert_eq!(page.matches("<figcaption>").count(), 9);
    for name in ["delta_3[6]", "G2_33", "drho_22"] {
        place(name);
    }
}

#[test]
fn russian_has_its_words_and_commas() {
    let copy = calibrated("ru");
    let page = fs::read_to_string(copy.out().join("report.html")).unwrap();
    for part in
        ["lang=\"ru\"", "Пригоден", "Смещение нуля", "9,81523 м/с²", "мкg/g²", "Неопределённость по ходу сеанса"]
    {
        assert!(page.contains(part), "{part}");
    }
    let body = &page[page.find("<main>").unwrap()..page.find("<figure").unwrap()];
    let text: String = body.split('<').filter_map(|piece| piece.split_once('>')).map(|(_, text)| text).collect();
    let has_point = |pair: &[char]| pair[0].is_ascii_digit() && pair[1] == '.' && pair[2].is_ascii_digit();
    let letters: Vec<char> = text.replace("0.1.0", "").replace("0.0.0", "").chars().collect();
    let found = letters.windows(3).position(has_point);
    assert!(found.is_none(), "a decimal point in {:?}", found.map(|k| &letters[k.saturating_sub(20)..k + 5]));
    let dcc = fs::read_to_string(copy.out().join("certificate.xml")).unwrap();
    assert!(dcc.contains("<dcc:content lang=\"ru\">Параметры</dcc:content>"));
}

/// A certificate without the laboratory's data is refused, as is a laboratory file with a mistake, by place.
#[test]
fn certificates_need_the_laboratory() {
    let copy = calibrated("en");
    assert_eq!(copy.run(&["report", "result.json", "--pdf", "c.pdf"]).status.code(), Some(2));
    let text = fs::read_to_string(example().join("laboratory.toml")).unwrap();
    fs::write(copy.out().join("laboratory.toml"), text.replace("[customer]", "[costumer]")).unwrap();
    let run = copy.run(&["report", "result.json", "--pdf", "c.pdf", "--laboratory", "laboratory.toml"]);
    let message = String::from_utf8(run.stderr).unwrap();
    assert_eq!(run.status.code(), Some(2));
    assert!(message.contains("laboratory.toml, line ") && message.contains("costumer"), "{message}");
    assert!(!copy.out().join("c.pdf").exists());
}

/// A result that is not acceptable says so first, in the page and by the exit code.
#[test]
fn a_bad_result_is_called_bad() {
    let copy = calibrated("en");
    let file = copy.out().join("result.json");
    let mut result: serde_json::Value = serde_json::from_slice(&fs::read(&file).unwrap()).unwrap();
    result["fit"]["chi_squared"] = 1000.0.into();
    fs::write(&file, result.to_string()).unwrap();
    let run = copy.run(&["report", "result.json", "--html", "bad.html"]);
    assert_eq!(run.status.code(), Some(1));
    let page = fs::read_to_string(copy.out().join("bad.html")).unwrap();
    assert!(page.contains("Not acceptable") && page.contains("residuals are larger") && page.contains("1000.0"));
}
