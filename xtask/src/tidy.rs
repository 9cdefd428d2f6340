//! Which rules of the repository does a commit of this tree break?

mod architecture;
mod circles;
mod citation;
mod crates;
mod documents;
mod finding;
mod foreign;
mod kinds;
mod known;
mod modules;
mod names;
mod one_loop;
mod papers;
mod purity;
mod reading;
mod rooms;
mod sentences;
mod sizes;
mod source;
mod tables;
mod tree;
mod words;

use std::collections::BTreeMap;

use crate::measured;
use crate::steps::{Outcome, repository_root, workspace_metadata};
use finding::Finding;
use known::Breach;
use source::graph::Graph;
use source::modules::{Modules, crates_with_sources};
use tree::Tree;

/// Prints each finding of the tree as `file:line: message`; fails when there is one.
pub(crate) fn run() -> Outcome {
    let tree = Tree::of(&repository_root())?;
    let mut findings = crates::check(&workspace_metadata()?, &tree);
    findings.extend(check_files(&tree));
    findings.extend(words::check(&tree));
    let stale = measured::stale_tables().into_iter();
    findings.extend(stale.map(|(file, message)| Finding::new(&file, 1, message)));
    let (faults, breaches) = breaches(&tree);
    findings.extend(faults);
    let list = tree.text(known::LIST).unwrap_or_default();
    findings.extend(known::unlisted(list, &breaches));
    findings.sort();
    findings.dedup();
    for finding in &findings {
        println!("{finding}");
    }
    if findings.is_empty() {
        println!("tidy: nothing found in {} files", tree.len());
        return Ok(());
    }
    Err(format!(
        "tidy: {} found, each with what to do above",
        findings.len()
    ))
}

/// Prints every breach that is listed, or would have to be, under the line that lists it.
pub(crate) fn tell_known() -> Outcome {
    let (_, breaches) = breaches(&Tree::of(&repository_root())?);
    for breach in breaches {
        println!("{}", breach.told());
    }
    Ok(())
}

/// Files that are no Rust, and what breaks a rule that has a list of known breaches.
fn breaches(tree: &Tree) -> (Vec<Finding>, Vec<Breach>) {
    let names = crates_with_sources(tree).into_iter();
    let crates: BTreeMap<&str, Modules> = names
        .map(|name| (name, Modules::of_crate(tree, name)))
        .collect();
    let faults = crates.values().flat_map(|modules| modules.faults.clone());
    let mut breaches = rooms::check(tree);
    let xtask = Modules::of_sources(tree, "xtask/src");
    let graphs = crates.values().chain([&xtask]).map(Graph::of);
    let graphs = graphs.chain([Graph::of_typescript(tree, "web/src/")]);
    breaches.extend(graphs.flat_map(|graph| circles::check(&graph)));
    breaches.extend(names::check(&crates));
    breaches.extend(kinds::check(tree, &crates));
    breaches.extend(one_loop::check(tree));
    breaches.extend(architecture::check(tree));
    for (path, file) in tree.files() {
        let text = file.text.as_deref().unwrap_or_default();
        breaches.extend(tables::check(path, text));
    }
    breaches.sort();
    (faults.collect(), breaches)
}

fn check_files(tree: &Tree) -> Vec<Finding> {
    let mut findings = Vec::new();
    for (path, file) in tree.files() {
        findings.extend(foreign::check_size(path, file.bytes));
        let Some(text) = &file.text else { continue };
        findings.extend(foreign::check_paths(path, text));
        findings.extend(sizes::check(path, text));
        findings.extend(modules::check(path, text));
        findings.extend(purity::check(path, text));
        findings.extend(reading::check(path, text));
        findings.extend(documents::check(path, text, tree));
        findings.extend(sentences::check(path, text));
        findings.extend(papers::check(path, text, tree));
        findings.extend(citation::check(path, text, tree));
    }
    findings
}
