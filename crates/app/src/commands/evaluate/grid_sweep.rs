//! Into how many cells and levels should a video be cut?
//!
//! Kastner 2016, chapter 6: small cells follow the eye more closely and take more decoders.

use crate::commands::demo::machine::Machine;
use crate::commands::evaluate::trial::{Trial, TrialOptions};
use crate::report::output::{self, out_of_range};
use anyhow::bail;
use clap::Args;
use foveal_core::content::video::grid::tile_grid::{Cut, MAX_LEVELS};
use foveal_core::units::counted;
use foveal_media::prepare::{PrepareError, PrepareSettings};
use serde::Serialize;

#[derive(Clone, Debug, Args)]
pub(crate) struct GridSweepArgs {
    #[command(flatten)]
    trial: TrialOptions,
    /// Cells on a side of a face.
    #[arg(long, value_name = "N,..", value_delimiter = ',', default_values_t = [2, 4, 8, 16])]
    grids: Vec<u32>,
    /// Numbers of levels.
    #[arg(long, value_name = "N,..", value_delimiter = ',', default_values_t = [2, 3, 4, 5, 6])]
    levels: Vec<u8>,
    /// Linear ratio between levels, 2 or 4.
    #[arg(long, value_name = "2|4", default_value_t = 2)]
    level_ratio: u32,
}

#[derive(Debug, Serialize)]
struct Report {
    machine: Machine,
    input: String,
    frames: u32,
    cuts: Vec<Row>,
    /// Those that the input is too small for.
    impossible: Vec<Impossible>,
}

#[derive(Debug, Serialize)]
struct Row {
    grid: [u32; 2],
    levels: u8,
    #[serde(flatten)]
    trial: Trial,
}

#[derive(Debug, Serialize)]
struct Impossible {
    grid: [u32; 2],
    levels: u8,
    why: String,
}

pub(super) fn run(args: &GridSweepArgs) -> anyhow::Result<()> {
    let jobs = args.trial.jobs()?;
    if args.grids.contains(&0) {
        bail!(out_of_range("--grids", 0, "1 or more"));
    }
    if let Some(levels) = args
        .levels
        .iter()
        .find(|levels| !(1..=MAX_LEVELS).contains(*levels))
    {
        bail!(out_of_range(
            "--levels",
            levels,
            &format!("1 to {MAX_LEVELS}")
        ));
    }
    let scratch = args.trial.scratch()?;
    let (mut cuts, mut impossible) = (Vec::new(), Vec::new());
    let of = args.grids.len() * args.levels.len();
    for &side in &args.grids {
        for &levels in &args.levels {
            let (grid, number) = ([side; 2], cuts.len() + impossible.len() + 1);
            output::say(&format!(
                "{number} of {of}: {side}x{side} cells, {}",
                counted(levels, "level")
            ));
            match args
                .trial
                .trial(&args.settings(grid, levels, jobs), None, &scratch)
            {
                Ok(trial) => cuts.push(Row {
                    grid,
                    levels,
                    trial,
                }),
                Err(error) => match error.downcast_ref() {
                    Some(PrepareError::Grid(why)) => impossible.push(Impossible {
                        grid,
                        levels,
                        why: why.to_string(),
                    }),
                    _ => return Err(error),
                },
            }
        }
    }
    let report = Report {
        machine: Machine::here("none".to_owned()),
        input: args.trial.input.display().to_string(),
        frames: cuts.first().map_or(0, |row: &Row| row.trial.frames),
        cuts,
        impossible,
    };
    output::result(args.trial.json, &report, &report.text())
}

impl GridSweepArgs {
    fn settings(&self, grid: [u32; 2], levels: u8, jobs: usize) -> PrepareSettings {
        PrepareSettings {
            cut: Some(Cut::Grid(grid)),
            levels: Some(levels),
            ratio: self.level_ratio,
            jobs,
            most_frames: Some(self.trial.frames),
            ..PrepareSettings::default()
        }
    }
}

impl Report {
    fn text(&self) -> String {
        let mut text = format!(
            "{}\n{}, {}\n\n{:>7} {:>6} {:>9} {:>8} {:>8} {:>6} {:>10} {:>9}\n",
            self.machine.text(),
            self.input,
            counted(self.frames, "frame"),
            "grid",
            "levels",
            "pixels",
            "fps",
            "saccade",
            "late",
            "MB",
            "prepare s",
        );
        for Row {
            grid,
            levels,
            trial,
        } in &self.cuts
        {
            text += &format!(
                "{:>7} {levels:>6} {:>7.2} % {:>8.1} {:>8.1} {:>6} {:>10.2} {:>9.1}\n",
                format!("{}x{}", grid[0], grid[1]),
                trial.pixels_share_mean * 100.0,
                trial.foveated_fps_median,
                trial.foveated_saccade_fps_p5,
                trial.late_frames,
                trial.bytes as f64 / 1e6,
                trial.prepare_s,
            );
        }
        for Impossible { grid, levels, why } in &self.impossible {
            text += &format!(
                "{}x{} cells, {}: {why}\n",
                grid[0],
                grid[1],
                counted(levels, "level")
            );
        }
        text
    }
}
