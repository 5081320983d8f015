//! How a rival is put into the model.

use centrical::{Extension, Rival};

/// What to change under `[model]` in `experiment.toml` to put rivals into the model: `add "jump" to error_model`.
pub(super) fn changes_for(rivals: &[Rival]) -> String {
    let mut terms: Vec<String> = Vec::new();
    let mut extensions: Vec<String> = Vec::new();
    let mut changes = Vec::new();
    for rival in rivals {
        match rival {
            Rival::Terms(extra) => terms.push(extra.name().to_owned()),
            Rival::Effect(Extension::PositionShift) => changes.push("set pair_relation = \"free\"".to_owned()),
            Rival::Effect(extension) => extensions.push(extension.name()),
        }
    }
    for (key, names) in [("error_model", terms), ("extensions", extensions)] {
        if !names.is_empty() {
            let names: Vec<String> = names.iter().map(|name| format!("{name:?}")).collect();
            changes.push(format!("add {} to {key}", names.join(", ")));
        }
    }
    changes.join("; ")
}
