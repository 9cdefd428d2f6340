//! Which keys has a rig file, and of which types are they?
//!
//! What is said of a key here is also said by the schema.

use schemars::JsonSchema;
use serde::Deserialize;

/// Foveal rig file: displays that show one source together (TOML or JSON)
///
/// Angles in degrees, lengths in distances from the eye to the panel.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Foveal rig file (TOML or JSON)")]
pub(super) struct RigEntries {
    /// The format and its version.
    pub(super) format: RigFormat,
    /// Whether each panel of the left eye has a twin before the right eye, as in a mirror between
    /// the eyes; its id ends in `.right`.
    #[serde(default)]
    pub(super) mirror: bool,
    /// Millimetres from eye to eye.
    #[serde(default = "usual_ipd")]
    #[schemars(range(min = 0.0, max = 1000.0))]
    pub(super) ipd_mm: f64,
    /// Width and height, in distances from the eye, of the flat screen straight ahead that the
    /// source fills; placed by what the panels see if not given.
    pub(super) screen: Option<[f64; 2]>,
    /// The displays, at most 1,024 with twins.
    #[schemars(length(min = 1, max = 1024))]
    pub(super) panel: Vec<PanelEntry>,
}

fn usual_ipd() -> f64 {
    63.0
}

#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
pub(super) enum RigFormat {
    #[serde(rename = "tiled-view/1")]
    TiledView1,
}

/// A display.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct PanelEntry {
    /// What it is called: once in a file. Pictures are called so, too, so it holds no separator.
    #[schemars(length(min = 1, max = 100))]
    pub(super) id: String,
    /// The eye that looks at it; `both`, if not given, is a wall.
    #[serde(default)]
    pub(super) eye: EyeEntry,
    /// Columns and rows as the eye sees it.
    pub(super) pixels: [u32; 2],
    /// Where it looks; straight ahead if not given.
    #[serde(default)]
    pub(super) pose: PoseEntry,
    /// Width and height; either this or `tangents`.
    pub(super) size: Option<[f64; 2]>,
    /// Tangents of the angles from its axis to its sides; either this or `size`.
    pub(super) tangents: Option<TangentsEntry>,
    /// How its picture is turned before it is sent.
    #[serde(default)]
    pub(super) scanout: ScanoutEntry,
    /// Where its picture is sent; next to the others if not given.
    pub(super) output: Option<OutputEntry>,
    /// What its optics do.
    pub(super) distortion: Option<DistortionEntry>,
    /// Degrees from its edge over which it fades in where others overlap it.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 90.0))]
    pub(super) blend: f64,
    /// A grey PNG of the panel's pixels in the rig file's folder: the share of its linear light
    /// that each pixel keeps.
    pub(super) alpha: Option<String>,
    /// What linear red, green and blue are multiplied by.
    #[serde(default = "no_gain")]
    pub(super) gain: [f64; 3],
    /// Linear light of its darkest pixel.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1.0))]
    pub(super) black: f64,
}

fn no_gain() -> [f64; 3] {
    [1.0; 3]
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(super) enum EyeEntry {
    Left,
    Right,
    #[default]
    Both,
}

/// Three angles, or a quaternion.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct PoseEntry {
    /// What the angles mean; needed where there is one.
    pub(super) order: Option<PoseOrder>,
    /// Degrees clockwise.
    pub(super) roll: Option<f64>,
    /// Degrees up; in `seed002` DOWN, about the head's axis.
    pub(super) pitch: Option<f64>,
    /// Degrees to the right.
    pub(super) yaw: Option<f64>,
    /// x, y, z, w of the turn from straight ahead, +x right, +y up, -z ahead; of any length but 0.
    pub(super) quaternion: Option<[f64; 4]>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
pub(super) enum PoseOrder {
    /// Yaw first, then pitch (down) and roll about the head's axes.
    #[serde(rename = "seed002")]
    Seed002,
    /// Roll first, then pitch (up) and yaw about the head's axes: yaw and pitch are where it looks.
    #[serde(rename = "yaw-pitch-roll")]
    YawPitchRoll,
}

/// Outward from the axis: a side beyond it is negative.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct TangentsEntry {
    pub(super) left: f64,
    pub(super) right: f64,
    pub(super) up: f64,
    pub(super) down: f64,
}

#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(super) enum ScanoutEntry {
    #[default]
    Normal,
    /// A quarter clockwise.
    Rot90,
    Rot180,
    Rot270,
    FlipX,
    FlipY,
}

/// A place in a picture that several panels share.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct OutputEntry {
    /// The window or file.
    #[serde(default = "usual_surface")]
    pub(super) surface: String,
    /// The display that the window fills; any if empty.
    #[serde(default)]
    pub(super) monitor: String,
    /// First column.
    #[serde(default)]
    #[schemars(range(max = 1_000_000))]
    pub(super) x: u32,
    /// First row.
    #[serde(default)]
    #[schemars(range(max = 1_000_000))]
    pub(super) y: u32,
}

pub(super) fn usual_surface() -> String {
    "main".to_owned()
}

/// From the pixel that is seen to the pixel of an ideal panel that looks there. What is of one
/// colour stands in `red`, `green` and `blue` in place of here.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct DistortionEntry {
    pub(super) model: DistortionModel,
    /// Of `bulge`: the height in the middle.
    pub(super) b: Option<f64>,
    /// Of `bulge`: where the height goes.
    pub(super) sign: Option<BulgeSign>,
    /// Of `polynomial` and `brown-conrady`: tangents to the right and down of the axis.
    pub(super) centre: Option<[f64; 2]>,
    /// Of `polynomial`: what tangents are multiplied by, c0 + c1 r + c2 r^2 and on.
    pub(super) coefficients: Option<Vec<f64>>,
    /// Of `brown-conrady`: k1, k2, k3.
    pub(super) k: Option<[f64; 3]>,
    /// Of `brown-conrady`: p1, p2.
    pub(super) p: Option<[f64; 2]>,
    /// Of `grid`: columns of points.
    pub(super) columns: Option<u32>,
    /// Of `grid`: rows of points.
    pub(super) rows: Option<u32>,
    /// Of `grid`: ideal pixels of places evenly from edge to edge, row by row from above.
    pub(super) points: Option<Vec<[f64; 2]>>,
    /// Of `pfm`: a file in the rig file's folder, with the share of the ideal panel to the right
    /// and down at each pixel; not a number where the panel is unlit.
    pub(super) file: Option<String>,
    pub(super) red: Option<ChannelEntry>,
    pub(super) green: Option<ChannelEntry>,
    pub(super) blue: Option<ChannelEntry>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(super) enum DistortionModel {
    Bulge,
    Polynomial,
    BrownConrady,
    Grid,
    Pfm,
}

#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(super) enum BulgeSign {
    TowardEye,
    AwayFromEye,
}

/// The same of one colour.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct ChannelEntry {
    pub(super) centre: Option<[f64; 2]>,
    pub(super) coefficients: Option<Vec<f64>>,
    pub(super) k: Option<[f64; 3]>,
    pub(super) p: Option<[f64; 2]>,
    pub(super) points: Option<Vec<[f64; 2]>>,
    pub(super) file: Option<String>,
}
