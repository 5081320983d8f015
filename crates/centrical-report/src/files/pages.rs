//! The pages of a store: its list, and a page for each model of units, each station, and each unit with two calibrations or more.

mod overview;
mod unit;
mod written;

use std::path::Path;

use centrical_session::{Error, OnProgress, claim_folder, refuse_inputs, unwatched};

pub use self::overview::PagesRequest;
use self::overview::{DUE_PAGE, Overview};
use self::unit::UnitPages;
use self::written::{beginning, write_page, write_units};

/// The pages of a store as it was when it was read. Those of units, which may be many, are made one by one.
#[derive(Debug)]
pub struct StorePages {
    overview: Overview,
    units: UnitPages,
}

impl StorePages {
    /// Reads the store in `folder`. Memory is that of the values of all calibrations, a few kB each.
    ///
    /// # Errors
    /// [`Error`] when the store cannot be read, or a file of the request is wrong.
    pub fn read(folder: &Path, request: &PagesRequest) -> Result<Self, Error> {
        Self::read_watched(folder, request, &unwatched)
    }

    fn read_watched(folder: &Path, request: &PagesRequest, progress: OnProgress) -> Result<Self, Error> {
        let overview = Overview::read(folder, request, progress)?;
        let units = UnitPages::of(folder, &overview, request);
        Ok(Self { overview, units })
    }

    /// The page of this name, `index.html` the first; `None` for any other name.
    ///
    /// # Errors
    /// [`Error`] when the calibrations of a unit cannot be read.
    pub fn page(&self, file: &str) -> Result<Option<String>, Error> {
        if file == INDEX {
            return Ok(Some(self.overview.index.clone()));
        }
        if file == DUE_PAGE {
            return self.overview.due(|unit| self.units.page(unit));
        }
        match self.overview.pages.get(file) {
            Some(page) => Ok(Some(page.clone())),
            None => self.units.page(file),
        }
    }
}

/// Writes the pages of the store in `folder` to `out`, the list as `index.html`, and returns their number. The page of a unit that was made of the
/// same calibrations by the same program is left as it is. Memory is that of a few thousand whole calibrations and of the values of all.
/// `progress` is asked again and again; where it stops the work, pages that are whole may be there without the list.
///
/// # Errors
/// [`Error`] when the store cannot be read, a file of the request is wrong, or `out` does not take a page. [`Error::Stopped`].
pub fn write_history_pages(
    folder: &Path,
    out: &Path,
    request: &PagesRequest,
    progress: OnProgress,
) -> Result<usize, Error> {
    let index = out.join(INDEX);
    refuse_inputs(std::slice::from_ref(&index), &request.inputs())?;
    let StorePages { overview, units } = StorePages::read_watched(folder, request, progress)?;
    let _claim = claim_folder(out)?;
    for (file, page) in &overview.pages {
        write_page(&out.join(file), page)?;
    }
    write_units(&units, out, progress)?;
    let due = overview.due(|file| Ok(beginning(&out.join(file))))?;
    if let Some(page) = &due {
        write_page(&out.join(DUE_PAGE), page)?;
    }
    // The list comes last: it names pages that are there.
    write_page(&index, &overview.index)?;
    Ok(1 + overview.pages.len() + units.count() + usize::from(due.is_some()))
}

/// Name of the first page.
const INDEX: &str = "index.html";
