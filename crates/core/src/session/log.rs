//! What was selected in a viewer's run, so that it can be selected again?
//!
//! The log is lines of JSON: a head with grid, policy and view, then one line a frame with what
//! selection was given and a hash of what it chose. Replaying needs no clock, and content only
//! where the policy weighed it. Normative: docs/formats/session.md.

use crate::content::demand::{Demand, Record};
use crate::content::head::ContentHead;
use crate::content::policy::PolicyConfig;
use crate::content::unit::AssetId;
use crate::gaze::sample::{GazeSample, HeadPose};
use crate::perception::footprints::Footprints;
use crate::perception::moment::Moment;
use crate::perception::parameters::EyeState;
use crate::selection::scheduler::Scheduler;
use crate::session::recorded::measured;
use crate::units::{Radians, Seconds, one_line};
use crate::view::eye_view::{EyeView, Field};
use crate::view::mounted::MountedPanel;
use crate::view::panel::rig::MOST_PANELS;
use crate::view::surface::Eye;
use glam::DVec3;
use serde::{Deserialize, Serialize};
use serde_json::error::Category;
use thiserror::Error;

/// Version of the log's format.
const VERSION: u32 = 1;
/// Most views, and most assets, after the first of a log that is replayed from outside bytes.
const MOST_MORE: usize = 255;

/// The first line of a log.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SessionHead {
    /// Version of the format.
    pub foveal_session: u32,
    /// Name of the pack, for people.
    pub pack: String,
    /// What was selected on.
    #[serde(rename = "grid")]
    pub content: ContentHead,
    /// By which rule.
    pub policy: PolicyConfig,
    /// Field of view of what showed it.
    pub field: Field,
    /// Its pixels.
    pub size: [u32; 2],
    /// What else showed it at the same time: the other eye of a headset, other panels.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub more_views: Vec<LoggedView>,
    /// The panels that showed it where these turned with the head; field and size are then those of
    /// the first, and there are no other views.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub panels: Vec<MountedPanel>,
    /// The other assets of the scene.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub more: Vec<AssetHead>,
}

/// A view other than the first, as far as it stays the same.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LoggedView {
    /// Its field of view.
    pub field: Field,
    /// Its pixels.
    pub size: [u32; 2],
    /// Whose picture it shows.
    pub eye: Eye,
}

/// Where a view is at one frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LoggedPose {
    /// In metres.
    pub position: [f64; 3],
    /// Yaw, pitch and roll in radians.
    pub turn: HeadPose,
}

/// What the first line of a log records about an asset other than the first.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AssetHead {
    /// Name of the pack, for people.
    pub pack: String,
    /// What was selected on.
    #[serde(rename = "grid")]
    pub content: ContentHead,
}

/// What a head of any version has.
#[derive(Deserialize)]
struct Versioned {
    foveal_session: u32,
}

/// One line of a log: what selection was given and what it chose.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SessionFrame {
    /// Frame of the content.
    pub frame: u32,
    /// Display time.
    pub time_s: Seconds,
    /// Unit direction of the gaze in the content's space.
    pub gaze: [f64; 3],
    /// Whether the eye was seen.
    pub valid: bool,
    /// Spread of the gaze in radians.
    pub spread_rad: Radians,
    /// Yaw, pitch and roll of the first view in radians.
    pub head: HeadPose,
    /// Where that view is, in metres.
    #[serde(default, skip_serializing_if = "is_origin")]
    pub position: [f64; 3],
    /// Where the other views are, as many as the head has.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub more_poses: Vec<LoggedPose>,
    /// What the eye did, as far as the worth of a step depends on it.
    #[serde(default)]
    pub state: EyeState,
    /// Bytes that could be spent, under a policy that spends a budget; without it, no limit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub budget: Option<u64>,
    /// Number of units of each level, finest first.
    #[serde(rename = "tiles")]
    pub per_level: Vec<u32>,
    /// What they show, in samples.
    #[serde(rename = "pixels")]
    pub samples: u64,
    /// SHA-256 of their places.
    pub sha256: String,
    /// How far the picture was behind the sound when this was chosen, where there was sound.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub behind_sound_s: Option<Seconds>,
    /// What parts of the view units would refine, where that was measured: as
    /// [`Footprints::since`] lists what changed since the line before.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub footprints: Option<Vec<u32>>,
    /// What was chosen of the other assets of the scene, in the order of the head.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub more: Vec<AssetFrame>,
}

/// What a line records about an asset other than the first.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AssetFrame {
    /// Frame of the content.
    pub frame: u32,
    /// Number of units of each level, finest first.
    #[serde(rename = "tiles")]
    pub per_level: Vec<u32>,
    /// What they show, in samples.
    #[serde(rename = "pixels")]
    pub samples: u64,
    /// SHA-256 of their places.
    pub sha256: String,
    /// What parts of the view its units would refine, as of the first asset.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub footprints: Option<Vec<u32>>,
}

/// Says what a viewer wants of each asset of a log, by its head, under the policy of a part.
pub type DemandOf<'a> = &'a dyn Fn(AssetId, &ContentHead, &PolicyConfig) -> Box<dyn Demand>;

/// A run, as it was logged.
#[derive(Clone, Debug, PartialEq)]
pub struct SessionLogPart {
    /// Its first line.
    pub head: SessionHead,
    /// Its frames.
    pub frames: Vec<SessionFrame>,
}

/// Why text is no session log.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum SessionError {
    /// Nothing in it.
    #[error("the session log is empty; give the session.jsonl that simulate wrote")]
    Empty,
    /// A line that cannot be read.
    #[error("line {line}: {}", one_line(why))]
    Line {
        /// Line in the file, from 1.
        line: usize,
        /// What is wrong with it.
        why: String,
    },
    /// A log of another version.
    #[error("line {line}, foveal_session: found {found}, expected {VERSION}")]
    Version {
        /// Line in the file, from 1.
        line: usize,
        /// The version.
        found: u32,
    },
}

impl SessionHead {
    /// The head of a new log of what these views show, at least one.
    #[must_use]
    pub fn new(pack: &str, content: ContentHead, policy: PolicyConfig, views: &[EyeView]) -> Self {
        let logged = |view: &EyeView| LoggedView {
            field: view.field,
            size: view.size,
            eye: view.eye,
        };
        let (field, size) = match views.first() {
            Some(view) => (view.field, view.size),
            None => (Field::symmetric([1.0; 2]), [1, 1]),
        };
        Self {
            foveal_session: VERSION,
            pack: pack.to_owned(),
            content,
            policy,
            field,
            size,
            more_views: views.iter().skip(1).map(logged).collect(),
            panels: Vec::new(),
            more: Vec::new(),
        }
    }

    /// The same of panels that turn with the head, where there are any.
    #[must_use]
    pub fn on_panels(self, panels: &[MountedPanel]) -> Self {
        let others = if panels.is_empty() {
            self.more_views
        } else {
            Vec::new()
        };
        Self {
            more_views: others,
            panels: panels.to_vec(),
            ..self
        }
    }

    /// The heads of all assets, in the order of the scene.
    pub fn assets(&self) -> impl Iterator<Item = (AssetId, &ContentHead)> {
        let more = self.more.iter().map(|asset| &asset.content);
        (0..)
            .map(AssetId)
            .zip(core::iter::once(&self.content).chain(more))
    }

    fn check(&self) -> Result<(), SessionError> {
        let wrong = |why: String| Err(SessionError::Line { line: 1, why });
        for (key, more) in [
            ("more_views", self.more_views.len()),
            ("more", self.more.len()),
        ] {
            if more > MOST_MORE {
                return wrong(format!(
                    "{key}: found {more}, at most {MOST_MORE} are replayed"
                ));
            }
        }
        if self.panels.len() > MOST_PANELS {
            let found = self.panels.len();
            return wrong(format!(
                "panels: found {found}, at most {MOST_PANELS} are replayed"
            ));
        }
        if !self.panels.is_empty() && !self.more_views.is_empty() {
            return wrong("more_views: expected none together with panels".to_owned());
        }
        for panel in &self.panels {
            if let Some(fault) = panel.fault() {
                return wrong(format!("panels, {}: {fault}", panel.id));
            }
        }
        for (_, content) in self.assets() {
            if let Err(why) = content.check() {
                return wrong(why);
            }
        }
        let views = self.more_views.iter().map(|view| (view.field, view.size));
        for (field, size) in views.chain([(self.field, self.size)]) {
            if !field.is_open() {
                return wrong("field, tangents: expected tangents between 1e-6 and 1e6".to_owned());
            }
            if size.contains(&0) {
                return wrong("size: expected at least one pixel".to_owned());
            }
        }
        Ok(())
    }
}

impl SessionFrame {
    /// What selection was given at this frame of a run with such a head.
    #[must_use]
    pub fn moment(&self, head: &SessionHead) -> Moment {
        let first = EyeView {
            position: DVec3::from_array(self.position),
            axes: self.head.axes(),
            field: head.field,
            size: head.size,
            eye: Eye::default(),
        };
        let others = head.more_views.iter().zip(&self.more_poses);
        let others = others.map(|(view, pose)| EyeView {
            position: DVec3::from_array(pose.position),
            axes: pose.turn.axes(),
            field: view.field,
            size: view.size,
            eye: view.eye,
        });
        let views = match head.panels.is_empty() {
            true => core::iter::once(first).chain(others).collect(),
            false => MountedPanel::views(&head.panels, &self.head, first.position),
        };
        Moment {
            gaze: GazeSample {
                time: self.time_s,
                received: self.time_s,
                gaze_in_content: DVec3::from_array(self.gaze),
                valid: self.valid,
                spread: self.spread_rad,
                head: None,
            },
            head: self.head,
            state: self.state,
            views,
            behind_sound: self.behind_sound_s,
        }
    }

    /// The line of a frame of a scene of one asset: what selection was given and chose.
    #[must_use]
    pub fn new(frame: u32, moment: &Moment, budget: Option<u64>, record: &Record) -> Self {
        Self::of_scene(&[frame], moment, budget, &[record])
    }

    /// The line of a frame: what selection was given and chose, of each asset.
    ///
    /// # Panics
    /// There is at least one asset, and of each a frame and a record.
    #[must_use]
    pub fn of_scene(
        frames: &[u32],
        moment: &Moment,
        budget: Option<u64>,
        records: &[&Record],
    ) -> Self {
        let more = frames.iter().zip(records).skip(1);
        let more = more.map(|(frame, record)| AssetFrame {
            frame: *frame,
            per_level: record.per_level.clone(),
            samples: record.samples,
            sha256: record.sha256.clone(),
            footprints: None,
        });
        let (frame, record) = (frames[0], records[0]);
        let gaze = &moment.gaze;
        let pose = |view: &EyeView| LoggedPose {
            position: view.position.to_array(),
            turn: HeadPose::of(&view.axes),
        };
        let first = moment.views.first();
        Self {
            frame,
            time_s: gaze.time,
            gaze: gaze.gaze_in_content.to_array(),
            valid: gaze.valid,
            spread_rad: gaze.spread,
            head: moment.head,
            position: first.map_or([0.0; 3], |view| view.position.to_array()),
            more_poses: moment.views.iter().skip(1).map(pose).collect(),
            state: moment.state,
            budget,
            per_level: record.per_level.clone(),
            samples: record.samples,
            sha256: record.sha256.clone(),
            behind_sound_s: moment.behind_sound,
            footprints: None,
            more: more.collect(),
        }
    }

    /// The line of the log.
    #[must_use]
    pub fn write(&self) -> String {
        line_of(self)
    }

    /// The same line in a log of such a head: where panels are follows from the head.
    pub(super) fn under(self, head: &SessionHead) -> Self {
        match head.panels.is_empty() {
            true => self,
            false => Self {
                more_poses: Vec::new(),
                ..self
            },
        }
    }

    /// What changed in the footprints of each asset, in the order of the head.
    pub fn footprints(&self) -> impl Iterator<Item = Option<&[u32]>> {
        let more = self.more.iter().map(|it| it.footprints.as_deref());
        core::iter::once(self.footprints.as_deref()).chain(more)
    }

    /// The same line, telling what changed in the footprints of an asset, by its number.
    pub(super) fn with_footprints(mut self, asset: usize, changes: Vec<u32>) -> Self {
        match asset.checked_sub(1) {
            None => self.footprints = Some(changes),
            Some(more) => self.more[more].footprints = Some(changes),
        }
        self
    }

    fn check(&self, head: &SessionHead, line: usize) -> Result<(), SessionError> {
        let wrong = |why| Err(SessionError::Line { line, why });
        let [found, expected] = [self.more.len(), head.more.len()];
        if found != expected {
            return wrong(format!(
                "more: found {found}, expected {expected} as in the head"
            ));
        }
        let length = DVec3::from_array(self.gaze).length();
        if (length - 1.0).abs() >= 1e-6 {
            return wrong(format!(
                "gaze: found a vector of length {length}, expected 1"
            ));
        }
        let [found, expected] = [self.more_poses.len(), head.more_views.len()];
        if found != expected {
            return wrong(format!(
                "more_poses: found {found}, expected {expected} as in the head"
            ));
        }
        Ok(())
    }
}

/// What is wrong with a line, and what to do, in words for people.
fn why_no_line(line: usize, error: &serde_json::Error) -> String {
    const NEXT: &str = "take the log as it was written";
    let what = if line == 1 {
        "the head of a session log"
    } else {
        "a frame of a session log"
    };
    match error.classify() {
        Category::Syntax => format!("is no JSON, and so not {what}; {NEXT}"),
        Category::Eof | Category::Io => format!("is cut off, and so not {what}; {NEXT}"),
        Category::Data => {
            let text = error.to_string();
            // Lines are parsed one by one, so the parser's own line is always 1.
            let (said, _) = text.rsplit_once(" at line 1 column").unwrap_or((&text, ""));
            let said = said.replace('`', "\"");
            format!("is not {what}: column {}: {said}; {NEXT}", error.column())
        }
    }
}

impl SessionLogPart {
    /// Reads a log; refuses lines that are not what [`Self::write`] writes, naming the line.
    pub fn parse(text: &str) -> Result<Self, SessionError> {
        let mut lines = text.lines().enumerate();
        let Some((_, first)) = lines.next() else {
            return Err(SessionError::Empty);
        };
        let wrong = |line, error: serde_json::Error| SessionError::Line {
            line,
            why: why_no_line(line, &error),
        };
        // What another version has is not known.
        if let Ok(Versioned {
            foveal_session: found,
        }) = serde_json::from_str(first)
            && found != VERSION
        {
            return Err(SessionError::Version { line: 1, found });
        }
        let head: SessionHead = serde_json::from_str(first).map_err(|e| wrong(1, e))?;
        head.check()?;
        let mut frames: Vec<SessionFrame> = Vec::new();
        let mut footprints = vec![Footprints::default(); 1 + head.more.len()];
        for (number, line) in lines {
            let frame: SessionFrame =
                serde_json::from_str(line).map_err(|e| wrong(number + 1, e))?;
            frame.check(&head, number + 1)?;
            for (footprints, changes) in footprints.iter_mut().zip(frame.footprints()) {
                let changes = changes.unwrap_or_default();
                *footprints = footprints
                    .after(changes)
                    .map_err(|why| SessionError::Line {
                        line: number + 1,
                        why: format!("footprints: {why}"),
                    })?;
            }
            frames.push(frame);
        }
        Ok(Self { head, frames })
    }

    /// The log as text, one line a frame.
    #[must_use]
    pub fn write(&self) -> String {
        let mut text = line_of(&self.head);
        self.frames
            .iter()
            .for_each(|frame| text.push_str(&line_of(frame)));
        text
    }

    /// Whether replaying takes the content: its policy chose by the sizes and worth of units, or by
    /// how noisy they are.
    #[must_use]
    pub fn needs_content(&self) -> bool {
        let config = &self.head.policy;
        config.needs_signatures() || config.needs_cues()
    }

    /// The same run selected again from what was given: equal to this one, or something changed.
    #[must_use]
    pub fn replay(&self, demand_of: DemandOf<'_>) -> Self {
        let policy = &self.head.policy;
        let assets = self.head.assets();
        let demands = assets.map(|(asset, content)| demand_of(asset, content, policy));
        let mut scheduler = Scheduler::new(policy, demands.collect());
        let mut footprints = vec![Footprints::default(); 1 + self.head.more.len()];
        let again = |frame: &SessionFrame| {
            for (asset, (changes, seen)) in frame.footprints().zip(&mut footprints).enumerate() {
                // That they are some was checked on reading.
                if let Some(after) = changes.and_then(|changes| seen.after(changes).ok()) {
                    *seen = after;
                    scheduler.see(asset, &measured(seen, policy));
                }
            }
            let moment = frame.moment(&self.head);
            let mut frames = vec![frame.frame];
            frames.extend(frame.more.iter().map(|asset| asset.frame));
            let chosen = scheduler.choose(&frames, &moment, frame.budget);
            let records: Vec<&Record> = chosen.iter().map(|chosen| &chosen.record).collect();
            let again = SessionFrame::of_scene(&frames, &moment, frame.budget, &records);
            let again = again.under(&self.head);
            let footprints = frame.footprints().enumerate();
            footprints.fold(again, |again, (asset, changes)| match changes {
                Some(changes) => again.with_footprints(asset, changes.to_vec()),
                None => again,
            })
        };
        Self {
            head: self.head.clone(),
            frames: self.frames.iter().map(again).collect(),
        }
    }
}

fn is_origin(position: &[f64; 3]) -> bool {
    *position == [0.0; 3]
}

fn line_of(value: &impl Serialize) -> String {
    // Plain numbers, strings and lists: serialising them cannot fail.
    serde_json::to_string(value).unwrap_or_default() + "\n"
}

pub use crate::pack::sha256_hex;

#[cfg(test)]
mod tests;
