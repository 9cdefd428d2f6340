//! Which displays stand round the eyes, and how is each of them fed?

use super::alpha::AlphaMap;
use super::distortion::Distortion;
use crate::view::axes::Axes;
use crate::view::eye_view::{EyeView, Field};
use crate::view::surface::Eye;
use glam::{DMat3, DVec3};
use std::sync::Arc;

/// Most panels of a rig.
pub const MOST_PANELS: usize = 1024;

/// Displays that show one source together.
#[derive(Clone, Debug, PartialEq)]
pub struct Rig {
    /// Of both eyes.
    pub panels: Vec<Panel>,
    /// Metres from eye to eye.
    pub ipd: f64,
    /// Width and height, in distances from the eye, of the flat screen straight ahead that the
    /// source fills, where the file says it: nothing is fitted.
    pub screen: Option<[f64; 2]>,
}

/// One display before an eye.
#[derive(Clone, Debug, PartialEq)]
pub struct Panel {
    /// What it is called: once in a rig, and fit to name a file.
    pub id: String,
    /// Where it stands, as the eye sees it: `at_eye` of its field is none, and its position is that
    /// of the eye in the head.
    pub view: EyeView,
    /// Whether both eyes look at it, as at a wall; else only the eye of its view does.
    pub is_for_both: bool,
    /// How its picture is turned before it is sent.
    pub scanout: Scanout,
    /// Where its picture is sent.
    pub output: PanelOutput,
    /// What its optics do.
    pub distortion: Distortion,
    /// Radians from its edge over which it fades in, where others overlap it.
    pub blend: f64,
    /// The share of its light that each pixel keeps; all where it is not given.
    pub alpha: Option<Arc<AlphaMap>>,
    /// What linear red, green and blue are multiplied by.
    pub gain: [f64; 3],
    /// Linear light that the darkest pixel has, from 0 to 1.
    pub black: f64,
}

/// Where in a surface a panel's picture, as it is sent, has its first column and row.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PanelOutput {
    /// The picture that several panels share: one window or file.
    pub surface: String,
    /// The display that the surface fills; empty where any will do.
    pub monitor: String,
    /// First column.
    pub x: u32,
    /// First row.
    pub y: u32,
}

/// How the picture that an eye sees is turned to the picture that is sent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Scanout {
    /// Not at all.
    #[default]
    Normal,
    /// A quarter clockwise.
    Rot90,
    /// Upside down.
    Rot180,
    /// A quarter the other way.
    Rot270,
    /// Left is right.
    FlipX,
    /// Up is down.
    FlipY,
}

impl Scanout {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::Normal,
        Self::Rot90,
        Self::Rot180,
        Self::Rot270,
        Self::FlipX,
        Self::FlipY,
    ];

    /// Columns and rows as sent of a picture of `size` as seen.
    #[must_use]
    pub fn sent_size(self, size: [u32; 2]) -> [u32; 2] {
        match self {
            Self::Rot90 | Self::Rot270 => [size[1], size[0]],
            _ => size,
        }
    }

    /// The matrix that turns a place as sent, (column, row, 1), into the place as seen of a picture
    /// of `size` as seen.
    #[must_use]
    pub fn seen_from_sent(self, size: [u32; 2]) -> DMat3 {
        let [w, h] = size.map(f64::from);
        let (x, y, origin) = match self {
            Self::Normal => ([1.0, 0.0], [0.0, 1.0], [0.0, 0.0]),
            Self::Rot90 => ([0.0, -1.0], [1.0, 0.0], [0.0, h]),
            Self::Rot180 => ([-1.0, 0.0], [0.0, -1.0], [w, h]),
            Self::Rot270 => ([0.0, 1.0], [-1.0, 0.0], [w, 0.0]),
            Self::FlipX => ([-1.0, 0.0], [0.0, 1.0], [w, 0.0]),
            Self::FlipY => ([1.0, 0.0], [0.0, -1.0], [0.0, h]),
        };
        let column = |[a, b]: [f64; 2], last| DVec3::new(a, b, last);
        DMat3::from_cols(column(x, 0.0), column(y, 0.0), column(origin, 1.0))
    }
}

impl Panel {
    /// A flat panel that nothing bends, turns or dims.
    #[must_use]
    pub fn flat(id: &str, view: EyeView) -> Self {
        Self {
            id: id.to_owned(),
            view,
            is_for_both: false,
            scanout: Scanout::Normal,
            output: PanelOutput::default(),
            distortion: Distortion::None,
            blend: 0.0,
            alpha: None,
            gain: [1.0; 3],
            black: 0.0,
        }
    }

    /// Whether an eye looks at it.
    #[must_use]
    pub fn is_seen_by(&self, eye: Eye) -> bool {
        self.is_for_both || self.view.eye == eye
    }

    /// Whether it shows a picture of its pixels as it is: nothing bends or dims it.
    #[must_use]
    pub fn is_plain(&self) -> bool {
        let keeps_light = self.blend <= 0.0 && self.alpha.is_none();
        self.distortion.is_none() && keeps_light && self.gain == [1.0; 3] && self.black <= 0.0
    }

    /// The same display where nothing fades, tints or lifts its light.
    #[must_use]
    pub fn undimmed(&self) -> Self {
        Self {
            blend: 0.0,
            alpha: None,
            gain: [1.0; 3],
            black: 0.0,
            ..self.clone()
        }
    }

    /// The same display of other columns and rows, as the eye sees it.
    #[must_use]
    pub fn resized(&self, size: [u32; 2]) -> Self {
        let own = self.view.size;
        let scale = [0, 1].map(|k| f64::from(size[k]) / f64::from(own[k]));
        let alpha = self.alpha.as_ref();
        Self {
            view: EyeView { size, ..self.view },
            distortion: self.distortion.scaled(scale),
            alpha: alpha.map(|it| Arc::new(it.resized(own, size))),
            ..self.clone()
        }
    }

    /// Its columns and rows as they are sent.
    #[must_use]
    pub fn sent_size(&self) -> [u32; 2] {
        self.scanout.sent_size(self.view.size)
    }

    /// Its pixels.
    #[must_use]
    pub fn pixels(&self) -> f64 {
        self.view.size.map(f64::from).iter().product()
    }

    /// The shares of light that its pixels keep, as its picture is sent.
    #[must_use]
    pub fn alpha_as_sent(&self) -> Option<AlphaMap> {
        let alpha = self.alpha.as_ref()?;
        let seen_from_sent = self.scanout.seen_from_sent(self.view.size);
        let [columns, rows] = self.sent_size();
        let pixels = (0..rows).flat_map(|row| (0..columns).map(move |column| [column, row]));
        let shares = pixels.map(|at| {
            let [x, y] = at.map(|k| f64::from(k) + 0.5);
            let seen = seen_from_sent * DVec3::new(x, y, 1.0);
            alpha.at([seen.x as u32, seen.y as u32])
        });
        Some(AlphaMap::new([columns, rows], shares.collect()))
    }

    /// Corners at unit distance: top left, top right, bottom left, bottom right; Strege 2009,
    /// section 3.2.1.
    #[must_use]
    pub fn corners(&self) -> [DVec3; 4] {
        let f = self.view.field;
        [
            [-f.left, -f.up],
            [f.right, -f.up],
            [-f.left, f.down],
            [f.right, f.down],
        ]
        .map(|tangent| self.view.axes.at(tangent))
    }

    /// The twin before the other eye: the same display in a mirror that stands between the eyes.
    #[must_use]
    pub fn mirrored(&self) -> Self {
        let f = self.view.field;
        let axes = self.view.axes;
        let position = self.view.position;
        Self {
            view: EyeView {
                position: reflected(position),
                axes: Axes {
                    forward: reflected(axes.forward),
                    right: -reflected(axes.right),
                    down: reflected(axes.down),
                },
                field: Field::of([f.right, f.left, f.up, f.down]),
                size: self.view.size,
                eye: match self.view.eye {
                    Eye::Left => Eye::Right,
                    Eye::Right => Eye::Left,
                },
            },
            distortion: self.distortion.mirrored(self.view.size[0]),
            alpha: self.alpha.as_ref().map(|it| Arc::new(it.mirrored())),
            ..self.clone()
        }
    }
}

fn reflected(v: DVec3) -> DVec3 {
    DVec3::new(-v.x, v.y, v.z)
}

impl Rig {
    /// The panels that an eye looks at; those of both where none is named.
    #[must_use]
    pub fn seen_by(&self, eye: Option<Eye>) -> Vec<&Panel> {
        let all = self.panels.iter();
        all.filter(|panel| eye.is_none_or(|eye| panel.is_seen_by(eye)))
            .collect()
    }
}

/// Axes of a panel turned by Strege 2009's matrices `R_roll R_pitch R_yaw` (section 3.2.1): yaw
/// turns right, and then about the axes of the head pitch turns down and roll turns clockwise.
#[must_use]
pub fn axes_from_seed_angles(roll: f64, pitch: f64, yaw: f64) -> Axes {
    let turn = |angle: f64| (libm::sin(angle), libm::cos(angle));
    let [(sr, cr), (sp, cp), (sy, cy)] = [roll, pitch, yaw].map(turn);
    let rows = |a: [f64; 3], b: [f64; 3], c: [f64; 3]| {
        DMat3::from_cols(a.into(), b.into(), c.into()).transpose()
    };
    let r_roll = rows([cr, sr, 0.0], [-sr, cr, 0.0], [0.0, 0.0, 1.0]);
    let r_pitch = rows([1.0, 0.0, 0.0], [0.0, cp, sp], [0.0, -sp, cp]);
    let r_yaw = rows([cy, 0.0, -sy], [0.0, 1.0, 0.0], [sy, 0.0, cy]);
    let m = r_roll * r_pitch * r_yaw;
    Axes {
        forward: -m.z_axis,
        right: m.x_axis,
        down: -m.y_axis,
    }
}
