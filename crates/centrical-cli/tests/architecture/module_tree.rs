//! The modules of a crate, and the paths that each of them names.

use std::collections::BTreeMap;

use proc_macro2::{TokenStream, TokenTree};
use syn::{
    Attribute, Ident, ImplItem, Item, ItemUse, Macro, Meta, UseTree, Visibility, ext::IdentExt, visit, visit::Visit,
};

/// Text of each source file by its path from `src/`.
pub type Sources = BTreeMap<String, String>;

/// All modules of a crate but those of its tests; the first is the root.
pub struct ModuleTree {
    pub modules: Vec<Module>,
}

pub struct Module {
    /// Full name, as in `centrical::plan::search`.
    pub name: String,
    /// Path from the folder of the workspace.
    pub file: String,
    pub parent: Option<usize>,
    pub children: BTreeMap<String, usize>,
    pub items: Vec<Item>,
    pub paths: Vec<NamedPath>,
    /// Modules that a `use` brings into scope.
    imported: BTreeMap<String, usize>,
}

/// A path of two segments or more; a glob ends in `*`.
#[derive(Debug, Clone)]
pub struct NamedPath {
    pub segments: Vec<String>,
    /// Name that a `use` binds.
    pub binds: Option<String>,
    pub line: usize,
    /// Whether it is a `pub use`.
    pub public: bool,
}

impl ModuleTree {
    /// # Panics
    /// If a file does not parse or a module has no file.
    pub fn parse(crate_name: &str, sources: &Sources, root: &str) -> Self {
        let mut tree = Self { modules: Vec::new() };
        let reader = Reader { sources, prefix: format!("crates/{}/src/", crate_name.replace('_', "-")) };
        reader.add(&mut tree, None, crate_name, root, "", reader.items(root));
        tree.find_imported_modules();
        tree
    }

    /// The last module along the path, with the number of segments that lead to it; `None` where it leaves the crate.
    pub fn resolve(&self, from: usize, segments: &[String]) -> Option<(usize, usize)> {
        let first = segments.first()?;
        let (mut at, mut used) = match first.as_str() {
            "crate" => (0, 1),
            "self" => (from, 1),
            "super" => (self.modules[from].parent?, 1),
            name => (self.in_scope(from, name)?, 1),
        };
        while let Some(segment) = segments.get(used) {
            at = match segment.as_str() {
                "super" => self.modules[at].parent?,
                name => match self.modules[at].children.get(name) {
                    Some(&child) => child,
                    None => break,
                },
            };
            used += 1;
        }
        Some((at, used))
    }

    pub fn is_within(&self, module: usize, ancestor: usize) -> bool {
        self.lineage(module).any(|m| m == ancestor)
    }

    /// The module itself, its parent and so on to the root.
    pub fn lineage(&self, module: usize) -> impl Iterator<Item = usize> {
        std::iter::successors(Some(module), |&m| self.modules[m].parent)
    }

    fn in_scope(&self, module: usize, name: &str) -> Option<usize> {
        let module = &self.modules[module];
        module.children.get(name).or_else(|| module.imported.get(name)).copied()
    }

    fn find_imported_modules(&mut self) {
        // An imported module may be found through another imported one: until nothing is added.
        loop {
            let mut found = Vec::new();
            for (index, module) in self.modules.iter().enumerate() {
                for path in &module.paths {
                    if let Some(name) = path.binds.as_ref().filter(|name| self.in_scope(index, name).is_none())
                        && let Some((target, used)) = self.resolve(index, &path.segments)
                        && used == path.segments.len()
                    {
                        found.push((index, name.clone(), target));
                    }
                }
            }
            if found.is_empty() {
                return;
            }
            for (index, name, target) in found {
                self.modules[index].imported.insert(name, target);
            }
        }
    }
}

struct Reader<'a> {
    sources: &'a Sources,
    prefix: String,
}

impl Reader<'_> {
    fn items(&self, file: &str) -> Vec<Item> {
        let text = self.sources.get(file).unwrap_or_else(|| panic!("{}{file}: no such file", self.prefix));
        syn::parse_file(text)
            .unwrap_or_else(|e| panic!("{}{file}, line {}: {e}", self.prefix, e.span().start().line))
            .items
    }

    fn add(
        &self,
        tree: &mut ModuleTree,
        parent: Option<usize>,
        name: &str,
        file: &str,
        folder: &str,
        items: Vec<Item>,
    ) {
        let index = tree.modules.len();
        if let Some(parent) = parent {
            let last = name.rsplit("::").next().expect("a name has a last part").to_owned();
            tree.modules[parent].children.insert(last, index);
        }
        let items: Vec<Item> = items.into_iter().filter(|item| !is_test(attributes(item))).collect();
        let mut collector = Collector::default();
        for item in &items {
            collector.visit_item(item);
        }
        tree.modules.push(Module {
            name: name.to_owned(),
            file: format!("{}{file}", self.prefix),
            parent,
            children: BTreeMap::new(),
            items: Vec::new(),
            paths: collector.paths,
            imported: BTreeMap::new(),
        });
        for item in &items {
            if let Item::Mod(module) = item {
                let child = module.ident.unraw().to_string();
                let below = format!("{folder}{child}/");
                let (file, items) = if let Some((_, items)) = &module.content {
                    (file.to_owned(), items.clone())
                } else {
                    let nested = format!("{below}mod.rs");
                    let file = if self.sources.contains_key(&nested) { nested } else { format!("{folder}{child}.rs") };
                    let items = self.items(&file);
                    (file, items)
                };
                self.add(tree, Some(index), &format!("{name}::{child}"), &file, &below, items);
            }
        }
        tree.modules[index].items = items;
    }
}

/// Gathers the paths of a module's own items, without those of modules inside it.
#[derive(Default)]
struct Collector {
    paths: Vec<NamedPath>,
}

impl Collector {
    fn add(&mut self, segments: Vec<String>, line: usize) {
        if segments.len() > 1 {
            self.paths.push(NamedPath { segments, binds: None, line, public: false });
        }
    }

    fn add_use(&mut self, tree: &UseTree, mut leading: Vec<String>, public: bool) {
        let (name, binds) = match tree {
            UseTree::Path(path) => {
                leading.push(path.ident.unraw().to_string());
                return self.add_use(&path.tree, leading, public);
            }
            UseTree::Group(group) => return group.items.iter().for_each(|t| self.add_use(t, leading.clone(), public)),
            UseTree::Name(name) => (&name.ident, &name.ident),
            UseTree::Rename(rename) => (&rename.ident, &rename.rename),
            UseTree::Glob(glob) => {
                leading.push("*".to_owned());
                let line = glob.star_token.spans[0].start().line;
                return self.paths.push(NamedPath { segments: leading, binds: None, line, public });
            }
        };
        let line = name.span().start().line;
        let mut binds = binds.unraw().to_string();
        if name == "self" {
            if binds == "self" {
                binds = leading.last().cloned().unwrap_or_default();
            }
        } else {
            leading.push(name.unraw().to_string());
        }
        self.paths.push(NamedPath { segments: leading, binds: Some(binds), line, public });
    }

    /// Finds the paths in a macro's arguments, which are not parsed.
    fn add_tokens(&mut self, tokens: TokenStream) {
        let (mut segments, mut line, mut colons): (Vec<String>, usize, usize) = (Vec::new(), 0, 0);
        for token in tokens {
            match token {
                TokenTree::Ident(ident) => {
                    if colons != 2 {
                        self.add(std::mem::take(&mut segments), line);
                        line = ident.span().start().line;
                    }
                    segments.push(Ident::unraw(&ident).to_string());
                    colons = 0;
                }
                TokenTree::Punct(punct) if punct.as_char() == ':' => colons += 1,
                other => {
                    self.add(std::mem::take(&mut segments), line);
                    colons = 0;
                    if let TokenTree::Group(group) = other {
                        self.add_tokens(group.stream());
                    }
                }
            }
        }
        self.add(segments, line);
    }
}

impl<'ast> Visit<'ast> for Collector {
    fn visit_item(&mut self, item: &'ast Item) {
        if !matches!(item, Item::Mod(_)) && !is_test(attributes(item)) {
            visit::visit_item(self, item);
        }
    }

    fn visit_impl_item(&mut self, item: &'ast ImplItem) {
        if !matches!(item, ImplItem::Fn(function) if is_test(&function.attrs)) {
            visit::visit_impl_item(self, item);
        }
    }

    fn visit_item_use(&mut self, item: &'ast ItemUse) {
        if item.leading_colon.is_none() {
            self.add_use(&item.tree, Vec::new(), matches!(item.vis, Visibility::Public(_)));
        }
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        if path.leading_colon.is_none() {
            let segments: Vec<String> = path.segments.iter().map(|s| s.ident.unraw().to_string()).collect();
            self.add(segments, path.segments[0].ident.span().start().line);
        }
        visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, invocation: &'ast Macro) {
        if !invocation.path.is_ident("macro_rules") {
            self.visit_path(&invocation.path);
            self.add_tokens(invocation.tokens.clone());
        }
    }

    fn visit_visibility(&mut self, _: &'ast Visibility) {}

    fn visit_attribute(&mut self, _: &'ast Attribute) {}
}

/// Whether an item exists in tests only.
pub fn is_test(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|attribute| match &attribute.meta {
        Meta::List(list) if list.path.is_ident("cfg") => {
            let condition = list.tokens.to_string();
            condition == "test" || condition.starts_with("all (test ,") || condition.starts_with("all(test,")
        }
        _ => false,
    })
}

fn attributes(item: &Item) -> &[Attribute] {
    match item {
        Item::Const(i) => &i.attrs,
        Item::Enum(i) => &i.attrs,
        Item::Fn(i) => &i.attrs,
        Item::Impl(i) => &i.attrs,
        Item::Macro(i) => &i.attrs,
        Item::Mod(i) => &i.attrs,
        Item::Static(i) => &i.attrs,
        Item::Struct(i) => &i.attrs,
        Item::Trait(i) => &i.attrs,
        Item::Type(i) => &i.attrs,
        Item::Use(i) => &i.attrs,
        _ => &[],
    }
}
