//! A store of calibrations: the pages that `history page` writes, made when they are asked for.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

use centrical_report::{PagesRequest, StorePages};
use centrical_session::{Error, Store};

use super::answer::{Answer, Query, Site};

/// A store that is looked at.
#[derive(Debug)]
pub struct Stored {
    store: Store,
    request: PagesRequest,
    /// The pages as they were made last, and what the store looked like then.
    made: Mutex<Option<(u64, Arc<StorePages>)>>,
}

impl Stored {
    /// The store in `folder`, which is read.
    ///
    /// # Errors
    /// [`Error`] when there is no store, it cannot be read, or a file of the request is wrong.
    pub fn new(folder: &Path, request: PagesRequest) -> Result<Self, Error> {
        let stored = Self { store: Store::open(folder)?, request, made: Mutex::new(None) };
        stored.pages()?;
        Ok(stored)
    }

    /// The pages of the store as it is now. Whoever asks while they are made waits.
    fn pages(&self) -> Result<Arc<StorePages>, Error> {
        let mut made = self.made.lock().unwrap_or_else(PoisonError::into_inner);
        let stamp = self.stamp()?;
        if let Some((of, pages)) = made.as_ref()
            && *of == stamp
        {
            return Ok(Arc::clone(pages));
        }
        let pages = Arc::new(StorePages::read(self.store.folder(), &self.request)?);
        *made = Some((stamp, Arc::clone(&pages)));
        Ok(pages)
    }

    /// A number that changes with the parts of the store: a part never changes under its name.
    fn stamp(&self) -> Result<u64, Error> {
        let mut hasher = DefaultHasher::new();
        self.store.parts()?.hash(&mut hasher);
        Ok(hasher.finish())
    }
}

impl Site for Stored {
    fn answer(&self, path: &str, _: &Query) -> Option<Answer> {
        let file = match path.strip_prefix('/')? {
            "" => "index.html",
            file => file,
        };
        let page = self.pages().and_then(|pages| pages.page(file)).transpose()?;
        Some(page.map(Answer::Document).into())
    }
}
