//! What does a pack say about its content?

use crate::content::video::bytes::codec::Codec;
use crate::content::video::bytes::needs::check_needs;
use crate::content::video::bytes::rate::QualityScale;
use crate::content::video::grid::tile_grid::{Cut, TileGrid};
use crate::pack::{Identity, PackError, TableEntry};
use crate::units::counted;
use crate::view::picture::Colour;
use crate::view::surface::{
    Mapping, Projection, Screen, Surface, all_faces, are_all_faces, is_one_eye, one_eye,
};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Most frames in a pack.
pub const MAX_FRAMES: u32 = 1 << 24;
/// Longest group in frames.
pub const MAX_GROUP: u32 = 1024;

/// The JSON description of a video pack.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Description {
    /// Program and version that wrote the pack.
    pub generator: String,
    /// Flat or cube.
    pub projection: Projection,
    /// Pixels of one face at level 0.
    pub size: [u32; 2],
    /// Eyes that have pictures of their own, 1 or 2: the right eye's faces follow the left's.
    #[serde(default = "one_eye", skip_serializing_if = "is_one_eye")]
    pub eyes: u8,
    /// Faces of a cube, an eye: 6, or 4 without top and bottom; 6 for flat content, too.
    #[serde(default = "all_faces", skip_serializing_if = "are_all_faces")]
    pub cube_faces: u8,
    /// How pixels lie over the angles of a cube's faces; gnomonic for flat content, too.
    #[serde(default, skip_serializing_if = "Mapping::is_default")]
    pub mapping: Mapping,
    /// Width and height of a pixel of flat content, to each other.
    #[serde(default = "square_pixels", skip_serializing_if = "are_square_pixels")]
    pub pixel_aspect: [u32; 2],
    /// Yaw that a view of a sphere begins at, in degrees to the right of forward.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub front_deg: f64,
    /// How faces are cut into tiles.
    pub cut: Cut,
    /// Number of levels.
    pub levels: u8,
    /// Linear ratio between levels.
    pub ratio: u32,
    /// Codec of every tile.
    pub codec: Codec,
    /// Quantiser or quality of each level, finest first; 0 where bit rates were asked for.
    pub quality: Vec<u8>,
    /// The scale of `quality`.
    #[serde(default, skip_serializing_if = "QualityScale::is_default")]
    pub quality_scale: QualityScale,
    /// Whether the quantiser of a tile goes by its light and texture as well; `quality` is then
    /// what theirs are multiples of.
    #[serde(default, skip_serializing_if = "is_false")]
    pub quality_by_tile: bool,
    /// Bits per second that each tile of a level was coded for, finest level first; empty where the
    /// quality was fixed.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub bit_rates: Vec<u32>,
    /// Frames in a full group of each level, finest first; each a multiple of those before it.
    pub groups: Vec<u32>,
    /// Number of frames.
    pub frames: u32,
    /// Nominal frames per second, as numerator and denominator; exact times are in the side table
    /// `frame_times`.
    pub frame_rate: [u32; 2],
    /// How planes become colours.
    pub colour: Colour,
    /// What the pack was made from.
    pub source: Source,
    /// Identifies the preparation that made this pack; absent where it was not recorded.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub identity: Option<Identity>,
    /// What preparing lost; absent where it was not measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub loss: Option<Loss>,
    /// How long the last frame is shown, in seconds; a period of the frame rate if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub last_frame_s: Option<f64>,
    /// What a person should know: what was assumed, mended or left out.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub remarks: Vec<String>,
    /// What was mended or left out of the source, by name.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub repairs: BTreeMap<String, u64>,
    /// Side tables.
    #[serde(default)]
    pub tables: Vec<TableEntry>,
}

/// The finest level compared with the source, each in the same views.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Loss {
    /// Peak signal to noise over red, green and blue of all views, decibels; none where no pixel
    /// differs.
    pub psnr_db: Option<f64>,
    /// Score of the view that is worst to the eye, JOD, at most 10.
    pub jod: f64,
}

/// The shape of pixels of content that does not say it.
fn square_pixels() -> [u32; 2] {
    [1, 1]
}

fn are_square_pixels(aspect: &[u32; 2]) -> bool {
    *aspect == square_pixels()
}

fn is_false(flag: &bool) -> bool {
    !*flag
}

fn is_zero(number: &f64) -> bool {
    *number == 0.0
}

/// Longest side of a pixel for a shortest of 1.
const MOST_STRETCH: u32 = 16;

/// What a pack was made from.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Source {
    /// File name without its folder.
    pub name: String,
    /// Pixels of the source picture, after rotation.
    pub size: [u32; 2],
    /// Bytes of the source file.
    pub bytes: u64,
    /// Codec of the source.
    pub codec: String,
}

/// Longest time that a last frame may be shown, in seconds: a day.
const LONGEST_LAST_S: f64 = 86_400.0;

/// Most decibels that are stored: more than a picture of 16K has where one code differs by one.
const MOST_DECIBELS: f64 = 150.0;

impl Loss {
    fn check(self) -> Result<(), PackError> {
        let Self { psnr_db, jod } = self;
        if jod <= 10.0 && psnr_db.is_none_or(|psnr| (0.0..=MOST_DECIBELS).contains(&psnr)) {
            return Ok(());
        }
        let expected = format!("0 to {MOST_DECIBELS} dB, at most 10 JOD");
        let found = format!("{psnr_db:?} dB, {jod} JOD");
        Err(PackError::new("description.loss", found, expected))
    }
}

/// The fields that make the tile grid, for messages.
const GRID_FIELDS: &str = "description: size, eyes, cube_faces, cut, levels, ratio";

impl Description {
    /// Reads the JSON of a description; trailing spaces are padding.
    pub fn parse(bytes: &[u8]) -> Result<Self, PackError> {
        check_needs(bytes)?;
        let description: Self = serde_json::from_slice(bytes)
            .map_err(|e| PackError::new("description", e, "the JSON of docs/formats/pack.md"))?;
        description.check()?;
        Ok(description)
    }

    fn check_front(&self) -> Result<(), PackError> {
        let found = self.front_deg;
        let is_good = (-360.0..=360.0).contains(&found);
        let error = || PackError::new("description.front_deg", found, "-360 to 360");
        is_good.then_some(()).ok_or_else(error)
    }

    fn check_told(&self) -> Result<(), PackError> {
        if let Some(loss) = self.loss {
            loss.check()?;
        }
        match self.last_frame_s {
            Some(last) if !(0.0..=LONGEST_LAST_S).contains(&last) => {
                let expected = format!("0 to {LONGEST_LAST_S} s");
                Err(PackError::new("description.last_frame_s", last, expected))
            }
            _ => Ok(()),
        }
    }

    /// Whether every field is in range.
    pub fn check(&self) -> Result<(), PackError> {
        self.grid(Screen::default())
            .check()
            .map_err(|e| PackError::new(GRID_FIELDS, e, "a grid"))?;
        let [wide, high] = self.pixel_aspect;
        let most = |side: u32| u64::from(side) * u64::from(MOST_STRETCH);
        if u64::from(wide) > most(high) || u64::from(high) > most(wide) || wide == 0 {
            return Err(PackError::new(
                "description.pixel_aspect",
                format!("{wide}:{high}"),
                format!("positive numbers, at most {MOST_STRETCH}:1"),
            ));
        }
        self.check_front()?;
        let square = self.size[0] == self.size[1];
        if self.projection == Projection::Cube && !square {
            let found = format!("{}x{}", self.size[0], self.size[1]);
            return Err(PackError::new(
                "description.size",
                found,
                "square cube faces",
            ));
        }
        if self.frames == 0 || self.frames > MAX_FRAMES {
            let most = format!("1 to {MAX_FRAMES}");
            return Err(PackError::new("description.frames", self.frames, most));
        }
        if self.frame_rate.contains(&0) {
            let found = format!("{:?}", self.frame_rate);
            return Err(PackError::new(
                "description.frame_rate",
                found,
                "positive numbers",
            ));
        }
        let levels = usize::from(self.levels);
        if self.groups.len() != levels || self.quality.len() != levels {
            let found = format!(
                "{} and {}",
                counted(self.groups.len(), "group"),
                self.quality.len()
            );
            let expected = format!("{levels}, one a level");
            return Err(PackError::new(
                "description.groups, quality",
                found,
                expected,
            ));
        }
        if !self.bit_rates.is_empty() && self.bit_rates.len() != levels {
            let expected = format!("none or {levels}, one a level");
            let found = counted(self.bit_rates.len(), "rate");
            return Err(PackError::new("description.bit_rates", found, expected));
        }
        self.check_told()?;
        let in_range = self.groups.iter().all(|g| (1..=MAX_GROUP).contains(g));
        if !in_range || self.groups.windows(2).any(|pair| pair[1] % pair[0] != 0) {
            let expected = format!("1 to {MAX_GROUP}, each a multiple of the one before");
            return Err(PackError::new(
                "description.groups",
                format!("{:?}", self.groups),
                expected,
            ));
        }
        Ok(())
    }

    /// The tile grid, with flat content filling `screen`.
    #[must_use]
    pub fn grid(&self, screen: Screen) -> TileGrid {
        let surface = match self.projection {
            Projection::Flat => Surface::flat_with_pixels(self.size, self.pixel_aspect, screen),
            Projection::Cube => Surface::cube(self.size[0]).mapped(self.mapping),
            Projection::Equirect => Surface::equirect(self.size),
        };
        let surface = Surface {
            eyes: self.eyes,
            cube_faces: self.cube_faces,
            ..surface
        };
        TileGrid {
            surface,
            cut: self.cut,
            levels: self.levels,
            ratio: self.ratio,
        }
    }

    /// Width and height of flat content as it is to be shown, in units of their own.
    #[must_use]
    pub fn flat_shape(&self) -> Option<[u32; 2]> {
        let side = |k: usize| self.size[k].saturating_mul(self.pixel_aspect[k]);
        (self.projection == Projection::Flat).then(|| [side(0), side(1)])
    }

    /// Whether it is a picture: of one frame there is no time.
    pub fn is_still(&self) -> bool {
        self.frames == 1
    }

    /// How long the last frame is shown, in seconds.
    #[must_use]
    pub fn last_frame_s(&self) -> f64 {
        self.last_frame_s.unwrap_or(1.0 / self.fps())
    }

    /// Frames per second.
    #[must_use]
    pub fn fps(&self) -> f64 {
        f64::from(self.frame_rate[0]) / f64::from(self.frame_rate[1])
    }
}
