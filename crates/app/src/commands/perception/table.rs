//! What does the eye resolve at given eccentricities, and how little contrast does it see?

use crate::options::perception::{ModelName, read_acuity, read_sensitivity};
use crate::report::output::{self, out_of_range};
use anyhow::bail;
use clap::{Args, ValueEnum};
use foveal_core::perception::acuity::{Meridian, acuity_along, watson_spacing};
use foveal_core::perception::parameters::{Model, Parameters};
use foveal_core::units::{Cpd, Radians};
use serde::Serialize;
use std::fmt::Write;
use std::path::PathBuf;

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum MeridianName {
    Temporal,
    /// The lower visual field.
    Superior,
    Nasal,
    /// The upper visual field.
    Inferior,
}

#[derive(Clone, Debug, Args)]
pub(crate) struct TableArgs {
    /// paper: density of both polarities (Watson 2014), Barten as printed. default: one polarity,
    /// and the foveal sensitivity of Mantiuk et al. 2020 to a still pattern.
    #[arg(long, value_enum, default_value = "default")]
    model: ModelName,
    /// Eccentricities in degrees, from 0 to 180.
    #[arg(
        long,
        value_name = "DEG,..",
        value_delimiter = ',',
        allow_hyphen_values = true
    )]
    #[arg(default_value = "0,1,2,5,10,20,40")]
    ecc: Vec<f64>,
    /// Half meridian of one eye, by Watson's names.
    #[arg(long, value_enum, default_value = "temporal")]
    meridian: MeridianName,
    /// Spatial frequencies in cycles per degree, above 0 and at most 1000.
    #[arg(
        long,
        value_name = "CPD,..",
        value_delimiter = ',',
        allow_hyphen_values = true
    )]
    #[arg(default_value = "0.5,1,2,4,8,16,32")]
    cpd: Vec<f64>,
    /// Luminance that the eye is adapted to, in cd/m², 0.001 to 100000.
    #[arg(
        long,
        value_name = "CD/M2",
        default_value_t = 100.0,
        allow_negative_numbers = true
    )]
    luminance: f64,
    /// What the eye resolves, in the place of the model's cells: CSV with ecc_deg and mar_deg or
    /// mar_arcmin, the smallest pixel that can be resolved.
    #[arg(long, value_name = "FILE.csv", conflicts_with = "meridian")]
    acuity: Option<PathBuf>,
    /// The contrast sensitivity, in the place of the model's: CSV with cpd, ecc_deg and
    /// sensitivity.
    #[arg(long, value_name = "FILE.csv", conflicts_with = "luminance")]
    sensitivity: Option<PathBuf>,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Serialize)]
struct Table {
    model: Model,
    acuity: Vec<AcuityRow>,
    csf: Vec<CsfRow>,
}

#[derive(Debug, Serialize)]
struct AcuityRow {
    ecc_deg: f64,
    e_cpd: f64,
    /// Null of an eye whose acuity was measured.
    density_per_deg2: Option<f64>,
    spacing_arcmin: Option<f64>,
}

#[derive(Debug, Serialize)]
struct CsfRow {
    cpd: f64,
    sensitivity: f64,
}

pub(crate) fn run(args: &TableArgs) -> anyhow::Result<()> {
    check("--ecc", &args.ecc, 0.0..=180.0, "0 to 180 degrees")?;
    check(
        "--cpd",
        &args.cpd,
        1e-3..=1000.0,
        "0.001 to 1000 cycles per degree",
    )?;
    let luminance = [args.luminance];
    check(
        "--luminance",
        &luminance,
        1e-3..=1e5,
        "0.001 to 100000 cd/m²",
    )?;
    let table = table(args)?;
    output::result(args.json, &table, &text(&table))
}

fn check(
    option: &str,
    values: &[f64],
    range: std::ops::RangeInclusive<f64>,
    words: &str,
) -> anyhow::Result<()> {
    match values.iter().find(|value| !range.contains(value)) {
        Some(wrong) => bail!(out_of_range(option, wrong, words)),
        None => Ok(()),
    }
}

fn table(args: &TableArgs) -> anyhow::Result<Table> {
    let parameters = Parameters {
        // Thresholds of the laboratory, without the factor for pictures.
        sensitivity_gain: 1.0,
        acuity: args.acuity.as_deref().map(read_acuity).transpose()?,
        sensitivity: args
            .sensitivity
            .as_deref()
            .map(read_sensitivity)
            .transpose()?,
        ..Parameters::of(args.model.model())
    };
    let meridian = match args.meridian {
        MeridianName::Temporal => Meridian::Temporal,
        MeridianName::Superior => Meridian::Superior,
        MeridianName::Nasal => Meridian::Nasal,
        MeridianName::Inferior => Meridian::Inferior,
    };
    let of_cells = |value: f64| parameters.acuity.is_none().then_some(value);
    let acuity = |&ecc_deg: &f64| AcuityRow {
        ecc_deg,
        e_cpd: acuity_along(&parameters.acuity_model(), meridian, ecc_deg).0,
        density_per_deg2: of_cells(meridian.density(ecc_deg)),
        spacing_arcmin: of_cells(60.0 * watson_spacing([ecc_deg, 0.0], meridian, meridian)),
    };
    let csf = |&cpd: &f64| {
        let open = Cpd(f64::INFINITY);
        let seen = parameters.seen(Cpd(cpd), Radians(0.0), open, args.luminance);
        let sensitivity = seen.sustained;
        CsfRow { cpd, sensitivity }
    };
    Ok(Table {
        model: parameters.model,
        acuity: args.ecc.iter().map(acuity).collect(),
        csf: args.cpd.iter().map(csf).collect(),
    })
}

fn text(table: &Table) -> String {
    let mut text = String::from("ecc °   acuity cpd   cells /deg²   spacing '\n");
    for row in &table.acuity {
        let [e, c] = [row.ecc_deg, row.e_cpd];
        let cells = |value: Option<f64>, digits| {
            value.map_or("-".to_owned(), |value| format!("{value:.digits$}"))
        };
        let d = cells(row.density_per_deg2, 1);
        let s = cells(row.spacing_arcmin, 4);
        let _ = writeln!(text, "{e:5.1}   {c:10.4}   {d:>11}   {s:>9}");
    }
    text.push_str("cpd     sensitivity\n");
    for row in &table.csf {
        let _ = writeln!(text, "{:5.1}   {:11.3}", row.cpd, row.sensitivity);
    }
    text
}
