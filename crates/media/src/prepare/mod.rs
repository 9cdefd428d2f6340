//! How does a video become a pack?
//!
//! Frames are read, turned into the faces of the surface, halved level by level and cut into
//! tiles; when a level's group is full its tiles are coded, each by a fresh encoder, on as many
//! threads as asked for. A pack is the same bytes for any number of them.

mod cutter;
pub(crate) mod error;
mod findings;
mod identity;
mod notes;
mod plan;
pub mod pyramid;
pub(crate) mod pyramid_light;
mod pyramid_taps;
mod rates;
pub(crate) mod remarks;
pub(crate) mod settings;
mod sound;
#[cfg(test)]
mod speed_tests;
mod sphere_levels;

pub use crate::surround::found::Surround;
pub use error::PrepareError;
pub use findings::ANIMATIONS;
pub use identity::pack_identity_of;
pub use plan::PreparationPlan;
pub use rates::samples::{SampleWindow, coded, sample_windows};
pub use rates::tile_rates::TileLook;
pub use remarks::Remarks;
pub use settings::{PrepareSettings, ProjectionChoice, Quality, SpherePack, StereoChoice};

use crate::MediaError;
use crate::pack::name_claim::NameClaim;
use crate::pack::pack_file::PackFileError;
use crate::pack::pack_writer::{Inspected, PackWriter};
use crate::parallel::in_parallel;
use crate::read::input::VideoInput;
use crate::read::options::{ReadOptions, TimedPicture};
use crate::tiles::encode::encode_group;
use crate::tiles::encode_settings::EncodeSettings;
use cutter::Cutter;
use findings::time_notes::length_of;
use findings::{ReadThrough, findings};
use foveal_core::content::video::bytes::description::MAX_FRAMES;
use foveal_core::content::video::bytes::description::{Description, Loss};
use foveal_core::content::video::bytes::frame_times::FRAME_TIMES;
use foveal_core::content::video::bytes::sound::SOUND;
use foveal_core::content::video::calibration::Calibration;
use foveal_core::content::video::grid::tile_grid::Tile;
use foveal_core::pack::order::hilbert_distance;
use foveal_core::pack::{JournalStep, SideTable};
use foveal_core::perception::measures::cues::Cues;
use foveal_core::view::picture::Picture;
use identity::{FileStamp, identity_of};
use notes::Notes;
use notes::decoded_groups::{DecodedGroups, ShownGroup};
use rates::tile_rates::rate_of_tile;
use std::path::Path;
use std::sync::Mutex;
use std::sync::PoisonError;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};

/// Frames that are read ahead while others are coded: a group of the finest level, so that reading
/// the next one never leaves a core idle, where that many fit into memory for it.
const READ_AHEAD: u64 = 8;
const READ_AHEAD_BYTES: u64 = 512 << 20;
const LEAST_READ_AHEAD: u64 = 2;

/// How far a preparation is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// Frames read and coded so far.
    pub frames: u32,
    /// Frames in all, as far as the container says.
    pub of: Option<u64>,
    /// Bytes of coded tiles so far.
    pub bytes: u64,
}

/// Where coded tiles go: a pack, or nowhere when only cost is asked for.
trait Sink {
    fn push(&mut self, coded: &CodedGroup) -> Result<(), PackFileError>;

    /// All groups up to a frame were pushed.
    fn commit(&mut self, step: JournalStep) -> Result<(), PackFileError>;
}

impl Sink for PackWriter {
    fn push(&mut self, coded: &CodedGroup) -> Result<(), PackFileError> {
        Self::push(self, coded.tile, coded.first_frame, &coded.access_units)
    }

    fn commit(&mut self, step: JournalStep) -> Result<(), PackFileError> {
        Self::commit(self, step)
    }
}

/// Counts bytes and keeps none.
struct Nowhere;

impl Sink for Nowhere {
    fn push(&mut self, _: &CodedGroup) -> Result<(), PackFileError> {
        Ok(())
    }

    fn commit(&mut self, _: JournalStep) -> Result<(), PackFileError> {
        Ok(())
    }
}

/// One tile over one group, coded.
struct CodedGroup {
    tile: Tile,
    first_frame: u32,
    access_units: Vec<Vec<u8>>,
}

/// What came of one group of one tile.
struct CodedTile {
    access_units: Vec<Vec<u8>>,
    cues: Option<Cues>,
    shown: ShownGroup,
}

/// What came of a preparation.
#[derive(Clone, Debug, PartialEq)]
pub struct Prepared {
    /// The final description.
    pub description: Description,
    /// Bytes of the pack.
    pub bytes: u64,
    /// What a person should know that no plan could say.
    pub warnings: Vec<String>,
}

/// Prepares `input` as planned and writes it to `out`.
///
/// On any error nothing is left under the name `out` (or what was there stays).
pub fn prepare(
    input: &Path,
    out: &Path,
    plan: &PreparationPlan,
    progress: &mut dyn FnMut(Progress),
) -> Result<Prepared, PrepareError> {
    let description = described(input, plan)?;
    let writer = PackWriter::create(out, &description)?;
    let mut tell = |event: Event| {
        if let Event::Progress(done) = event {
            progress(done);
        }
    };
    write_pack(input, plan, description, (writer, &[]), &mut tell)
}

/// What a resumable preparation reports while it works.
#[derive(Clone, Debug, PartialEq)]
pub enum Event {
    /// It goes on where an earlier one was stopped, or starts over although there was one.
    Begins(String),
    /// How far it is.
    Progress(Progress),
}

/// Whom a preparation that can be gone on with turns to.
pub trait Witness {
    /// Receives what it reports.
    fn tell(&mut self, event: Event);

    /// What preparing lost, for the pack to record, or none: the pack is whole, and lies under this
    /// name until it is given its own.
    fn loss_of(&mut self, _pack: &Path) -> Option<Loss> {
        None
    }

    /// What a judge finds of the same pack, for it to hold, or none.
    fn calibration_of(&mut self, _pack: &Path) -> Option<Calibration> {
        None
    }
}

impl<F: FnMut(Event)> Witness for F {
    fn tell(&mut self, event: Event) {
        self(event);
    }
}

/// As [`prepare`], to a name that was claimed; however it is stopped, the same call goes on after
/// the last group of all levels that was whole, and ends with the same bytes.
///
/// Until the pack is whole, `OUT.partial` and `OUT.partial.journal` lie next to it. What was begun
/// from another or a changed input, with other settings or by another version is not gone on with,
/// nor is anything where `go_on` is false; an event says so.
pub fn prepare_resumable(
    input: &Path,
    claim: NameClaim,
    plan: &PreparationPlan,
    go_on: bool,
    witness: &mut dyn Witness,
) -> Result<Prepared, PrepareError> {
    let identity = identity_of(input, plan)?;
    let description = described(input, plan)?;
    let begun = PackWriter::resume(claim, &description, identity, go_on)?;
    if let Some(note) = begun.note {
        witness.tell(Event::Begins(note));
    }
    let start = (begun.writer, &begun.steps[..]);
    write_pack(input, plan, description, start, witness)
}

/// The plan's description, and how the pack is made.
fn described(input: &Path, plan: &PreparationPlan) -> Result<Description, PrepareError> {
    Ok(Description {
        identity: Some(pack_identity_of(input, plan)?),
        ..plan.description.clone()
    })
}

/// Codes what follows the steps that the writer took up, and finishes the pack.
fn write_pack(
    input: &Path,
    plan: &PreparationPlan,
    mut description: Description,
    (mut writer, steps): (PackWriter, &[JournalStep]),
    witness: &mut dyn Witness,
) -> Result<Prepared, PrepareError> {
    let mut coder = Coder::new(plan);
    for step in steps {
        coder.take_up(step);
    }
    let before = FileStamp::of(input);
    let mut progress = |progress| witness.tell(Event::Progress(progress));
    let coded = code(input, &mut coder, None, &mut writer, &mut progress);
    let Coder { times, notes, .. } = coder;
    let fps = plan.description.fps();
    let sound = match coded.is_ok() && plan.has_sound {
        true => sound::sound_of(input, length_of(&times, fps), plan.reading),
        false => sound::SoundFound::default(),
    };
    if FileStamp::of(input) != before {
        return Err(PrepareError::Changed(input.display().to_string()));
    }
    let found = findings(plan, &times, &coded?, &sound);
    let sound = sound.table;
    if plan.reading.strict {
        found.refuse(input)?;
    }
    found.tell_in(&mut description);
    description.frames = times.len() as u32;
    let mut tables = vec![SideTable {
        name: FRAME_TIMES.to_owned(),
        version: 1,
        bytes: times.iter().flat_map(|time| time.to_le_bytes()).collect(),
    }];
    tables.extend(notes.into_tables());
    tables.extend(sound.map(|sound| SideTable {
        name: SOUND.to_owned(),
        version: 1,
        bytes: sound.write(),
    }));
    let mut inspect = |pack: &Path| Inspected {
        loss: witness.loss_of(pack),
        calibration: witness.calibration_of(pack),
    };
    let (description, ended) = writer.finish(description, &tables, &mut inspect)?;
    let mut warnings = found.warnings;
    warnings.extend(ended.left_out.map(|why| {
        format!(
            "the pack is whole, but its calibration cannot be written ({why}); free some space, \
             then add it with foveal calibrate"
        )
    }));
    Ok(Prepared {
        description,
        bytes: ended.bytes,
        warnings,
    })
}

/// Codes the first `frames` frames of `input` and keeps nothing: what [`prepare`] would cost.
/// Returns how many frames there were and the bytes of their tiles.
pub fn rehearse(
    input: &Path,
    plan: &PreparationPlan,
    frames: u32,
) -> Result<(u32, u64), PrepareError> {
    let mut bytes = 0;
    let mut note = |progress: Progress| bytes = progress.bytes;
    let mut coder = Coder::new(plan);
    code(input, &mut coder, Some(frames), &mut Nowhere, &mut note)?;
    Ok((coder.frames, bytes))
}

/// Reads, cuts and codes the frames that `coder` has not taken up.
fn code(
    input: &Path,
    coder: &mut Coder<'_>,
    most_frames: Option<u32>,
    sink: &mut dyn Sink,
    progress: &mut dyn FnMut(Progress),
) -> Result<ReadThrough, PrepareError> {
    let plan = coder.plan;
    let most = most_frames.or(plan.most_frames).unwrap_or(MAX_FRAMES);
    let known = coder.times.clone();
    let of = plan.frames.map(|of| of.min(u64::from(most)));
    let mut progress = |frames, bytes| progress(Progress { frames, of, bytes });
    let (send, receive) = sync_channel(read_ahead(plan.description.source.size));
    let reading = plan.reading;
    let through = std::thread::scope(|scope| {
        let reading = move || read_frames((input, reading), &known, &send, most);
        let reader = std::thread::Builder::new().spawn_scoped(scope, reading);
        let reader = reader.map_err(|source| MediaError::Thread {
            what: "reading",
            source,
        })?;
        let coded = code_frames(&receive, coder, sink, &mut progress);
        // The reader stops when its receiver is gone.
        drop(receive);
        let read = reader
            .join()
            .unwrap_or_else(|panic| std::panic::resume_unwind(panic));
        coded.and(read)
    })?;
    // What is not whole is coded only when all frames before it could be read.
    coder.flush()?;
    coder.write(sink)?;
    progress(coder.frames, coder.bytes);
    if coder.times.is_empty() {
        return Err(PrepareError::NoFrames(input.display().to_string()));
    }
    Ok(through)
}

/// Frames of 4:2:0 of this size that are read ahead.
fn read_ahead([width, height]: [u32; 2]) -> usize {
    let frame_bytes = (u64::from(width) * u64::from(height) * 3 / 2).max(1);
    (READ_AHEAD_BYTES / frame_bytes).clamp(LEAST_READ_AHEAD, READ_AHEAD) as usize
}

/// Hands over the frames after those whose times are known already.
fn read_frames(
    (input, reading): (&Path, ReadOptions),
    known: &[i64],
    send: &SyncSender<TimedPicture>,
    most: u32,
) -> Result<ReadThrough, PrepareError> {
    let changed = || PrepareError::Changed(input.display().to_string());
    let mut video = VideoInput::open_with(input, reading)?;
    let mut is_at_end = false;
    for number in 0..most as usize {
        let frame = video.next_frame()?;
        match (known.get(number), frame) {
            (Some(time), Some(frame)) if frame.time_ns == *time => {}
            (Some(_), _) => return Err(changed()),
            (None, Some(frame)) => {
                if send.send(frame).is_err() {
                    break;
                }
            }
            (None, None) => {
                is_at_end = true;
                break;
            }
        }
    }
    Ok(ReadThrough {
        mended: video.mended(),
        last_ns: video.last_ns().filter(|_| is_at_end),
        begins_ns: video.first_stamp_ns(),
    })
}

fn code_frames(
    frames: &Receiver<TimedPicture>,
    coder: &mut Coder<'_>,
    sink: &mut dyn Sink,
    progress: &mut dyn FnMut(u32, u64),
) -> Result<(), PrepareError> {
    for frame in frames {
        coder.push(&frame)?;
        if coder.frames.is_multiple_of(coder.period()) {
            coder.write(sink)?;
            sink.commit(coder.step())?;
        }
        progress(coder.frames, coder.bytes);
    }
    Ok(())
}

/// Collects frames into groups and codes the groups.
struct Coder<'a> {
    plan: &'a PreparationPlan,
    cutter: Cutter,
    /// Of each level, by rank of the tile, the pictures of the group that is being filled.
    waiting: Vec<Vec<Vec<Picture>>>,
    coded: Vec<CodedGroup>,
    shown: DecodedGroups,
    notes: Notes,
    times: Vec<i64>,
    /// Times that [`Self::step`] has returned.
    told: usize,
    frames: u32,
    bytes: u64,
}

impl<'a> Coder<'a> {
    fn new(plan: &'a PreparationPlan) -> Self {
        let (grid, about) = (plan.grid, &plan.description);
        let empty = |level| vec![Vec::new(); grid.tiles_in_level(level) as usize];
        Self {
            plan,
            cutter: Cutter::new(plan),
            waiting: (0..grid.levels).map(empty).collect(),
            coded: Vec::new(),
            shown: DecodedGroups::new(&grid, about.colour, about.codec, &about.groups),
            notes: Notes::new(&grid, about.colour),
            times: Vec::new(),
            told: 0,
            frames: 0,
            bytes: 0,
        }
    }

    /// Takes up what an earlier run coded.
    fn take_up(&mut self, step: &JournalStep) {
        self.frames = step.frames;
        self.times.extend(&step.times);
        self.told = self.times.len();
        self.notes.take_up(&step.rows);
        self.bytes += step
            .chunks
            .iter()
            .map(|chunk| u64::from(chunk.bytes))
            .sum::<u64>();
    }

    /// What came since the last call, but for the chunks.
    fn step(&mut self) -> JournalStep {
        let times = self.times[self.told..].to_vec();
        self.told = self.times.len();
        JournalStep {
            frames: self.frames,
            times,
            rows: self.notes.new_rows(),
            chunks: Vec::new(),
        }
    }

    /// Frames after which all levels begin a new group.
    fn period(&self) -> u32 {
        self.plan.description.groups.last().copied().unwrap_or(1)
    }

    fn push(&mut self, frame: &TimedPicture) -> Result<(), PrepareError> {
        let tiles = self.cutter.tiles_of(&frame.picture);
        self.times.push(frame.time_ns);
        for (waiting, tiles) in self.waiting.iter_mut().zip(tiles) {
            for (group, tile) in waiting.iter_mut().zip(tiles) {
                group.push(tile);
            }
        }
        self.frames += 1;
        let groups = self.plan.description.groups.iter();
        let is_full = |(level, length): (u8, &u32)| {
            let is_full = self.frames.is_multiple_of(*length);
            is_full.then_some(level)
        };
        let full: Vec<u8> = (0..).zip(groups).filter_map(is_full).collect();
        self.code_levels(&full)
    }

    fn flush(&mut self) -> Result<(), PrepareError> {
        let all: Vec<u8> = (0..self.plan.grid.levels).collect();
        self.code_levels(&all)
    }

    /// Codes what waits of these levels, finest first, as one piece of work: between levels no
    /// thread waits for the others. Then measures what the finer ones among them add.
    fn code_levels(&mut self, levels: &[u8]) -> Result<(), PrepareError> {
        let mut tiles = Vec::new();
        for level in levels {
            let waiting = &mut self.waiting[usize::from(*level)];
            let full = (0..).zip(waiting).filter(|(_, group)| !group.is_empty());
            tiles.extend(full.map(|(rank, group)| {
                let group = std::mem::take(group);
                (*level, rank, group.len() as u32, Mutex::new(group))
            }));
        }
        let coded = in_parallel(self.plan.jobs, tiles.len(), |k| {
            let (level, _, _, group) = &tiles[k];
            let mut group = group.lock().unwrap_or_else(PoisonError::into_inner);
            self.code_tile(*level, std::mem::take(&mut *group))
        });
        for ((level, rank, length, _), tile) in tiles.into_iter().zip(coded) {
            let CodedTile {
                access_units,
                cues,
                shown,
            } = tile?;
            self.notes.push_cues(cues);
            self.shown.push(level, rank, shown);
            self.bytes += access_units
                .iter()
                .map(|unit| unit.len() as u64 + 4)
                .sum::<u64>();
            self.coded.push(CodedGroup {
                tile: self.plan.grid.tile_at(level, rank),
                first_frame: self.frames - length,
                access_units,
            });
        }
        for level in levels {
            let signatures = self.shown.measured(*level, self.plan.jobs);
            let finer = level.saturating_sub(1);
            self.notes.push_signatures(finer, &signatures);
        }
        Ok(())
    }

    /// Codes one group of one tile, and lets go of its pictures.
    fn code_tile(&self, level: u8, group: Vec<Picture>) -> Result<CodedTile, PrepareError> {
        let access_units = encode_group(&self.settings_of(level, &group), &group)?;
        Ok(CodedTile {
            cues: self.notes.cues(level, &group),
            shown: self.shown.decoded(&access_units, group)?,
            access_units,
        })
    }

    fn settings_of(&self, level: u8, group: &[Picture]) -> EncodeSettings {
        let description = &self.plan.description;
        let mut rate = self.plan.rates[usize::from(level)];
        if description.quality_by_tile {
            rate = rate_of_tile(rate, group, description.colour);
        }
        EncodeSettings {
            codec: description.codec,
            rate,
            frame_rate: description
                .frame_rate
                .map(|n| n.min(i32::MAX as u32) as i32),
            speed: self.plan.speed.at_level(level),
        }
    }

    /// Hands over what is coded in the order of the file: by time, from the coarsest level to the
    /// finest, by face, along the Hilbert curve.
    fn write(&mut self, sink: &mut dyn Sink) -> Result<(), PrepareError> {
        let grid = self.plan.grid;
        self.coded.sort_by_key(|coded| {
            let tile = coded.tile;
            let side = grid.tiles(tile.level).into_iter().fold(1, u32::max);
            let along = hilbert_distance(side, [u32::from(tile.x), u32::from(tile.y)]);
            (
                coded.first_frame,
                std::cmp::Reverse(tile.level),
                tile.face,
                along,
            )
        });
        for coded in self.coded.drain(..) {
            sink.push(&coded)?;
        }
        Ok(())
    }
}
