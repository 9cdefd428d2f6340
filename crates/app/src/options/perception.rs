//! Which model of the eye, with which parameters?

use crate::report::output::{WrongUsage, read_text};
use anyhow::{Context, anyhow, bail};
use clap::{Args, ValueEnum};
use foveal_core::perception::measured::acuity::MeasuredAcuity;
use foveal_core::perception::measured::sensitivity::MeasuredSensitivity;
use foveal_core::perception::parameters::{Model, NAMED, Parameters};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

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
    /// The contrast sensitivity of the eye, in the place of the model's: CSV with cpd (cycles per
    /// degree), ecc_deg and sensitivity (1 / threshold contrast), every frequency at every
    /// eccentricity.
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) sensitivity: Option<PathBuf>,
    /// Other values for parameters of the model, as --set lambda=2.5 omega=8; put it after the
    /// positional arguments.
    #[arg(long, value_name = "NAME=VALUE", value_parser = parse_setting, num_args = 1..)]
    #[arg(long_help = listed_settings())]
    set: Vec<(String, f64)>,
}

impl PerceptionOptions {
    /// The parameters of an eye, whose acuity may have been measured.
    pub(crate) fn parameters(&self, acuity: Option<MeasuredAcuity>) -> anyhow::Result<Parameters> {
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
        Ok(Parameters {
            acuity,
            sensitivity: self
                .sensitivity
                .as_deref()
                .map(read_sensitivity)
                .transpose()?,
            ..parameters
        })
    }
}

/// Reads what an eye resolves.
pub(crate) fn read_acuity(path: &Path) -> anyhow::Result<MeasuredAcuity> {
    let text = read_text(path, "a table of acuity")?;
    MeasuredAcuity::parse(&text).with_context(|| path.display().to_string())
}

/// Reads what contrast an eye sees.
pub(crate) fn read_sensitivity(path: &Path) -> anyhow::Result<MeasuredSensitivity> {
    let text = read_text(path, "a table of sensitivity")?;
    MeasuredSensitivity::parse(&text).with_context(|| path.display().to_string())
}

/// The help of `--set`: every parameter with its unit, range and default.
fn listed_settings() -> String {
    let mut text = "Other values for parameters of the model, as --set lambda=2.5 omega=8; put it \
                    after the positional arguments:\n"
        .to_owned();
    for named in NAMED {
        let (name, what, range) = (named.name, named.what, named.range);
        let default = Parameters::default().get(name).unwrap_or_default();
        let of_paper = Parameters::of(Model::Paper).get(name).unwrap_or_default();
        let default = match default == of_paper {
            true => default.to_string(),
            false => format!("{default}; paper {of_paper}"),
        };
        let unit = match named.unit {
            "" => String::new(),
            unit => format!(" {unit}"),
        };
        let [least, most] = range;
        let _ = write!(
            text,
            "\n{name}: {what}; {least} to {most}{unit} (default: {default})"
        );
    }
    text
}

fn parse_setting(text: &str) -> anyhow::Result<(String, f64)> {
    let (name, value) = text
        .split_once('=')
        .context("expected NAME=VALUE as lambda=2.5")?;
    let value = value.trim().parse();
    let value = value.map_err(|_| anyhow!("expected a number after {}=", name.trim()))?;
    Ok((name.trim().to_owned(), value))
}
