//! Russian documents are Russian: Latin words in them are names of parameters, of standards and of the user's own.

use std::fs;
use std::path::Path;

use centrical_report::{Block, Document, Language, Row, certificate, figures, read_issuer, report};
use centrical_session::{CalibrationResult, Method, Session, calibrate, unwatched};

const EXAMPLE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/ta-200");

/// Names of standards, of files and of methods that Russian texts cite.
const CITED: &str = "JCGM GUM EA ILAC eff result.json SHA-256 K5.3 centrical";

/// The example calibrated with terms and an unknown that the source's model does not have.
fn extended() -> CalibrationResult {
    let folder = tempfile::tempdir().unwrap();
    let form = fs::read_to_string(Path::new(EXAMPLE).join("experiment.toml")).unwrap();
    let model = "error_model = \"kozlov-2017\"";
    let further = "error_model = [\"kozlov-2017\", \"cross-products\", { axis = 2, term = \"|f2|\" }, \
                   { axis = 1, term = \"f1^4\" }]\nextensions = [\"radius-scale\", \"speed-scale\"]";
    assert!(form.contains(model));
    // Telemetry in another unit, which the documents say.
    let unit = "speed_unit = \"rad/s\"";
    assert!(form.contains(unit));
    let form = form.replace(model, further).replace(unit, "speed_unit = \"rpm\"");
    fs::write(folder.path().join("experiment.toml"), form).unwrap();
    for part in ["records", "telemetry"] {
        fs::create_dir(folder.path().join(part)).unwrap();
        for file in fs::read_dir(Path::new(EXAMPLE).join(part)).unwrap().flatten() {
            fs::copy(file.path(), folder.path().join(part).join(file.file_name())).unwrap();
        }
    }
    calibrate(&Session::read(folder.path()).unwrap(), &[], Method::Recursive, &unwatched).unwrap()
}

/// Everything that a document says outside its drawings.
fn text(document: &Document) -> String {
    let mut all = vec![
        document.title.clone(),
        document.opening.title.clone(),
        document.margins.foot.clone(),
        document.contents.clone(),
    ];
    for block in document.sections.iter().flat_map(|section| &section.blocks) {
        match block {
            Block::Heading(text, _) | Block::Subheading(text) | Block::Paragraph(text) | Block::Note(text) => {
                all.push(text.clone());
            }
            Block::List(items) => all.extend(items.iter().cloned()),
            // Names of parameters.
            Block::Formulas(_) => {}
            Block::Facts(facts) => all.extend(facts.iter().flat_map(|(name, value)| [name.clone(), value.clone()])),
            Block::Table(table) => {
                all.extend(table.columns.iter().map(|column| column.title.clone()));
                all.extend(table.rows.iter().flat_map(|row| match row {
                    Row::Group(name) => vec![name.clone()],
                    Row::Cells(cells) => cells.clone(),
                }));
            }
            Block::Figure(figure) => all.extend([figure.title.clone(), figure.caption.clone()]),
            Block::Signature { name, role, word, date, mark } => {
                all.extend([name, role, word, date, mark].map(Clone::clone));
            }
        }
    }
    all.join("\n")
}

/// Runs of two and more Latin letters.
fn latin_words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| !c.is_ascii_alphabetic()).filter(|word| word.len() > 1)
}

#[test]
fn russian_documents_have_no_english_words() {
    let result = extended();
    let file = Path::new(EXAMPLE).join("laboratory.toml");
    let issuer = read_issuer(&file, &result).unwrap();
    let names: Vec<&str> = result.parameters.iter().map(|p| p.name.as_str()).collect();
    assert!(names.contains(&"K_1[f1*f2]") && names.contains(&"radius_scale"), "{names:?}");
    let session = &result.session;
    let inputs: Vec<&str> = result.inputs.iter().flat_map(|input| [&*input.path, &*input.sha256]).collect();
    let own = [&*session.title, &session.unit_model, &session.text, &fs::read_to_string(&file).unwrap()].join(" ");
    let allowed = format!("{} {} {own} {CITED} {}", names.join(" "), inputs.join(" "), result.schema);
    let documents = [
        certificate(&result, Some(&result), &issuer, Language::Russian),
        report(&result, issuer.unit.as_ref(), None, figures(&result, Language::Russian), Language::Russian),
    ];
    for document in documents {
        let text = text(&document);
        assert!(text.contains("Перекрёстная связь") && text.contains("Асимметрия масштаба"));
        for word in latin_words(&text) {
            assert!(latin_words(&allowed).any(|known| known == word), "{word}");
        }
    }
    let report = text(&report(&result, None, None, figures(&result, Language::Russian), Language::Russian));
    for words in [
        "рекуррентный фильтр",
        "скорости в рад/с прочитаны в об/мин",
        "Масштаб радиусов",
        "Масштаб скорости",
        "Член высшего порядка",
    ] {
        assert!(report.contains(words), "{words}");
    }
}
