//! Does a logged session select the same again?

use crate::report::output::{self, WrongUsage};
use anyhow::{Context, anyhow, bail};
use clap::Args;
use foveal_core::content::demand::Content;
use foveal_core::content::scene::demand::why_not;
use foveal_core::content::scene::description::KIND;
use foveal_core::content::video::demand::VideoDemand;
use foveal_core::session::log::{SessionFrame, SessionLogPart, sha256_hex};
use foveal_core::session::log_of_parts::SessionLog;
use foveal_core::units::{counted, one_line};
use foveal_core::view::surface::Screen;
use foveal_media::pack::pack_file::PackFile;
use foveal_media::pack::scene_file::SceneFile;
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::sync::Arc;

#[derive(Clone, Debug, Args)]
pub(crate) struct ReplayArgs {
    /// The session.jsonl that simulate wrote, or what view --log did.
    log: PathBuf,
    /// The pack that was played; needed for scenes, and where the policy weighed units of video
    /// (default: the one that the log names, next to the log, a folder above it, or here).
    #[arg(long, value_name = "PACK")]
    pack: Option<PathBuf>,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Serialize)]
struct Replayed {
    same: bool,
    frames: usize,
    differing_frames: usize,
    first_difference: Option<u32>,
    log_sha256: String,
    replay_sha256: String,
}

/// What the parts of a log were chosen on.
fn is_of(log: &SessionLog, is_kind: impl Fn(&SessionLogPart) -> bool) -> bool {
    let alone = |part: &SessionLogPart| part.head.more.is_empty() && is_kind(part);
    log.parts.iter().all(alone)
}

/// The run selected again through the scene that it is of.
fn replay_scene(log: &SessionLog, path: &Path, pack: Option<&Path>) -> anyhow::Result<SessionLog> {
    let name = log.parts.first().map_or("", |part| &part.head.pack);
    let found = || pack_beside(path, name);
    let Some(pack) = pack.map(Path::to_owned).or_else(found) else {
        bail!(WrongUsage(format!(
            "--pack is needed: this run went through a scene; give {}, which is {NOWHERE}",
            one_line(name)
        )));
    };
    let file = SceneFile::open(&pack)?;
    let scene = file.scene();
    for part in &log.parts {
        if part.head.content != scene.head() {
            bail!(
                "{}: has other units than the pack of the log, {}",
                pack.display(),
                one_line(&part.head.pack)
            );
        }
        if let Some(why) = why_not(part.head.policy.policy) {
            bail!(
                "{}: was chosen by {}, which does not choose for scenes: {why}",
                path.display(),
                part.head.policy.policy.name()
            );
        }
    }
    Ok(log.replay(&|_, head, config| Arc::clone(scene).demand(head, config)))
}

/// The run selected again, on its pack where that is needed.
fn replay_video(log: &SessionLog, path: &Path, pack: Option<&Path>) -> anyhow::Result<SessionLog> {
    let Some(weighed) = log.parts.iter().find(|part| part.needs_content()) else {
        return Ok(log.replay(&|_, head, config| Box::new(VideoDemand::of_head(head, config))));
    };
    let found = || pack_beside(path, &weighed.head.pack);
    let Some(pack) = pack.map(Path::to_owned).or_else(found) else {
        bail!(WrongUsage(format!(
            "--pack is needed: this run weighed what is in its tiles; give {}, which is {NOWHERE}",
            one_line(&weighed.head.pack)
        )));
    };
    let file = PackFile::open(&pack)?;
    let name = pack.display();
    let video = file.video(Screen::default())?;
    let has = video.has();
    if !has.signatures {
        bail!("{name}: has no signatures; prepare it again");
    }
    let needs_cues = |part: &SessionLogPart| part.head.policy.needs_cues();
    if log.parts.iter().any(needs_cues) && !has.cues {
        bail!("{name}: has no cues, by which the log chose; prepare it again");
    }
    log.parts
        .iter()
        .try_for_each(|part| check_belongs(part, &file))?;
    Ok(log.replay(&|_, head, config| Arc::clone(&video).demand(head, config)))
}

/// Where a pack was looked for and is not.
const NOWHERE: &str = "not next to the log, a folder above it, or here";

/// The pack that a log names: next to it, a folder above, or where the program was started.
fn pack_beside(log: &Path, name: &str) -> Option<PathBuf> {
    // A name with a folder in it is no name that a log has.
    let name = Path::new(name).file_name().filter(|only| *only == name)?;
    let beside = log.parent()?;
    let above = beside.join("..");
    let places = [beside, &above, Path::new(".")];
    let mut packs = places.into_iter().map(|folder| folder.join(name));
    packs.find(|pack| pack.is_file())
}

/// Refuses a session of another pack.
fn check_belongs(session: &SessionLogPart, file: &PackFile) -> anyhow::Result<()> {
    let name = file.path().display();
    let about = file.pack().description();
    let mut grid = *file.pack().grid();
    let logged = session.head.content.video().copied().unwrap_or(grid);
    // Flat content may have filled another screen.
    grid.surface.tangents = logged.surface.tangents;
    grid.surface.slant = logged.surface.slant;
    if logged != grid {
        bail!(
            "{name}: has other tiles than the pack of the log, {}",
            one_line(&session.head.pack)
        );
    }
    let beyond = |frame: &&SessionFrame| frame.frame >= about.frames;
    if let Some(frame) = session.frames.iter().find(beyond) {
        bail!(
            "{name}: has {}, the log asks for frame {}",
            counted(about.frames, "frame"),
            frame.frame
        );
    }
    Ok(())
}

pub(crate) fn run(args: &ReplayArgs) -> anyhow::Result<()> {
    let name = args.log.display();
    let text = output::read_text(&args.log, "the session.jsonl of a simulate")?;
    let log = SessionLog::parse(&text).with_context(|| name.to_string())?;
    let (path, pack) = (&args.log, args.pack.as_deref());
    let again = if is_of(&log, |part| part.head.content.video().is_some()) {
        replay_video(&log, path, pack)?
    } else if is_of(&log, |part| part.head.content.other(KIND).is_some()) {
        replay_scene(&log, path, pack)?
    } else {
        bail!("{name}: a log of several assets, or of another kind, is replayed by what played it");
    };
    let frames = |log: &SessionLog| -> Vec<SessionFrame> {
        let frames = log.parts.iter().flat_map(|part| &part.frames);
        frames.cloned().collect()
    };
    let (before, after) = (frames(&log), frames(&again));
    let mut differing = before.iter().zip(&after).filter(|(a, b)| a != b).peekable();
    let first_difference = differing.peek().map(|(frame, _)| frame.frame);
    let replayed = Replayed {
        frames: before.len(),
        differing_frames: differing.count(),
        first_difference,
        log_sha256: sha256_hex(text.as_bytes()),
        replay_sha256: sha256_hex(again.write().as_bytes()),
        same: again.write() == text,
    };
    let is_written_otherwise =
        !replayed.same && before == after && log.parts.len() == again.parts.len();
    let text = replayed.text(is_written_otherwise);
    if replayed.same {
        return output::result(args.json, &replayed, &text);
    }
    if is_written_otherwise {
        let error = anyhow!(
            "{name}: the same selection, written otherwise: the log was changed, or another \
             version wrote it; take the log as it was written to compare its text"
        );
        return output::result_that_fails(args.json, &replayed, &text, error);
    }
    let from = first_difference.map_or("its first line".to_owned(), |f| format!("frame {f}"));
    let error = anyhow!(
        "{name}: the replay differs from {from} on: the log was changed, or the program; take the \
         log as it was written, and the program that wrote it"
    );
    output::result_that_fails(args.json, &replayed, &text, error)
}

impl Replayed {
    fn text(&self, is_written_otherwise: bool) -> String {
        let frames = self.frames;
        let verdict = match (self.same, is_written_otherwise) {
            (true, _) if frames == 1 => "replayed: the selection is identical".to_owned(),
            (true, _) => format!("replayed: all {frames} selections are identical"),
            (_, true) => format!(
                "replayed: the selections are identical ({}), but the log is written differently",
                counted(frames, "frame")
            ),
            _ => format!(
                "replayed: {} of {} different",
                counted(self.differing_frames, "selection"),
                if self.differing_frames == 1 {
                    format!("{frames} is")
                } else {
                    format!("{frames} are")
                }
            ),
        };
        format!("{verdict}\nsha256 {}", self.replay_sha256)
    }
}
