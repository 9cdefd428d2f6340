//! Do the figures in the documents come out when their commands run again?
//!
//! `docs/measured.toml` holds every measured figure with the command that makes it. Tables in
//! documents and plots are written from it, so a figure stands in one place.

mod key;
mod list;
mod plots;
mod repeat;
mod shown;
mod tables;

use std::fs;
use std::path::PathBuf;

use crate::steps::{self, Outcome, repository_root};
use list::{LIST, List, Plot};
use repeat::Workplace;

/// Which runs to repeat.
pub(crate) enum Which<'a> {
    /// Those that `make test` repeats: quick, and no figure of theirs is a time.
    Sample,
    /// Those whose name contains the text.
    Named(&'a str),
}

/// Repeats runs and prints how far each figure has moved. Fails when one has moved too far.
pub(crate) fn repeat(which: &Which) -> Outcome {
    let list = List::of_repository()?;
    let program = match which {
        Which::Sample => steps::built("foveal")?.get_program().into(),
        Which::Named(_) => release_program()?,
    };
    let workplace = Workplace::new(program)?;
    let runs = list.runs.iter().filter(|run| match which {
        Which::Sample => run.sample,
        Which::Named(text) => run.name.contains(text),
    });
    let mut moved = 0;
    let mut repeated = 0;
    for run in runs {
        for figure in workplace.repeat(run, &list)? {
            println!("{figure}");
            repeated += 1;
            moved += usize::from(figure.has_moved());
        }
    }
    println!("measured: {repeated} figures repeated, {moved} of them moved");
    match moved {
        0 => Ok(()),
        _ => Err(format!(
            "{moved} figures of {LIST} did not come out: mend what moved them, or take the new \
             ones with `cargo xtask measured --take NAME` and say why in the commit"
        )),
    }
}

/// Repeats the runs whose name contains `text` and writes what came out into the list.
pub(crate) fn take(text: &str) -> Outcome {
    let mut list = List::of_repository()?;
    let workplace = Workplace::new(release_program()?)?;
    let runs: Vec<usize> = (0..list.runs.len())
        .filter(|run| list.runs[*run].name.contains(text))
        .collect();
    for run in runs {
        let figures = workplace.repeat(&list.runs[run], &list)?;
        for figure in &figures {
            println!("{figure}");
        }
        list.take(figures.iter().map(|it| (it.id.as_str(), it.now)))?;
    }
    write()
}

/// Writes every table of the documents and every plot from the list.
pub(crate) fn write() -> Outcome {
    let list = List::of_repository()?;
    for file in list.documents() {
        let path = repository_root().join(&file);
        let old = fs::read_to_string(&path).map_err(|e| format!("{file}: {e}"))?;
        let new = tables::written(&list, &file, &old)?;
        if new != old {
            fs::write(&path, new).map_err(|e| format!("{file}: {e}"))?;
            println!("measured: {file} written");
        }
    }
    for plot in &list.plots {
        let file = &plot.file;
        let new = plots::drawn(&list, plot).map_err(|e| format!("{file}: {e}"))?;
        let path = repository_root().join(file);
        if fs::read_to_string(&path).ok().as_ref() != Some(&new) {
            fs::write(&path, new).map_err(|e| format!("{file}: {e}"))?;
            println!("measured: {file} written");
        }
    }
    Ok(())
}

/// What is wrong with the list, or where a table or a plot is not what the list makes of it; each
/// with its file.
pub(crate) fn stale_tables() -> Vec<(String, String)> {
    let list = match List::of_repository() {
        Ok(list) => list,
        Err(message) => return vec![(LIST.to_owned(), message)],
    };
    let fault = |file: String| {
        let old = fs::read_to_string(repository_root().join(&file)).unwrap_or_default();
        let message = match tables::written(&list, &file, &old) {
            Ok(new) if new == old => return None,
            Ok(_) => format!("a table is not what {LIST} says: run `cargo xtask measured --write`"),
            Err(message) => message,
        };
        Some((file, message))
    };
    let stale_plot = |plot: &Plot| {
        let old = fs::read_to_string(repository_root().join(&plot.file)).unwrap_or_default();
        let message = match plots::drawn(&list, plot) {
            Ok(new) if new == old => return None,
            Ok(_) => format!("it is not what {LIST} says: run `cargo xtask measured --write`"),
            Err(message) => message,
        };
        Some((plot.file.clone(), message))
    };
    let tables = list.documents().into_iter().filter_map(fault);
    tables
        .chain(list.plots.iter().filter_map(stale_plot))
        .collect()
}

/// The program that FOVEAL names, else as users build it.
fn release_program() -> Result<PathBuf, String> {
    if let Some(program) = std::env::var_os("FOVEAL") {
        return Ok(program.into());
    }
    steps::run(&mut steps::cargo(&["build", "--release", "--quiet"]))?;
    Ok(steps::target_folder()?.join("release").join("foveal"))
}
