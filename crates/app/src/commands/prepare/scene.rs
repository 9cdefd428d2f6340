//! How does a person turn 3D files into a pack?

use crate::commands::info::scene_info::SceneInfo;
use crate::report::output::{self, WrongUsage, out_of_range};
use crate::run::other_input::{no_scene, refuse_pack};
use crate::run::pack_place::{if_taken, pack_at, refuse_name_of_another};
use anyhow::{Context, bail};
use clap::{Args, ValueEnum};
use foveal_core::content::scene::description::{GRID_BITS, KIND, SceneDescription, SceneSource};
use foveal_core::pack::{Identity, MAX_DESCRIPTION_BYTES};
use foveal_core::units::counted;
use foveal_media::pack::name_claim::NameClaim;
use foveal_media::pack::scene_file::{SceneFile, write_scene};
use foveal_scene::build::{BuildOptions, Built, build};
use foveal_scene::read::{KEPT, ReadOptions, Up, read, texels};
use foveal_scene::source::{Repairs, SourceScene};
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Entries of a page of the index, and rows of a page of the table.
const PAGE: u32 = 64;
/// What a description takes at most for where its tables lie, in bytes.
const BYTES_OF_TABLES: u64 = 1024;
/// Bits of a place that is not asked for otherwise.
const BITS: u8 = 14;
/// Bytes of all remarks that a pack keeps.
const MOST_REMARKED: usize = 1 << 16;

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum UpName {
    Y,
    Z,
}

#[derive(Clone, Debug, Args)]
pub(crate) struct PrepareSceneArgs {
    /// Files of one scene: .glb, .gltf, .obj, .ply, .stl, .las or .laz (.copc.laz too), or a scene
    /// file .toml that says where such files stand.
    #[arg(required = true)]
    inputs: Vec<PathBuf>,
    /// The pack to write, with the ending .foveal.
    #[arg(long, value_name = "PACK")]
    out: Option<PathBuf>,
    /// Which axis points up in the files (default: z in STL, LAS and LAZ, y elsewhere).
    #[arg(long, value_enum)]
    up: Option<UpName>,
    /// Bits of a vertex's place along the largest side of its object, 10 to 16.
    #[arg(long, value_name = "N", default_value_t = BITS)]
    bits: u8,
    /// Keep every texel of textures as it is, in PNG in place of JPEG.
    #[arg(long)]
    exact: bool,
    /// Open files that lie outside the folder of the file that names them, such as
    /// ../textures/wood.png.
    #[arg(long)]
    allow_outside: bool,
    /// Threads (default: all cores); the pack is the same for any number.
    #[arg(long, value_name = "N")]
    jobs: Option<usize>,
    /// Refuse files of which anything would be mended or left out, and name it.
    #[arg(long)]
    strict: bool,
    /// Replace another pack at --out, which stays until the new one is whole.
    #[arg(long)]
    force: bool,
    /// Say what it would take in time and disk, and write nothing.
    #[arg(long)]
    dry_run: bool,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

/// What a dry run says.
#[derive(Debug, Serialize)]
struct Estimate {
    dry_run: bool,
    objects: usize,
    triangles: u64,
    points: u64,
    #[serde(rename = "prepare_s")]
    seconds: f64,
    bytes: u64,
    repairs: std::collections::BTreeMap<String, u64>,
}

/// What `--json` prints.
#[derive(Debug, Serialize)]
struct Done<'a> {
    #[serde(flatten)]
    scene: &'a SceneInfo,
    /// Whether an earlier run had made it, so that nothing was written.
    already_there: bool,
}

pub(crate) fn run(args: &PrepareSceneArgs) -> anyhow::Result<()> {
    if !GRID_BITS.contains(&args.bits) {
        bail!(out_of_range("--bits", args.bits, "10 to 16"));
    }
    let jobs = output::jobs(args.jobs)?;
    let begun = Instant::now();
    if args.dry_run {
        let source = args.read()?;
        args.refuse_mends(&source.repairs, &source.remarks)?;
        return args.estimate(&source, begun, jobs);
    }
    let out = args
        .out
        .as_deref()
        .ok_or_else(|| WrongUsage("--out PACK is missing: where should the pack go?".to_owned()))?;
    args.refuse_to_overwrite_inputs(out)?;
    let there = pack_at(out)?;
    refuse_name_of_another(out)?;
    // Before the work: a second preparation is refused at once.
    let claim = match there.is_none() || args.force {
        true => Some(NameClaim::of(out, if_taken(there.as_ref()))?),
        false => None,
    };
    let source = args.read()?;
    args.refuse_mends(&source.repairs, &source.remarks)?;
    let identity = args.identity(&source);
    let Some(claim) = claim else {
        return args.say_what_is_there(out, &identity);
    };
    args.write(source, (claim, identity), jobs)?;
    let seconds = begun.elapsed().as_secs_f64();
    let mut scene = SceneInfo::new(&SceneFile::open(out)?);
    scene.seconds = Some(seconds);
    scene.peak_memory_bytes = peak_memory_bytes();
    let text = format!("{}: {seconds:.1} s\n{}", out.display(), scene.text());
    args.say_done(&scene, false, &text)
}

/// Refuses a 3D file that cannot be read.
pub(crate) fn check_scene(input: &Path) -> anyhow::Result<()> {
    PrepareSceneArgs::usual(input, input).read().map(|_| ())
}

/// Makes a pack of a 3D file with the usual settings at `out`, in the place of any other pack
/// there, unless that was made in the same way.
pub(crate) fn prepare_usual(input: &Path, out: &Path) -> anyhow::Result<()> {
    let args = PrepareSceneArgs::usual(input, out);
    let source = args.read()?;
    let identity = args.identity(&source);
    if is_there(out, &identity).is_some() {
        output::say(&format!("{}: already prepared, used again", out.display()));
        return Ok(());
    }
    output::say(&format!("{}: is being prepared", input.display()));
    let claim = NameClaim::of(out, if_taken(pack_at(out)?.as_ref()))?;
    args.write(source, (claim, identity), output::jobs(None)?)
}

/// The pack at `out`, where it is whole and was made in the same way.
fn is_there(out: &Path, identity: &Identity) -> Option<SceneFile> {
    let file = SceneFile::open(out).ok()?;
    let made = &file.pack().description().identity;
    let is_same = made.difference(identity).is_none() && file.verify(|_, _| ()).is_empty();
    is_same.then_some(file)
}

/// A pack whose description is too long could not be opened.
fn refuse_too_long(description: &SceneDescription) -> anyhow::Result<()> {
    let (description, _) = description.clone().parted();
    let bytes = serde_json::to_vec(&description)?.len() as u64 + BYTES_OF_TABLES;
    let most = u64::from(MAX_DESCRIPTION_BYTES);
    if bytes > most {
        bail!(
            "the names of {} take {}, and a pack's description holds {}: give fewer, or shorter \
             ones; nothing was written",
            counted(description.source.names.len(), "file"),
            output::size(bytes),
            output::size(most),
        );
    }
    Ok(())
}

/// Remarks as a pack keeps them: no more than its description has room for.
fn kept_remarks(remarks: &[String]) -> Vec<String> {
    let mut left = MOST_REMARKED;
    let fits = |remark: &&String| {
        left = left.saturating_sub(remark.len());
        left > 0
    };
    let mut kept: Vec<String> = remarks.iter().take_while(fits).cloned().collect();
    let more = remarks.len() - kept.len();
    if more > 0 {
        kept.push(format!("{} more", counted(more, "remark")));
    }
    kept
}

impl PrepareSceneArgs {
    /// What is usual for one file.
    fn usual(input: &Path, out: &Path) -> Self {
        Self {
            inputs: vec![input.to_owned()],
            out: Some(out.to_owned()),
            up: None,
            bits: BITS,
            exact: false,
            allow_outside: false,
            jobs: None,
            strict: false,
            force: true,
            dry_run: false,
            json: false,
        }
    }

    /// Builds a scene that was read and writes its pack.
    fn write(
        &self,
        source: SourceScene,
        (claim, identity): (NameClaim, Identity),
        jobs: usize,
    ) -> anyhow::Result<()> {
        source.remarks.iter().for_each(|remark| output::say(remark));
        let built = self.build(&source, jobs)?;
        built.remarks.iter().for_each(|remark| output::say(remark));
        self.refuse_mends(&built.repairs, &source.remarks)?;
        let description = self.description(&source, &built, identity);
        refuse_too_long(&description)?;
        drop(source);
        let units = built.units.into_iter().map(|unit| (unit.row, unit.payload));
        write_scene(claim, description, units)?;
        Ok(())
    }

    fn read(&self) -> anyhow::Result<SourceScene> {
        let inputs: Vec<&Path> = self.inputs.iter().map(PathBuf::as_path).collect();
        let options = ReadOptions {
            up: self.up.map(|up| match up {
                UpName::Y => Up::Y,
                UpName::Z => Up::Z,
            }),
            allow_outside: self.allow_outside,
        };
        inputs.iter().try_for_each(|input| refuse_pack(input))?;
        read(&inputs, &options).map_err(|error| no_scene(&inputs, error.into()))
    }

    fn build(&self, source: &SourceScene, jobs: usize) -> anyhow::Result<Built> {
        let options = BuildOptions {
            bits: self.bits,
            jobs,
            exact: self.exact,
            ..BuildOptions::default()
        };
        let bar = output::bar(Some(1), output::Counting::Frames);
        let built = build(source, &options, &|done, all| {
            bar.set_length(all.max(1));
            bar.set_position(done);
        });
        bar.finish_and_clear();
        built.with_context(|| self.names())
    }

    fn names(&self) -> String {
        let names = self.inputs.iter().map(|input| input.display().to_string());
        names.collect::<Vec<_>>().join(", ")
    }

    /// With `--strict`, refuses what was mended or left out.
    fn refuse_mends(&self, repairs: &Repairs, remarks: &[String]) -> anyhow::Result<()> {
        let mends = repairs.iter().filter(|it| !KEPT.contains(&it.0.as_str()));
        let told = |(name, times): (&String, &u64)| format!("{}: {times}", name.replace('_', " "));
        let counts: Vec<String> = mends.map(told).collect();
        if !self.strict || counts.is_empty() {
            return Ok(());
        }
        let remarks: String = remarks.iter().map(|it| format!("\n{it}")).collect();
        bail!(
            "{}: --strict refuses what would be mended, {}; mend it where it was made, or prepare \
             without --strict{remarks}",
            self.names(),
            counts.join(", "),
        )
    }

    fn description(
        &self,
        source: &SourceScene,
        built: &Built,
        identity: Identity,
    ) -> SceneDescription {
        let mut units = vec![0; usize::from(built.levels)];
        for unit in &built.units {
            units[usize::from(unit.level)] += 1;
        }
        let names = self.inputs.iter().filter_map(|input| input.file_name());
        SceneDescription {
            kind: KIND.to_owned(),
            needs: vec![KIND.to_owned()],
            generator: identity.program.clone(),
            source: SceneSource {
                names: names.map(|it| it.to_string_lossy().into_owned()).collect(),
                bytes: source.bytes,
            },
            objects: built.objects.clone(),
            textures: built.textures.clone(),
            parts: built.parts.clone(),
            joined: built.joined,
            units,
            page: PAGE,
            look: source.look(),
            identity,
            remarks: kept_remarks(&[&source.remarks[..], &built.remarks].concat()),
            repairs: built.repairs.clone(),
            tables: Vec::new(),
        }
    }

    /// What must be the same for a pack to be the one that is asked for.
    fn identity(&self, source: &SourceScene) -> Identity {
        let names = self.inputs.iter().filter_map(|input| input.file_name());
        let names: Vec<String> = names.map(|it| it.to_string_lossy().into_owned()).collect();
        Identity {
            program: format!("foveal {}", env!("CARGO_PKG_VERSION")),
            input: format!("{} {}", names.join(" "), source.hashes.join(" ")),
            settings: format!(
                "bits {}, up {:?}, exact {}, page {PAGE}",
                self.bits, self.up, self.exact
            ),
        }
    }

    fn say_what_is_there(&self, out: &Path, identity: &Identity) -> anyhow::Result<()> {
        let Some(file) = is_there(out, identity) else {
            bail!(WrongUsage(format!(
                "--out {}: another pack is there; choose another name, or give --force to replace \
                 it",
                out.display()
            )));
        };
        let about = file.pack().description();
        self.refuse_mends(&about.repairs, &about.remarks)?;
        let text = format!(
            "{}: already exists, made from the same files with the same options; nothing was \
             written",
            out.display()
        );
        self.say_done(&SceneInfo::new(&file), true, &text)
    }

    fn say_done(&self, scene: &SceneInfo, already_there: bool, text: &str) -> anyhow::Result<()> {
        let done = Done {
            scene,
            already_there,
        };
        output::result(self.json, &done, text)
    }

    /// Writing the pack over one of its own sources would destroy that.
    fn refuse_to_overwrite_inputs(&self, out: &Path) -> anyhow::Result<()> {
        let Ok(place) = out.canonicalize() else {
            return Ok(());
        };
        let is_it = |input: &&PathBuf| input.canonicalize().is_ok_and(|input| input == place);
        if let Some(input) = self.inputs.iter().find(is_it) {
            bail!(WrongUsage(format!(
                "--out {}: it is the input {} itself; choose another name",
                out.display(),
                input.display()
            )));
        }
        Ok(())
    }

    /// Says what the work would take, by building a part of it.
    fn estimate(&self, source: &SourceScene, begun: Instant, jobs: usize) -> anyhow::Result<()> {
        let read_s = begun.elapsed().as_secs_f64();
        let placed = source.objects.iter().map(|object| object.mesh);
        let meshes = placed.map(|mesh| source.meshes[mesh].triangles.len() as u64);
        let triangles: u64 = meshes.sum();
        let points = source.clouds.iter().map(|it| it.places.len() as u64);
        let points: u64 = points.sum();
        let work = triangles as f64 * BUILD_S + points as f64 * BUILD_S_OF_POINT;
        let texels = texels(source) as f64;
        let work = work + texels * BUILD_S_OF_TEXEL;
        let seconds = read_s + work / (jobs.min(4) as f64).max(1.0);
        let of_texel = match self.exact {
            true => BYTES_OF_EXACT_TEXEL,
            false => BYTES_OF_TEXEL,
        };
        let bytes = triangles as f64 * BYTES_OF_TRIANGLE
            + points as f64 * BYTES_OF_POINT
            + texels * of_texel;
        let estimate = Estimate {
            dry_run: true,
            objects: source.objects.len() + source.clouds.len(),
            triangles,
            points,
            seconds,
            bytes: bytes as u64,
            repairs: source.repairs.clone(),
        };
        let text = format!(
            "{}, {}, {}: about {:.0} s and {} (nothing written)",
            counted(estimate.objects, "object"),
            counted(triangles, "triangle"),
            counted(points, "point"),
            seconds,
            output::size(estimate.bytes),
        );
        output::result(self.json, &estimate, &text)
    }
}

/// What building takes a triangle on one thread, in seconds, and what is written for it, in bytes:
/// as measured on a scan of 871,414 triangles.
const BUILD_S: f64 = 6e-6;
const BYTES_OF_TRIANGLE: f64 = 6.0;
/// The same of a point with colours.
const BUILD_S_OF_POINT: f64 = 2e-6;
const BYTES_OF_POINT: f64 = 6.0;
/// The same of a texel with all its coarser levels: of photographs some half of that, of noise
/// twice as much.
const BUILD_S_OF_TEXEL: f64 = 2e-7;
const BYTES_OF_TEXEL: f64 = 0.6;
const BYTES_OF_EXACT_TEXEL: f64 = 2.5;

/// The most memory that this program had so far, where the system reports it.
pub(crate) fn peak_memory_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status
        .lines()
        .find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kib: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kib * 1024)
}
