//! What `[model]` says beside the terms: extensions, and how the shifts of a pair are related.

use std::path::Path;

use centrical::{Extension, PairRelation};

use super::form::ModelTable;
use super::toml_path::TomlPath;
use crate::error::{Error, quoted};

/// The extensions of `[model]`, each once.
pub(crate) fn extensions(file: &Path, table: &ModelTable) -> Result<Vec<Extension>, Error> {
    named_extensions(&TomlPath::table(file, "model"), &table.extensions)
}

/// Extensions by their names, each once.
pub(crate) fn named_extensions(at: &TomlPath, names: &[String]) -> Result<Vec<Extension>, Error> {
    let mut extensions = Vec::new();
    for name in names {
        let found = quoted(name.as_bytes());
        let Some(extension) = Extension::named(name) else {
            let known: Vec<&str> = Extension::NAMED.iter().map(|(name, _)| *name).collect();
            let expected = format!("one of {}", known.join(", "));
            return Err(at.unexpected("extensions", found, expected));
        };
        if extensions.contains(&extension) {
            let expected = "every extension once";
            return Err(at.unexpected("extensions", format!("{found} a second time"), expected));
        }
        extensions.push(extension);
    }
    Ok(extensions)
}

/// How the shifts of a pair are related; free if not stated, as without an arm.
pub(crate) fn pair_relation(file: &Path, table: &ModelTable) -> Result<PairRelation, Error> {
    let text = table.pair_relation.as_deref().unwrap_or("free");
    match text {
        "common" => Ok(PairRelation::Common),
        "opposite" => Ok(PairRelation::Opposite),
        "free" => Ok(PairRelation::Free),
        _ => {
            let expected = "\"common\", \"opposite\" or \"free\"";
            Err(TomlPath::table(file, "model").unexpected("pair_relation", quoted(text.as_bytes()), expected))
        }
    }
}
