//! What did the figures come from?

use crate::report::output;
use foveal_core::units::counted;
use serde::Serialize;

/// The machine, for readers who compare figures.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Machine {
    pub(crate) cpu: String,
    pub(crate) cores: usize,
    pub(crate) gpu: String,
}

impl Machine {
    /// This machine, drawing with `gpu`.
    pub(crate) fn here(gpu: String) -> Self {
        let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
        Self {
            cpu: cpu_model(&text).unwrap_or("unknown").to_owned(),
            cores: output::jobs(None).unwrap_or(1),
            gpu,
        }
    }

    pub(crate) fn text(&self) -> String {
        let cores = counted(self.cores, "core");
        format!("CPU {}, {cores}; GPU {}", self.cpu, self.gpu)
    }
}

/// The model in Linux's table of processors.
fn cpu_model(cpuinfo: &str) -> Option<&str> {
    let line = cpuinfo
        .lines()
        .find(|line| line.starts_with("model name"))?;
    line.split_once(':').map(|(_, name)| name.trim())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cpu_model_is_found_where_there_is_one() {
        let text = "processor\t: 0\nmodel name\t: A CPU @ 2 GHz\n";
        assert_eq!(cpu_model(text), Some("A CPU @ 2 GHz"));
        assert_eq!(cpu_model("processor\t: 0\n"), None);
    }
}
