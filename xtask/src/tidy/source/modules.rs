//! Which file of a crate defines what a path names?

use std::collections::{BTreeMap, BTreeSet};

use super::file::{Scope, crate_of};
use super::syntax::scopes_of;
use crate::tidy::{Finding, Tree};

/// The modules of one crate that ship, as the compiler finds them from its roots on.
#[derive(Default)]
pub(crate) struct Modules {
    all: Vec<Module>,
    /// Files that are no Rust.
    pub(crate) faults: Vec<Finding>,
}

/// A file, or a module with braces in one.
pub(crate) struct Module {
    pub(crate) file: String,
    pub(crate) scope: Scope,
    parent: Option<usize>,
    children: BTreeMap<String, usize>,
}

/// What a path leads to: a module, or the name of an item and the module that defines it.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Target {
    Module(usize),
    Item(usize, String),
}

/// Folders of `crates/` that have sources.
pub(crate) fn crates_with_sources(tree: &Tree) -> BTreeSet<&str> {
    tree.files()
        .filter_map(|(path, _)| crate_of(path))
        .collect()
}

impl Modules {
    /// The modules of `crates/NAME`. Those called `tests` are left out.
    pub(crate) fn of_crate(tree: &Tree, name: &str) -> Self {
        Self::of_sources(tree, &format!("crates/{name}/src"))
    }

    /// The same of a crate whose sources lie there.
    pub(crate) fn of_sources(tree: &Tree, folder: &str) -> Self {
        let mut modules = Self::default();
        for root in ["lib", "main"] {
            let file = format!("{folder}/{root}.rs");
            modules.read(tree, &file, None);
        }
        modules
    }

    pub(crate) fn iter(&self) -> impl Iterator<Item = (usize, &Module)> {
        self.all.iter().enumerate()
    }

    pub(crate) fn file(&self, module: usize) -> &str {
        &self.all[module].file
    }

    /// Where `path`, written in the module `at`, is defined, and under which name. A module itself
    /// is not defined anywhere.
    pub(crate) fn definitions(&self, at: usize, path: &[String]) -> Vec<(&Module, String)> {
        let targets = self.resolved(at, path, &mut BTreeSet::new());
        let items = targets.into_iter().filter_map(|target| match target {
            Target::Item(module, name) => Some((&self.all[module], name)),
            Target::Module(_) => None,
        });
        items.collect()
    }

    fn read(&mut self, tree: &Tree, file: &str, parent: Option<usize>) -> Option<usize> {
        let scopes = match scopes_of(tree.text(file)?) {
            Ok(scopes) => scopes,
            Err(e) => {
                let line = e.span().start().line;
                self.faults.push(Finding::new(file, line, e.to_string()));
                return None;
            }
        };
        let first = self.all.len();
        for scope in scopes {
            let above = scope.inside.split_last();
            let parent = above.map_or(parent, |(_, outer)| {
                self.all[first..]
                    .iter()
                    .rposition(|module| module.scope.inside == outer)
                    .map(|nth| first + nth)
            });
            if let (Some((name, _)), Some(parent)) = (above, parent) {
                let own = self.all.len();
                self.all[parent].children.insert(name.clone(), own);
            }
            self.all.push(Module {
                file: file.to_owned(),
                scope,
                parent,
                children: BTreeMap::new(),
            });
        }
        for module in first..self.all.len() {
            self.read_children(tree, module);
        }
        Some(first)
    }

    fn read_children(&mut self, tree: &Tree, module: usize) {
        let Module { file, scope, .. } = &self.all[module];
        let mut folder = folder_of_children(file).to_owned();
        for name in &scope.inside {
            folder = format!("{folder}/{name}");
        }
        for name in scope.children.clone() {
            if name == "tests" {
                continue;
            }
            let beside = format!("{folder}/{name}.rs");
            let within = format!("{folder}/{name}/mod.rs");
            let file = if tree.has(&beside) { beside } else { within };
            if let Some(child) = self.read(tree, &file, Some(module)) {
                self.all[module].children.insert(name, child);
            }
        }
    }

    /// `seen` holds what is being looked for already: imports may go in circles.
    fn resolved(
        &self,
        at: usize,
        path: &[String],
        seen: &mut BTreeSet<(usize, String)>,
    ) -> BTreeSet<Target> {
        let Some((first, rest)) = path.split_first() else {
            return BTreeSet::from([Target::Module(at)]);
        };
        let mut targets = match first.as_str() {
            "crate" => BTreeSet::from([Target::Module(self.root(at))]),
            "self" => BTreeSet::from([Target::Module(at)]),
            "super" => BTreeSet::from_iter(self.all[at].parent.map(Target::Module)),
            name => self.named(at, name, seen),
        };
        for name in rest {
            let modules = targets.iter().filter_map(|target| match target {
                Target::Module(module) => Some(*module),
                Target::Item(..) => None,
            });
            let modules: Vec<usize> = modules.collect();
            if modules.is_empty() {
                break;
            }
            targets = BTreeSet::new();
            for module in modules {
                targets.extend(match (name.as_str(), self.all[module].parent) {
                    ("super", parent) => BTreeSet::from_iter(parent.map(Target::Module)),
                    (name, _) => self.named(module, name, seen),
                });
            }
        }
        targets
    }

    fn root(&self, mut at: usize) -> usize {
        while let Some(parent) = self.all[at].parent {
            at = parent;
        }
        at
    }

    /// What `name` is in a module: what it declares and imports, else what a `*` brings.
    fn named(
        &self,
        at: usize,
        name: &str,
        seen: &mut BTreeSet<(usize, String)>,
    ) -> BTreeSet<Target> {
        let mut targets = BTreeSet::new();
        if !seen.insert((at, name.to_owned())) {
            return targets;
        }
        let module = &self.all[at];
        targets.extend(module.children.get(name).copied().map(Target::Module));
        if module.scope.items.iter().any(|item| item.name == name) {
            targets.insert(Target::Item(at, name.to_owned()));
        }
        let imports = module.scope.imports.iter();
        for import in imports.filter(|import| import.name.as_deref() == Some(name)) {
            targets.extend(self.resolved(at, &import.path, seen));
        }
        if targets.is_empty() {
            for import in module.scope.imports.iter().filter(|i| i.name.is_none()) {
                let mut path = import.path.clone();
                path.push(name.to_owned());
                targets.extend(self.resolved(at, &path, seen));
            }
        }
        seen.remove(&(at, name.to_owned()));
        targets
    }
}

/// Where the files of a file's modules lie.
fn folder_of_children(file: &str) -> &str {
    let (folder, name) = file.rsplit_once('/').unwrap_or(("", file));
    match name {
        "mod.rs" | "lib.rs" | "main.rs" => folder,
        _ => file.strip_suffix(".rs").unwrap_or(file),
    }
}
