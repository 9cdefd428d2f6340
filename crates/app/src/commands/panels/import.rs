//! How does another program's file become a rig file?

use super::rig_args::read_noting;
use crate::options::policy::parse_size;
use crate::report::fault::without_numbers;
use crate::report::output::{self, WrongUsage};
use anyhow::{Context, bail};
use clap::Args;
use foveal_core::units::counted;
use foveal_scene::read::is_scene_file;
use foveal_scene::rig::{NotedRig, Projector, is_foreign, rig_of_projectors, write_rig};
use serde::Serialize;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

#[derive(Clone, Debug, Args)]
pub(crate) struct ImportArgs {
    /// MPCDI, zipped or not, or warp mesh; or, with --projector, a wall as a mesh: .obj, .ply,
    /// .stl, .gltf or .glb.
    file: PathBuf,
    /// Rig file to write; maps of bent panels are written next to it.
    #[arg(long, value_name = "RIG.toml")]
    out: PathBuf,
    /// A projector that lights the wall, as "left at=-1,2,4 look=10,-5,0 pixels=1920x1080
    /// throw=1.5"; may be given several times. Its name first; then, in the wall's units and axes
    /// (right, up, behind), at=X,Y,Z: its lens; look=YAW,PITCH,ROLL: degrees to the right, up and
    /// clockwise (0,0,0 if not given); pixels=WxH; throw=N: distance over the picture's width, or
    /// fov=DEGREES: its horizontal field of view; shift=H,V: lens shift to the right and up, in
    /// widths and heights of the picture (0,0 if not given); blend=DEGREES over which it fades into
    /// others (0 if not given).
    #[arg(long, value_name = "PROJECTOR", value_parser = parse_projector)]
    projector: Vec<Projector>,
    /// Where the eye is that sees the wall, in its units, or the points in space of an MPCDI of
    /// profile a3 or sl, in metres: to the right of, above and behind their origin (default: there;
    /// of an MPCDI where that is the ideal eye point).
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_place, allow_hyphen_values = true)]
    eye_at: Option<[f64; 3]>,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

/// Reads `X,Y,Z`.
fn parse_place(text: &str) -> anyhow::Result<[f64; 3]> {
    let expected = "expected metres to the right, up and behind, as 0,1.7,2.5";
    numbers(text, 1e6).context(expected)
}

/// So many finite numbers, none larger than `most`.
fn numbers<const N: usize>(text: &str, most: f64) -> Option<[f64; N]> {
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|it| it.trim().parse()).collect();
    let found = numbers.ok().and_then(|all| <[f64; N]>::try_from(all).ok());
    found.filter(|all| all.iter().all(|it| it.abs() <= most))
}

/// Reads `ID key=value ..`.
fn parse_projector(text: &str) -> anyhow::Result<Projector> {
    const FORM: &str = "expected a name and at=X,Y,Z, pixels=WxH, and throw=N or fov=DEGREES, as \
                        \"left at=-1,2,4 look=10,-5,0 pixels=1920x1080 throw=1.5\"";
    let mut words = text.split_whitespace();
    let id = words.next().filter(|it| !it.contains('=')).context(FORM)?;
    let (mut at, mut pixels, mut half_width) = (None, None, None);
    let (mut look, mut shift, mut blend) = ([0.0; 3], [0.0; 2], 0.0);
    let mut known: Vec<&str> = Vec::new();
    for word in words {
        let (key, value) = word.split_once('=').context(FORM)?;
        let wrong = || {
            let short: String = word.chars().take(60).collect();
            format!("{short:?} is not understood; {FORM}")
        };
        if known.contains(&key) {
            bail!("{key} is given twice; leave one");
        }
        let one = |range: RangeInclusive<f64>| {
            let found = numbers(value, 1e6).map(|[it]| it);
            found.filter(|it| range.contains(it)).with_context(wrong)
        };
        match key {
            "at" => at = Some(numbers(value, 1e6).with_context(wrong)?),
            "look" => look = numbers(value, 3600.0).with_context(wrong)?,
            "pixels" => pixels = Some(parse_size(value).with_context(wrong)?),
            "throw" => half_width = Some(0.5 / one(0.05..=1000.0)?),
            "fov" => half_width = Some((one(0.1..=170.0)?.to_radians() / 2.0).tan()),
            "shift" => shift = numbers(value, 10.0).with_context(wrong)?,
            "blend" => blend = one(0.0..=90.0)?,
            _ => bail!(wrong()),
        }
        known.push(key);
    }
    if known.contains(&"throw") && known.contains(&"fov") {
        bail!("throw and fov both give the width of the picture; leave one out");
    }
    let (Some(at), Some(pixels), Some(half_width)) = (at, pixels, half_width) else {
        bail!(FORM);
    };
    let half_height = half_width * f64::from(pixels[1]) / f64::from(pixels[0]);
    let [right, up] = [half_width * 2.0 * shift[0], half_height * 2.0 * shift[1]];
    Ok(Projector {
        id: id.to_owned(),
        at,
        yaw_pitch_roll: look,
        pixels,
        tangents: [
            half_width - right,
            half_width + right,
            half_height + up,
            half_height - up,
        ],
        blend,
    })
}

#[derive(Debug, Serialize)]
struct ImportReport {
    panels: usize,
    /// That were written.
    files: Vec<String>,
    /// Which parts of the file were mended or left out.
    remarks: Vec<String>,
}

impl ImportArgs {
    /// Refuses files that are no rig of another program, and walls without what lights them.
    fn check(&self) -> anyhow::Result<()> {
        let name = self.file.display();
        match (is_scene_file(&self.file), self.projector.is_empty()) {
            (true, false) => Ok(()),
            (true, true) => bail!(WrongUsage(format!(
                "{name}: is a wall, and nothing says what lights it; give --projector \"ID \
                 at=X,Y,Z pixels=WxH throw=N\" for each projector"
            ))),
            (false, false) => bail!(WrongUsage(format!(
                "--projector lights a wall, and {name} is not one by its ending; give one that \
                 ends in .obj, .ply, .stl, .gltf or .glb, or leave --projector out"
            ))),
            (false, true) if is_foreign(&self.file) => Ok(()),
            (false, true) if self.file.is_dir() => bail!(WrongUsage(format!(
                "{name}: is a folder; give the file in it that describes the panels: an .mpcdi, \
                 or an .xml with its maps next to it, or a warp mesh in .data, .mesh, .txt or .csv"
            ))),
            (false, true) => bail!(WrongUsage(format!(
                "{name}: is not an MPCDI, warp mesh or wall by its ending; give one that ends in \
                 .mpcdi, .xml, .data, .mesh, .txt or .csv, or a wall in .obj, .ply, .stl, .gltf or \
                 .glb with --projector"
            ))),
        }
    }

    fn read(&self) -> anyhow::Result<NotedRig> {
        match is_scene_file(&self.file) {
            true => {
                let eye = self.eye_at.unwrap_or_default();
                Ok(rig_of_projectors(&self.file, &self.projector, eye)?)
            }
            false => read_noting(&self.file, self.eye_at),
        }
    }
}

pub(crate) fn run(args: &ImportArgs) -> anyhow::Result<()> {
    args.check()?;
    let wrong = |what: String| anyhow::Error::from(WrongUsage(what));
    let ending = args.out.extension().and_then(|it| it.to_str());
    let stem = args.out.file_stem().and_then(|it| it.to_str());
    let (Some(stem), Some("toml")) = (stem, ending) else {
        let name = args.out.display();
        return Err(wrong(format!(
            "--out {name}: is not the name of a rig file; end it in .toml"
        )));
    };
    if args.out.exists() {
        let name = args.out.display();
        return Err(wrong(format!(
            "--out {name}: something is there already; choose another name, or move it away"
        )));
    }
    let NotedRig { rig, notes } = args.read()?;
    let files = write_rig(&rig, stem).map_err(anyhow::Error::msg)?;
    let folder = args.out.parent().unwrap_or(Path::new(""));
    if folder != Path::new("") {
        std::fs::create_dir_all(folder)
            .with_context(|| format!("{}: cannot be made a folder", folder.display()))?;
    }
    let mut names = Vec::new();
    // The rig file last: it names the others.
    for (name, bytes) in files.iter().rev() {
        let path = folder.join(name);
        output::write_whole(&path, bytes)?;
        names.insert(0, path.display().to_string());
    }
    let report = ImportReport {
        panels: rig.panels.len(),
        files: names,
        remarks: notes.iter().map(|it| without_numbers(it)).collect(),
    };
    let mut text = format!("{}\n", counted(report.panels, "panel"));
    for file in &report.files {
        text.push_str(file);
        text.push('\n');
    }
    output::result(args.json, &report, &text)
}
