//! How good does one picture or video look, compared with another, to an eye with a given gaze?

mod args;
mod conditions;
mod engine;
mod folder;
mod frames;
mod heat;
mod of_source;
mod pack_frames;
mod pair;
mod pairs;
mod picture;
mod report;

use crate::report::output::{self, WrongUsage};
use anyhow::bail;
pub(crate) use args::ScoreArgs;
pub(crate) use conditions::{DeviceName, ModeName};
pub(crate) use engine::{Companions, Engine};
use foveal_eval::score::Display;
pub(crate) use frames::is_pack;
pub(crate) use pack_frames::{LastGaze, display_of_view, picture_of};
use pair::Judged;
pub(crate) use picture::{check_source, from_image, is_png, read_picture};
pub(crate) use report::{ScoreConditions, ScoreReport};

pub(crate) fn run(args: &ScoreArgs) -> anyhow::Result<()> {
    if args.list_displays {
        let list = report::displays();
        return output::result(args.json, &list.0, &list.1);
    }
    if args.cite {
        let cited = report::citation();
        return output::result(args.json, &cited.0, &cited.1);
    }
    if let (Some(pairs), Some(out)) = (&args.pairs, &args.out) {
        let scored = pairs::score_pairs(args, pairs, out)?;
        return output::result(args.json, &scored, &scored.text());
    }
    let (Some(reference), Some(test)) = (&args.reference, &args.test) else {
        bail!(WrongUsage("give REFERENCE and TEST".to_owned()));
    };
    if args.out.is_some() {
        let text = "--out is for a table of pairs; give --pairs FILE.csv, or leave it";
        bail!(WrongUsage(text.to_owned()));
    }
    if let Some(heat) = &args.heat {
        output::spare_inputs(heat, [reference.as_path(), test.as_path()])?;
        heat::check_name(heat)?;
    }
    match args.score(reference, test)? {
        Judged::ByEye(report) => output::result(args.json, &*report, &report.text()),
        Judged::By(single) => output::result(args.json, &single, &single.text()),
    }
}

/// A named display, or the one that a file describes, as an `option` chose it.
pub(crate) fn display_named(option: &str, choice: &str) -> anyhow::Result<Display> {
    conditions::display_of(option, Some(choice), None)
}
