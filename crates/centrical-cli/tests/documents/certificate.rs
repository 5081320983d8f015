//! The certificate's text, item by item of ISO/IEC 17025:2017.

use std::fs;
use std::path::Path;
use std::process::Command;

use crate::{documents, example, program};

/// Text of a PDF file, pages apart by form feeds.
pub fn text_of(pdf: &Path) -> String {
    let run = Command::new("pdftotext").arg("-layout").arg(pdf).arg("-").output();
    String::from_utf8(run.expect("pdftotext is installed").stdout).unwrap()
}

fn certificate(language: &str, alter: impl Fn(String) -> String) -> String {
    text_of(&documents(language, alter).path().join("certificate.pdf"))
}

/// The text with its lines joined, so that a sentence is found wherever it is broken.
fn joined(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

fn has(text: &str, items: &[(&str, &str)]) {
    let joined = joined(text);
    for (item, expected) in items {
        assert!(joined.contains(expected), "{item}: {expected:?} is not in\n{text}");
    }
}

/// Number and page x of y on every page.
fn pages_are_numbered(text: &str, number: &str, page_of: impl Fn(usize, usize) -> String) {
    let pages: Vec<&str> = text.split('\u{c}').filter(|page| !page.trim().is_empty()).collect();
    assert!(pages.len() > 1);
    for (n, page) in (1..).zip(&pages) {
        assert!(page.contains(&page_of(n, pages.len())), "page {n}");
        assert!(page.contains(number), "page {n}");
    }
}

/// A long name is broken into lines beside the line for the date.
#[test]
#[ignore = "needs pdftotext"]
fn a_long_name_stays_on_the_page() {
    let name = "Prof. Dr.-Ing. habil. Maximiliane-Alexandra von Hohenlohe-Waldenburg-Schillingsfürst";
    let text = certificate("en", |text| text.replacen("name = \"A. Ivanova\"", &format!("name = \"{name}\""), 1));
    assert!(!text.contains(name) && joined(&text).contains("Schillingsfürst"), "{text}");
}

/// 7.8.2.1 a to o and 7.8.4.1 a to e; k (sampling) and p (results of others) do not apply.
#[test]
#[ignore = "needs pdftotext"]
fn the_certificate_has_every_item() {
    let text = certificate("en", |text| text);
    has(
        &text,
        &[
            ("7.8.2.1 a, title", "Calibration certificate"),
            ("b, laboratory", "Centrifuge Laboratory, Institute of Inertial Metrology"),
            ("b, address", "Leninskiye Gory 1, 119991 Moscow, RU"),
            ("c, place", "Place of calibration the laboratory’s premises"),
            ("d, end", "End of certificate"),
            ("e, customer", "Customer Northern Navigation Works"),
            ("e, address", "Embankment 12, 190000 Saint Petersburg, RU"),
            ("f, method", "by the method of A. V. Kozlov"),
            ("f, procedure", "Procedure CL-MP-07, edition 3"),
            ("g, item", "Description Unit of three newtonometers"),
            ("g, model", "Model TA-200"),
            ("g, serial number", "Serial number 0001"),
            ("g, condition", "Condition on receipt No visible damage, complete"),
            ("h, receipt", "Received 2026-10-01"),
            ("i, performance", "Calibrated 2026-10-05 – 2026-10-07"),
            ("j, issue", "Issued 2026-10-09"),
            ("l, item only", "The results relate only to the item calibrated"),
            ("m, a result with sign and unit", "Bias df₁ −3.9524 ± 0.0040 mg 2.00 (−3.8760 ± 0.0039)·10⁻² m/s²"),
            ("m, the last result", "G2₃₃ −0.00010 ± 0.00053 µg/g³ 2.00"),
            ("m, what the results mean", "f₁′ = f₁ + df₁ + G0₁₁·f₁ + G1₁₁·f₁²"),
            ("n, deviations", "Additions, deviations, exclusions None"),
            ("o, authorised", "Authorised by A. Ivanova"),
            ("o, role", "Head of the laboratory"),
            ("7.8.2.1, reproduction", "shall not be reproduced except in full"),
            ("7.8.4.1 a, coverage", "multiplied by the coverage factor k"),
            ("7.8.4.1 a, probability", "coverage probability of approximately 95 % (95.45 %)"),
            ("a, what U holds", "U contains these contributions: noise, speed of each plateau."),
            (
                "a, what it does not",
                "taken as exact and contribute nothing to it: gravity, latitude, radius, scale of the",
            ),
            (
                "e, condition",
                "The statement presupposes that these quantities, which were taken as exact, are exact: gravity",
            ),
            ("b, temperature", "Air temperature 20.3 ± 0.5 °C"),
            ("b, humidity", "Relative humidity 45 ± 5 %"),
            ("b, pressure", "Air pressure 100.9 ± 0.4 kPa"),
            ("b, gravity", "Local gravity 9.81523 m/s²"),
            ("b, range", "Range of specific force ±"),
            ("b, speeds", "rpm Radii 0."),
            ("b, plateaus", "Plateaus used 108 Latitude 55.7000°"),
            ("m, axes", "Axis 1 lies along newtonometer 1"),
            ("b, drift", "Drift over a plateau, mean f₁ "),
            ("b, drift", "no drift seen"),
            ("b, tilt", "300.17 ± 0.72 µrad; χ² = 0.2; ν = 1; they agree"),
            ("n, samples left out", "Samples not used spikes: 4"),
            ("c, traceability", "traceable to the SI"),
            ("c, standard", "GET 94-2001"),
            ("c, its certificate", "DL-2026-0031"),
            ("d, adjustment", "No adjustment or repair of the unit is stated"),
            ("d, before", "Before compensation mg 185 199 105"),
            ("d, after", "After compensation µg 858 970 684"),
            ("d, what remains uncertain", "Expanded uncertainty of compensation, U"),
            ("e, specification", "TA-200 data sheet, table 3"),
            ("e, conformity", "df₁ −0.15 … 0.15 −0.038760 ± 0.000039 m/s² conforms"),
            ("e, the reading", "−10 … 10 0.0 ± 5.2 mg conforms"),
            ("o, date of the signature", "signature Head of the laboratory date"),
            ("a place for marks", "place for mark or seal"),
            ("7.8.6, rule", "guarded acceptance with guard band w = U"),
        ],
    );
    assert!(!text.contains("GUM"), "{text}");
    // 7.8.4.3: no recommendation on the calibration interval.
    assert!(!text.to_lowercase().contains("interval") && !text.to_lowercase().contains("next calibration"));
    pages_are_numbered(&text, "Certificate no. CL-2026-0117", |n, of| format!("page {n} of {of}"));
}

/// The same in Russian: words, decimal commas, dates and units as they are written there.
#[test]
#[ignore = "needs pdftotext"]
fn in_russian() {
    let text = certificate("ru", |text| text);
    has(
        &text,
        &[
            ("title", "Сертификат калибровки"),
            ("customer", "Заказчик Northern Navigation Works"),
            ("dates", "Калибровка выполнена 05.10.2026 – 07.10.2026"),
            ("method", "по методу А. В. Козлова"),
            ("conditions", "Температура воздуха 20,3 ± 0,5 °C"),
            ("pressure", "100,9 ± 0,4 кПа"),
            ("speeds", "598,3 об/мин"),
            ("drift", "уход не обнаружен"),
            ("tilt", "результаты согласуются"),
            ("a result", "Смещение нуля df₁ −3,9524 ± 0,0040 мg 2,00 (−3,8760 ± 0,0039)·10⁻² м/с²"),
            ("uncertainty", "коэффициент охвата k для вероятности охвата приблизительно 95 % (95,45 %)"),
            ("adjustment", "О юстировке или ремонте прибора не сообщается"),
            ("rule", "приёмка с защитной полосой w = U"),
            ("conformity", "−0,15 … 0,15 −0,038760 ± 0,000039 м/с² соответствует"),
            ("authorised", "Утвердил A. Ivanova"),
            ("item only", "Результаты относятся только к калиброванному объекту"),
            ("end", "Конец сертификата"),
        ],
    );
    pages_are_numbered(&text, "Сертификат № CL-2026-0117", |n, of| format!("стр. {n} из {of}"));
    for english in ["Certificate no.", "page ", "Results", "Customer", "Bias", "conforms"] {
        assert!(!text.contains(english), "{english}");
    }
}

/// What the laboratory did, says and asks for changes the certificate accordingly.
#[test]
#[ignore = "needs pdftotext"]
fn adjustment_and_decision() {
    let adjusted = certificate("en", |text| {
        text.replace("[method]", "adjustment = \"Bias of axis 2 set to zero before the calibration\"\n[method]")
    });
    has(&adjusted, &[("d", "Before and after adjustment Bias of axis 2 set to zero before the calibration")]);
    assert!(!adjusted.contains("No adjustment"));

    let folder = documents("en", |text| text.replace("[method]", "adjustment = \"Bias of axis 1 halved\"\n[method]"));
    let before = fs::read_to_string(folder.path().join("result.json")).unwrap();
    let mut before: serde_json::Value = serde_json::from_str(&before).unwrap();
    let bias = before["parameters"].as_array_mut().unwrap().iter_mut().find(|p| p["name"] == "df_1").unwrap();
    bias["value"] = (2.0 * bias["value"].as_f64().unwrap()).into();
    before["session"]["date"] = "2026-10-04".into();
    fs::write(folder.path().join("before.json"), before.to_string()).unwrap();
    let report = |arguments: &[&str]| {
        let mut command = program::centrical();
        command.args(["report", "result.json", "--pdf", "both.pdf", "--before", "before.json", "--laboratory"]);
        command.args(arguments).current_dir(&folder).output().unwrap()
    };
    assert!(report(&["laboratory.toml"]).status.success());
    let both = text_of(&folder.path().join("both.pdf"));
    has(
        &both,
        &[
            ("d, when", "Calibration before the adjustment: 2026-10-04."),
            ("d, before and after", "Before adjustment, ± U After adjustment, ± U"),
            ("d, what was adjusted", "df₁ −7.9049 ± 0.0040 −3.9524 ± 0.0040 mg"),
            ("d, what was not", "df₂ −10.157 ± 0.020 −10.157 ± 0.020 mg"),
        ],
    );
    // Its own calibration, or a later one, is not the one before.
    for (date, expected) in [("2026-10-05", "found the result itself"), ("2026-10-06", "expected one of 2026-10-05")] {
        before["session"]["date"] = date.into();
        fs::write(folder.path().join("before.json"), before.to_string()).unwrap();
        let refused = report(&["laboratory.toml"]);
        let message = String::from_utf8_lossy(&refused.stderr).into_owned();
        assert!(refused.status.code() == Some(2) && message.contains(expected), "{message}");
    }
    before["session"]["date"] = "2026-10-04".into();
    fs::write(folder.path().join("before.json"), before.to_string()).unwrap();
    let unsaid = report(&[example("laboratory.toml").to_str().unwrap()]);
    let message = String::from_utf8_lossy(&unsaid.stderr).into_owned();
    assert!(unsaid.status.code() == Some(2) && message.contains("[item] adjustment"), "{message}");

    // -0.0388 m/s^2 with U = 0.00004: inside by less than U, so simple acceptance alone accepts it.
    let tight = |rule: &str| {
        let rule = rule.to_owned();
        certificate("en", move |text| {
            text.replace("rule = \"guarded\"", &format!("rule = \"{rule}\"")).replacen(
                "low = -0.15",
                "low = -0.03878",
                1,
            )
        })
    };
    let [simple, guarded] = ["simple", "guarded"].map(tight);
    has(&simple, &[("rule", "simple acceptance"), ("verdict", "−0.038760 ± 0.000039 m/s² conforms")]);
    has(&guarded, &[("rule", "guarded acceptance"), ("verdict", "−0.038760 ± 0.000039 m/s² not accepted")]);

    let unasked = certificate("en", |text| text[..text.find("[decision]").unwrap()].to_owned());
    assert!(!unasked.contains("conform"), "no statement that was not asked for");
}

/// The objections to a result stand before everything else, and no conformity is stated from it.
#[test]
#[ignore = "needs pdftotext"]
fn a_result_that_is_not_acceptable_says_so() {
    let folder = documents("en", |text| text);
    let result = folder.path().join("result.json");
    let mut json: serde_json::Value = serde_json::from_str(&fs::read_to_string(&result).unwrap()).unwrap();
    json["fit"]["chi_squared"] = 1000.0.into();
    fs::write(&result, json.to_string()).unwrap();
    let mut command = program::centrical();
    command.args(["report", "result.json", "--pdf", "bad.pdf", "--dcc", "bad.xml", "--laboratory", "laboratory.toml"]);
    let run = command.current_dir(&folder).output().unwrap();
    assert_eq!(run.status.code(), Some(1));
    let said = String::from_utf8_lossy(&run.stdout).into_owned();
    assert!(said.contains("NOT ACCEPTABLE  residuals are larger"), "{said}");
    let text = text_of(&folder.path().join("bad.pdf"));
    has(
        &text,
        &[
            (
                "verdict",
                "Calibration certificate Calibration not acceptable The result must not be used as it stands: – residuals are",
            ),
            ("conformity", "−0.038760 ± 0.000039 m/s² not stated"),
        ],
    );
    assert!(!text.contains("conforms"), "{text}");
    let dcc = fs::read_to_string(folder.path().join("bad.xml")).unwrap();
    assert!(dcc.contains("Calibration not acceptable: residuals are larger") && !dcc.contains("<dcc:conformity>"));
}

/// The file is an archive of the kind that it says, carries the digital certificate as it is beside it.
#[test]
#[ignore = "needs poppler"]
fn the_certificate_carries_its_digital_form() {
    let folder = documents("en", |text| text);
    let file = folder.path().join("certificate.pdf");
    let said = |program: &str, arguments: &[&str]| {
        let run = Command::new(program).args(arguments).arg(&file).current_dir(&folder).output().expect("poppler");
        String::from_utf8_lossy(&run.stdout).into_owned()
    };
    let metadata = said("pdfinfo", &["-meta"]);
    for part in ["<pdfaid:part>3<", "<pdfaid:conformance>B<", "Calibration certificate CL-2026-0117", "centrical<"] {
        assert!(metadata.contains(part), "{part}: {metadata}");
    }
    let copy = fs::read(folder.path().join("certificate.xml")).unwrap();
    fs::create_dir(folder.path().join("carried")).unwrap();
    let mut detach = Command::new("pdfdetach");
    let run = detach.args(["-saveall", "-o", "carried"]).arg(&file).current_dir(&folder).output().unwrap();
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    assert!(fs::read(folder.path().join("carried/certificate.xml")).unwrap() == copy, "the carried file differs");
    // Without it the file is an archive of the plainer kind.
    let mut command = program::centrical();
    command.args(["report", "result.json", "--pdf", "certificate.pdf", "--laboratory", "laboratory.toml"]);
    assert!(command.current_dir(&folder).output().unwrap().status.success());
    assert!(said("pdfinfo", &["-meta"]).contains("<pdfaid:part>2<"));
}

/// Every font is in the file.
#[test]
#[ignore = "needs pdffonts"]
fn fonts_are_embedded() {
    let folder = documents("ru", |text| text);
    let run = Command::new("pdffonts").arg(folder.path().join("certificate.pdf")).output().expect("poppler");
    let table = String::from_utf8(run.stdout).unwrap();
    let rows: Vec<Vec<&str>> = table.lines().skip(2).map(|line| line.split_whitespace().collect()).collect();
    assert!(rows.len() >= 2, "{table}");
    // Name, type (two words), encoding, emb.
    assert!(rows.iter().all(|row| row[4] == "yes"), "{table}");
}
