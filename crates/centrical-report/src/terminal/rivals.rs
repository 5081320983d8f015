//! How a rival is put into the model.

use centrical::{Extension, Rival};

/// The lines of `[model]` in `experiment.toml` that put rivals into the model, beside what stands there.
pub(super) fn lines_of(rivals: &[Rival]) -> Vec<String> {
    let mut terms: Vec<&str> = Vec::new();
    let mut extensions: Vec<String> = Vec::new();
    let mut lines = Vec::new();
    for rival in rivals {
        match rival {
            Rival::Terms(extra) => terms.push(extra.name()),
            Rival::Effect(Extension::PositionShift) => lines.push("pair_relation = \"free\"".to_owned()),
            Rival::Effect(extension) => extensions.push(extension.name()),
        }
    }
    if !terms.is_empty() {
        let terms: Vec<String> = terms.iter().map(|name| format!("{name:?}")).collect();
        lines.push(format!("error_model = [\"kozlov-2017\", {}]", terms.join(", ")));
    }
    if !extensions.is_empty() {
        lines.push(format!("extensions = {extensions:?}"));
    }
    lines
}
