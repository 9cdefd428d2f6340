//! What does a command print today, and how far is that from its figures?

use std::cell::RefCell;
use std::collections::BTreeSet;
use std::fmt;
use std::fs;
use std::path::PathBuf;
use std::process::Command;
use std::time::Instant;

use serde_json::Value;

use super::key::number;
use super::list::{Figure, LIST, List, Run, Tolerance};
use crate::steps::{self, repository_root};

/// Where commands run: a folder below `target`, which keeps inputs that were made once.
pub(super) struct Workplace {
    folder: PathBuf,
    program: PathBuf,
    made: RefCell<BTreeSet<String>>,
}

/// A figure that was repeated.
pub(super) struct Repeated {
    pub(super) id: String,
    pub(super) now: f64,
    was: f64,
    tolerance: Tolerance,
}

impl Workplace {
    pub(super) fn new(program: PathBuf) -> Result<Self, String> {
        let folder = steps::target_folder()?.join("measured");
        fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
        let made = RefCell::new(BTreeSet::new());
        Ok(Self {
            folder,
            program,
            made,
        })
    }

    /// Makes what a run reads, runs it and reads its figures.
    pub(super) fn repeat(&self, run: &Run, list: &List) -> Result<Vec<Repeated>, String> {
        if let Some(lacks) = lacks(run) {
            println!("{}: not repeated, as it needs {lacks}", run.name);
            return Ok(Vec::new());
        }
        for input in &run.inputs {
            if self.made.borrow_mut().insert(input.clone()) {
                for command in &list.inputs[input] {
                    self.run(command)?;
                }
            }
        }
        let begun = Instant::now();
        let printed = self.run(&run.command)?;
        let took = begun.elapsed().as_secs_f64();
        println!("{}: {took:.1} s of {:.1} min", run.name, run.minutes);
        let value: Value = serde_json::from_str(&printed)
            .map_err(|e| format!("{} printed no JSON: {e}", run.command))?;
        let figures = run.figures.iter();
        figures
            .map(|figure| Repeated::of(figure, &value))
            .collect::<Result<_, _>>()
            .map_err(|message| format!("{}: {message}", run.name))
    }

    /// Runs a line of a shell in which `foveal` is the program and scripts are the repository's.
    fn run(&self, line: &str) -> Result<String, String> {
        let root = repository_root();
        let foveal = self.program.display();
        let script = format!("foveal() {{ '{foveal}' \"$@\"; }}; {line}");
        let mut command = Command::new("bash");
        command.args(["-euo", "pipefail", "-c", &script]);
        command.current_dir(&self.folder).env("REPOSITORY", root);
        steps::output_of(&mut command).map_err(|message| format!("{line}: {message}"))
    }
}

/// What this machine lacks for a run; `FOVEAL_GPU=1` says that it has a GPU.
fn lacks(run: &Run) -> Option<String> {
    let has = |name: &str| std::env::var_os(name).is_some();
    if run.needs_gpu && !has("FOVEAL_GPU") {
        return Some("a GPU: set FOVEAL_GPU=1 where there is one".to_owned());
    }
    let missing = run.needs.iter().find(|name| !has(name))?;
    Some(format!("the variable {missing}, which {LIST} explains"))
}

impl Repeated {
    fn of(figure: &Figure, value: &Value) -> Result<Self, String> {
        Ok(Self {
            id: figure.id.clone(),
            now: number(value, &figure.key)?,
            was: figure.value,
            tolerance: figure.tolerance,
        })
    }

    /// Whether the figure is further from what the list says than its tolerance.
    pub(super) fn has_moved(&self) -> bool {
        let by = (self.now - self.was).abs();
        match self.tolerance {
            Tolerance::Exact => self.now != self.was,
            Tolerance::By(most) => by > most,
            Tolerance::Share(share) => by > share * self.was.abs(),
            Tolerance::Time => false,
        }
    }
}

impl fmt::Display for Repeated {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let share = match self.was == 0.0 {
            true => String::new(),
            false => format!(", {:+.2} %", (self.now / self.was - 1.0) * 100.0),
        };
        let moved = if self.has_moved() { "  MOVED" } else { "" };
        let (id, now, was) = (&self.id, self.now, self.was);
        write!(f, "  {id}: {now} (was {was}{share}){moved}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn moved(was: f64, now: f64, tolerance: Tolerance) -> bool {
        let id = "a.b".to_owned();
        Repeated {
            id,
            now,
            was,
            tolerance,
        }
        .has_moved()
    }

    #[test]
    fn a_figure_has_moved_when_it_is_beyond_its_tolerance() {
        assert!(moved(3.0, 4.0, Tolerance::Exact) && !moved(3.0, 3.0, Tolerance::Exact));
        assert!(moved(9.5, 9.4, Tolerance::By(0.05)) && !moved(9.5, 9.46, Tolerance::By(0.05)));
        assert!(moved(0.5, 0.52, Tolerance::Share(0.02)));
        assert!(!moved(0.5, 0.505, Tolerance::Share(0.02)));
        assert!(!moved(1.0, 3.0, Tolerance::Time));
    }
}
