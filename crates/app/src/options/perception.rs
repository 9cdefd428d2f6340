//! Which model of the eye, with which parameters?

use crate::report::output::WrongUsage;
use anyhow::{Context, anyhow, bail};
use clap::{Args, ValueEnum};
use foveal_core::perception::parameters::{Model, Parameters};

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ModelName {
    /// Chen et al. 2022 as printed.
    Paper,
    /// Corrected.
    Default,
}

impl ModelName {
    pub(crate) fn model(self) -> Model {
        match self {
            Self::Paper => Model::Paper,
            Self::Default => Model::Default,
        }
    }
}

/// What is worth anything to an eye.
#[derive(Clone, Debug, Args)]
pub(crate) struct PerceptionOptions {
    /// Which equations say what a step is worth.
    #[arg(long, value_enum, default_value = "default")]
    model: ModelName,
    /// Other values for parameters of the model, as --set lambda=2.5 omega=8; what else the command
    /// takes without a name comes before.
    #[arg(long, value_name = "NAME=VALUE", value_parser = parse_setting, num_args = 1..)]
    set: Vec<(String, f64)>,
}

impl PerceptionOptions {
    pub(crate) fn parameters(&self) -> anyhow::Result<Parameters> {
        let mut parameters = Parameters::of(self.model.model());
        for (name, value) in &self.set {
            let set = parameters.set(name, *value);
            set.map_err(|error| WrongUsage(format!("--set: {error}")))?;
        }
        if parameters.black >= parameters.peak {
            bail!(WrongUsage(format!(
                "--set: black is {} and peak {}; black must be less",
                parameters.black, parameters.peak
            )));
        }
        Ok(parameters)
    }
}

fn parse_setting(text: &str) -> anyhow::Result<(String, f64)> {
    let (name, value) = text
        .split_once('=')
        .context("expected NAME=VALUE as lambda=2.5")?;
    let value = value.trim().parse();
    let value = value.map_err(|_| anyhow!("expected a number after {}=", name.trim()))?;
    Ok((name.trim().to_owned(), value))
}
