//! Finished results: their list, a report of each, two compared; and the live page of a watch among them.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};

use centrical_report::{Language, ListedResult, compared_page, figures, html, report, results_page, unchosen_page};
use centrical_session::{CalibrationResult, ComparisonRequest, Error, Place, collect_results, compare_results};

use super::answer::{Answer, Query, Site};
use super::watched::Watched;

/// Folders and results that are looked at.
#[derive(Debug)]
pub struct Results {
    paths: Vec<PathBuf>,
    title: String,
    watched: Watched,
}

impl Results {
    /// The results in `paths`: folders, which are searched, and files.
    ///
    /// # Errors
    /// [`Error`] when a folder cannot be read, or there is neither a result nor a watch.
    pub fn new(paths: &[PathBuf]) -> Result<Self, Error> {
        let title: Vec<String> = paths.iter().map(|path| path.display().to_string()).collect();
        let folder = paths.iter().find(|path| path.is_dir()).map_or(Path::new("."), PathBuf::as_path);
        let results = Self { paths: paths.to_owned(), title: title.join(", "), watched: Watched::new(folder) };
        let files = results.files()?;
        if let [only] = &files[..] {
            CalibrationResult::read(only)?;
        }
        if files.is_empty() && !results.watched.is_there() {
            let expected = "a result.json, or the files of a watch";
            return Err(Error::content(folder, Place::Whole, "neither a result nor a watch", expected));
        }
        Ok(results)
    }

    /// The files, as they are now: a folder may have more since.
    fn files(&self) -> Result<Vec<PathBuf>, Error> {
        let mut files = Vec::new();
        self.paths.iter().try_for_each(|path| collect_results(path, &mut files))?;
        Ok(files)
    }

    fn list(&self, language: Language) -> Result<String, Error> {
        let listed = |file: PathBuf| ListedResult {
            id: id(&file),
            result: CalibrationResult::read(&file).map(Box::new).map_err(|error| error.to_string()),
            file: file.display().to_string(),
        };
        let results: Vec<ListedResult> = self.files()?.into_iter().map(listed).collect();
        Ok(results_page(&self.title, &results, self.watched.is_there(), language))
    }

    /// The file of an address.
    fn file(&self, wanted: &str) -> Option<PathBuf> {
        self.files().ok()?.into_iter().find(|file| id(file) == wanted)
    }

    fn report(&self, id: &str, language: Language) -> Option<Answer> {
        let result = CalibrationResult::read(&self.file(id)?);
        let drawn =
            |result: CalibrationResult| html(&report(&result, None, None, figures(&result, language), language));
        Some(result.map(drawn).map(Answer::Document).into())
    }

    fn compared(&self, query: &Query) -> Option<Answer> {
        let (Some(first), Some(second)) = (query.get("first"), query.get("second")) else {
            return Some(Answer::Page(unchosen_page(query.language())));
        };
        let files = [self.file(first)?, self.file(second)?];
        let compared = || {
            let results = [CalibrationResult::read(&files[0])?, CalibrationResult::read(&files[1])?];
            let named = [(files[0].as_path(), &results[0]), (files[1].as_path(), &results[1])];
            compare_results(&named, ComparisonRequest { years: None, other_units: true })
        };
        Some(compared().map(|report| Answer::Page(compared_page(&report, query.language()))).into())
    }
}

/// What the address of a result's page names it by. Its place in the list would change with the next result.
fn id(file: &Path) -> String {
    let mut hasher = DefaultHasher::new();
    file.hash(&mut hasher);
    format!("{:016x}", hasher.finish())
}

impl Site for Results {
    fn answer(&self, path: &str, query: &Query) -> Option<Answer> {
        match path {
            "/" => Some(self.list(query.language()).map(Answer::Page).into()),
            "/compare" => self.compared(query),
            "/live" => self.watched.answer("/", query),
            path => match path.strip_prefix("/report/") {
                Some(id) => self.report(id, query.language()),
                None => self.watched.answer(path, query),
            },
        }
    }

    fn has_panel(&self) -> bool {
        self.watched.is_there()
    }

    fn stamp(&self) -> u64 {
        self.watched.stamp()
    }

    fn panel(&self, language: Language) -> Option<String> {
        self.watched.panel(language)
    }

    fn metrics(&self) -> String {
        if self.watched.is_there() { self.watched.metrics() } else { String::new() }
    }
}
