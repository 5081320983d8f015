//! The names that a crate offers.

use std::collections::BTreeSet;

use syn::{Item, Visibility};

use super::module_tree::ModuleTree;

/// Full path of every public item that is reached from `lib.rs`, modules themselves not counted.
pub fn public_names(tree: &ModuleTree) -> Vec<String> {
    let mut names = BTreeSet::new();
    collect(tree, 0, &tree.modules[0].name, &mut Vec::new(), &mut names);
    names.into_iter().collect()
}

/// Number of items among the names: an item that is exported twice counts once.
pub fn distinct(names: &[String]) -> usize {
    names.iter().map(|name| name.rsplit("::").next()).collect::<BTreeSet<_>>().len()
}

fn collect(tree: &ModuleTree, index: usize, prefix: &str, open: &mut Vec<usize>, names: &mut BTreeSet<String>) {
    if open.contains(&index) {
        return;
    }
    open.push(index);
    let module = &tree.modules[index];
    for item in &module.items {
        let (visibility, ident) = match item {
            Item::Mod(i) if is_public(&i.vis) => {
                let child = i.ident.to_string();
                collect(tree, module.children[&child], &format!("{prefix}::{child}"), open, names);
                continue;
            }
            Item::Const(i) => (&i.vis, &i.ident),
            Item::Enum(i) => (&i.vis, &i.ident),
            Item::Fn(i) => (&i.vis, &i.sig.ident),
            Item::Static(i) => (&i.vis, &i.ident),
            Item::Struct(i) => (&i.vis, &i.ident),
            Item::Trait(i) => (&i.vis, &i.ident),
            Item::Type(i) => (&i.vis, &i.ident),
            _ => continue,
        };
        if is_public(visibility) {
            names.insert(format!("{prefix}::{ident}"));
        }
    }
    for path in module.paths.iter().filter(|path| path.public) {
        let found = tree.resolve(index, &path.segments);
        match (&path.binds, found) {
            (Some(name), Some((target, used))) if used == path.segments.len() => {
                collect(tree, target, &format!("{prefix}::{name}"), open, names);
            }
            (Some(name), _) => {
                names.insert(format!("{prefix}::{name}"));
            }
            (None, Some((target, _))) => collect(tree, target, prefix, open, names),
            (None, None) => {}
        }
    }
    open.pop();
}

fn is_public(visibility: &Visibility) -> bool {
    matches!(visibility, Visibility::Public(_))
}

#[cfg(test)]
mod tests {
    use super::{super::module_tree::Sources, *};

    #[test]
    fn names_are_counted_where_a_user_reaches_them() {
        let files = [
            (
                "lib.rs",
                "mod a; pub mod b; pub use a::{A, low as deep, private::*}; pub(crate) struct Hidden; pub use nalgebra;",
            ),
            ("a.rs", "pub mod low; pub mod private; pub struct A; pub struct NotReached;"),
            ("a/low.rs", "pub fn f() {} fn g() {}"),
            ("a/private.rs", "pub const P: f64 = 0.0;"),
            ("b.rs", "pub use super::a::A; #[cfg(test)] pub fn t() {}"),
        ];
        let sources: Sources = files.iter().map(|(file, text)| ((*file).to_owned(), (*text).to_owned())).collect();
        let names = public_names(&ModuleTree::parse("house", &sources, "lib.rs"));
        assert_eq!(names, ["house::A", "house::P", "house::b::A", "house::deep::f", "house::nalgebra"]);
        assert_eq!(distinct(&names), 4);
    }
}
