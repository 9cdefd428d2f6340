//! What was selected in a viewer's run, so that it can be selected again?
//!
//! The log is lines of JSON: a head with grid, policy and view, then one line a frame with what
//! selection was given and a hash of what it chose. Replaying needs no clock, and content only
//! where the policy weighed it. Normative: docs/formats/session.md.

use crate::content::policy::{Policy, PolicyConfig};
use crate::content::video::grid::level_map::{histogram, pixels};
use crate::content::video::grid::tile_grid::{Cut, Tile, TileGrid};
use crate::content::video::rules::Selection;
use crate::content::video::units::Content;
use crate::gaze::sample::{GazeSample, HeadPose};
use crate::gaze::scan::ScanPath;
use crate::pack::unit::UnitId;
use crate::perception::measures::contrast::Signature;
use crate::perception::measures::cues::Cues;
use crate::perception::moment::Moment;
use crate::perception::parameters::EyeState;
use crate::selection::chooser::Chooser;
use crate::units::{Radians, Seconds};
use crate::view::eye_view::{EyeView, Field};
use crate::view::surface::{Screen, Surface};
use glam::DVec3;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use thiserror::Error;

/// Version of the log's format.
const VERSION: u32 = 1;
/// Most cells of a grid that is replayed from outside bytes.
const MAX_REPLAYED_CELLS: u32 = 1 << 18;

/// The first line of a log.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SessionHead {
    /// Version of the format.
    pub foveal_session: u32,
    /// Name of the pack, for people.
    pub pack: String,
    /// What was selected on.
    pub grid: TileGrid,
    /// By which rule.
    pub policy: PolicyConfig,
    /// Field of view of what showed it.
    pub field: Field,
    /// Its pixels.
    pub size: [u32; 2],
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
    /// Yaw, pitch and roll of the view in radians.
    pub head: HeadPose,
    /// What the eye did, as far as the worth of a step depends on it.
    #[serde(default)]
    pub state: EyeState,
    /// Bytes that could be spent, under a policy that spends a budget; without it, no limit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub budget: Option<u64>,
    /// Number of tiles of each level, finest first.
    pub tiles: Vec<u32>,
    /// Pixels of all tiles.
    pub pixels: u64,
    /// SHA-256 of the tiles.
    pub sha256: String,
    /// How far the picture was behind the sound when this was chosen, where there was sound.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub behind_sound_s: Option<Seconds>,
}

/// What selection is given at one frame, as far as it is logged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Given {
    /// Where the eye looks when the frame is shown, as far as was known.
    pub gaze: GazeSample,
    /// Orientation of the view.
    pub head: HeadPose,
    /// What the eye does, as far as the worth of a step depends on it.
    pub state: EyeState,
    /// Bytes that could be spent; `None` without a limit, or where the policy has no budget.
    pub budget: Option<u64>,
}

/// A run, as it was logged.
#[derive(Clone, Debug, PartialEq)]
pub struct Session {
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
    #[error("line {line}: {why}")]
    Line {
        /// Line in the file, from 1.
        line: usize,
        /// What is wrong with it.
        why: String,
    },
    /// A log of another version.
    #[error("line 1, foveal_session: found {0}, expected {VERSION}")]
    Version(u32),
}

impl SessionHead {
    /// The head of a new log.
    #[must_use]
    pub fn new(pack: &str, grid: &TileGrid, policy: PolicyConfig, view: &EyeView) -> Self {
        Self {
            foveal_session: VERSION,
            pack: pack.to_owned(),
            grid: *grid,
            policy,
            field: view.field,
            size: view.size,
        }
    }

    fn check(&self) -> Result<(), SessionError> {
        let wrong = |why: String| Err(SessionError::Line { line: 1, why });
        if self.foveal_session != VERSION {
            return Err(SessionError::Version(self.foveal_session));
        }
        if let Err(error) = self.grid.check() {
            return wrong(format!("grid: {error}"));
        }
        if self.grid.tiles_in_level(0) > MAX_REPLAYED_CELLS {
            let cells = self.grid.tiles_in_level(0);
            return wrong(format!(
                "grid: {cells} cells, at most {MAX_REPLAYED_CELLS} are replayed"
            ));
        }
        let surface = self.grid.surface.tangents;
        if !self.field.is_open() || surface.iter().any(|t| !(1e-6..=1e6).contains(t)) {
            return wrong("field, tangents: expected tangents between 1e-6 and 1e6".to_owned());
        }
        if self.size.contains(&0) {
            return wrong("size: expected at least one pixel".to_owned());
        }
        Ok(())
    }
}

impl SessionFrame {
    /// What selection was given at this frame.
    #[must_use]
    pub fn given(&self) -> Given {
        Given {
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
            budget: self.budget,
        }
    }

    /// The moment of this frame, for what showed it.
    #[must_use]
    pub fn moment(&self, head: &SessionHead) -> Moment {
        Moment {
            gaze: self.given().gaze,
            view: Some(EyeView {
                axes: self.head.axes(),
                field: head.field,
                size: head.size,
                eye: Default::default(),
            }),
            state: self.state,
        }
    }

    /// The line of a frame: what selection was given and chose.
    #[must_use]
    pub fn new(frame: u32, given: &Given, grid: &TileGrid, selection: &Selection) -> Self {
        let gaze = &given.gaze;
        let mut hash = Sha256::new();
        for tile in &selection.tiles {
            hash.update([tile.level, tile.face]);
            hash.update(tile.x.to_le_bytes());
            hash.update(tile.y.to_le_bytes());
        }
        Self {
            frame,
            time_s: gaze.time,
            gaze: gaze.gaze_in_content.to_array(),
            valid: gaze.valid,
            spread_rad: gaze.spread,
            head: given.head,
            state: given.state,
            budget: given.budget,
            tiles: histogram(grid, &selection.tiles),
            pixels: pixels(grid, &selection.tiles),
            sha256: hex(&hash.finalize()),
            behind_sound_s: None,
        }
    }

    /// The line of the log.
    #[must_use]
    pub fn write(&self) -> String {
        line_of(self)
    }

    fn check(&self, line: usize) -> Result<(), SessionError> {
        let length = DVec3::from_array(self.gaze).length();
        if (length - 1.0).abs() < 1e-6 {
            Ok(())
        } else {
            let why = format!("gaze: found a vector of length {length}, expected 1");
            Err(SessionError::Line { line, why })
        }
    }
}

impl Session {
    /// Reads a log; refuses lines that are not what [`Self::write`] writes, naming the line.
    pub fn parse(text: &str) -> Result<Self, SessionError> {
        let mut lines = text.lines().enumerate();
        let Some((_, first)) = lines.next() else {
            return Err(SessionError::Empty);
        };
        let wrong = |line, e: serde_json::Error| SessionError::Line {
            line,
            why: e.to_string(),
        };
        let head: SessionHead = serde_json::from_str(first).map_err(|e| wrong(1, e))?;
        head.check()?;
        let mut frames = Vec::new();
        for (number, line) in lines {
            let frame: SessionFrame =
                serde_json::from_str(line).map_err(|e| wrong(number + 1, e))?;
            frame.check(number + 1)?;
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
    ///
    /// # Panics
    /// When the content is needed and not given; see [`Self::needs_content`].
    #[must_use]
    pub fn replay(&self, content: Option<&dyn Content>) -> Self {
        let mut chooser = Chooser::new(self.head.grid, self.head.policy.clone());
        let again = |frame: &SessionFrame| {
            let moment = frame.moment(&self.head);
            let selection = chooser.choose(content, frame.frame, &moment, frame.budget);
            SessionFrame {
                behind_sound_s: frame.behind_sound_s,
                ..SessionFrame::new(frame.frame, &frame.given(), &self.head.grid, &selection)
            }
        };
        Self {
            head: self.head.clone(),
            frames: self.frames.iter().map(again).collect(),
        }
    }
}

fn line_of(value: &impl Serialize) -> String {
    // Plain numbers, strings and lists: serialising them cannot fail.
    serde_json::to_string(value).unwrap_or_default() + "\n"
}

/// SHA-256 of bytes in hexadecimal.
#[must_use]
pub fn sha256_hex(bytes: &[u8]) -> String {
    hex(&Sha256::digest(bytes))
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Content whose sizes and measures follow from the unit's number.
struct ScriptedContent;

impl Content for ScriptedContent {
    fn unit(&self, tile: Tile, frame: u32) -> UnitId {
        let place = u32::from(tile.face) << 20 | u32::from(tile.y) << 10 | u32::from(tile.x);
        UnitId(place ^ u32::from(tile.level) << 24 ^ (frame / 8) << 27)
    }

    fn next_group(&self, frame: u32) -> Option<u32> {
        Some((frame / 8 + 1) * 8)
    }

    fn bytes(&self, unit: UnitId) -> u32 {
        500 + unit.0.wrapping_mul(2_654_435_761) % 4000
    }

    fn signature(&self, unit: UnitId) -> Option<Signature> {
        let byte = |k: u32| (unit.0.wrapping_mul(2_246_822_519 + 2 * k) >> 24) as u8;
        Some(Signature::from_bytes_v1(core::array::from_fn(|k| {
            byte(k as u32)
        })))
    }

    fn cues(&self, unit: UnitId) -> Option<Cues> {
        let bytes = unit.0.wrapping_mul(3_266_489_917).to_le_bytes();
        Some(Cues::from_bytes(bytes))
    }
}

/// A scripted run over a 16K cube and a flat picture under every policy, as logs: the same text on
/// every machine, natively and in wasm.
#[must_use]
pub fn scripted_sessions() -> Vec<Session> {
    let flat = Surface::flat([3840, 2160], Screen::default());
    scripted_sessions_over([Surface::cube(4096), flat])
}

/// A scripted run over each surface under every policy.
fn scripted_sessions_over(surfaces: [Surface; 2]) -> Vec<Session> {
    let policies = [
        Policy::Acuity,
        Policy::Grid,
        Policy::Distance,
        Policy::Sampled,
        Policy::Viewport,
        Policy::Full,
        Policy::Coarsest,
        Policy::Uniform,
        Policy::Eccentricity,
        Policy::Perceptual,
    ];
    let runs = surfaces.iter().flat_map(|surface| {
        let configs = policies.map(PolicyConfig::new);
        configs.map(|config| scripted_session(*surface, config))
    });
    runs.collect()
}

/// Two seconds of a scan over a surface, ten frames a second, with a head that turns.
fn scripted_session(surface: Surface, config: PolicyConfig) -> Session {
    let grid = TileGrid {
        surface,
        cut: Cut::Tile(256),
        levels: 5,
        ratio: 2,
    };
    let config = PolicyConfig {
        saliency: true,
        noise_threshold: Some(3000.0),
        ..config
    };
    let path = ScanPath::new(&surface, 7, Seconds(2.0));
    let mut chooser = Chooser::new(grid, config.clone());
    let size = [1280, 720];
    let view = EyeView {
        axes: HeadPose::default().axes(),
        field: Field::across(Radians::from_degrees(100.0), size),
        size,
        eye: Default::default(),
    };
    let frames = (0..20).map(|frame| {
        let gaze = path.at(Seconds(f64::from(frame) * 0.1)).0;
        let head = HeadPose {
            yaw: Radians(f64::from(frame) * 0.05),
            ..HeadPose::default()
        };
        let axes = head.axes();
        let moment = Moment {
            gaze,
            view: Some(EyeView { axes, ..view }),
            state: EyeState::Steady,
        };
        let given = Given {
            gaze,
            head,
            state: moment.state,
            budget: Some(40_000),
        };
        let selection = chooser.choose(Some(&ScriptedContent), frame, &moment, given.budget);
        SessionFrame::new(frame, &given, &grid, &selection)
    });
    Session {
        frames: frames.collect(),
        head: SessionHead::new("scripted", &grid, config, &view),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A short run under a policy that is a rule.
    fn flat_session(policy: Policy) -> Session {
        let surface = Surface::flat([1920, 1080], Screen::default());
        scripted_session(surface, PolicyConfig::new(policy))
    }

    #[test]
    fn a_written_log_reads_back_and_replays_to_the_same_text() {
        let flat = Surface::flat([1920, 1080], Screen::default());
        for session in scripted_sessions_over([Surface::cube(1024), flat]) {
            let text = session.write();
            let read = Session::parse(&text).unwrap();
            assert_eq!(read, session);
            assert_eq!(read.replay(Some(&ScriptedContent)).write(), text);
        }
    }

    #[test]
    fn every_policy_chooses_what_it_always_did() {
        let logs: String = scripted_sessions().iter().map(Session::write).collect();
        let expected = "4b83fb2cbdeb15692190b14700a2139dc04b3f44430fe1296f5596338df1bc53";
        assert_eq!(sha256_hex(logs.as_bytes()), expected);
    }

    #[test]
    fn a_changed_gaze_changes_the_replay() {
        let mut session = flat_session(Policy::Acuity);
        session.frames[3].gaze = [1.0, 0.0, 0.0];
        assert_ne!(session.replay(None), session);
    }

    #[test]
    fn damaged_logs_are_refused_with_their_line() {
        let text = flat_session(Policy::Acuity).write();
        let third = text.replacen("\"frame\":1,", "\"frame\":x,", 1);
        assert!(
            Session::parse(&third)
                .unwrap_err()
                .to_string()
                .starts_with("line 3")
        );
        let version = text.replacen("\"foveal_session\":1", "\"foveal_session\":9", 1);
        assert_eq!(Session::parse(&version), Err(SessionError::Version(9)));
        assert_eq!(Session::parse(""), Err(SessionError::Empty));
        let gaze = text.replacen("\"gaze\":[0.0,0.0,-1.0]", "\"gaze\":[0.0,0.0,-2.0]", 1);
        assert!(
            Session::parse(&gaze)
                .unwrap_err()
                .to_string()
                .contains("length 2")
        );
    }
}
