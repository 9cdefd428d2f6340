//! What of an input is looked at before it is prepared, to find how fine it must be coded?
//!
//! A few small windows of the finest level in a few groups, cut as the pack's tiles are, so that
//! what is found holds for them.

use super::tile_rates::{ladder, rate_of_tile};
use crate::error::MediaError;
use crate::prepare::cutter::Cutter;
use crate::prepare::plan::PreparationPlan;
use crate::read::input::VideoInput;
use crate::tiles::decode::GroupDecoder;
use crate::tiles::encode::encode_group;
use crate::tiles::encode_settings::{EncodeSettings, Rate};
use foveal_core::content::video::bytes::description::MAX_FRAMES;
use foveal_core::content::video::grid::tile_grid::{Tile, TileGrid};
use foveal_core::view::picture::{Colour, Picture};
use std::path::Path;

/// Groups that are looked at, at most.
const GROUPS: u32 = 3;
/// Pixels of the source that are read at most, and that are cut.
const MOST_READ: u64 = 1 << 30;
const MOST_CUT: u64 = 1 << 28;
/// Size of a window in pixels, about; a tile at least, or as much of it as [`LARGEST_TILE`].
const WINDOW: [u32; 2] = [384, 256];
const LARGEST_TILE: u32 = 512;
/// Most tiles of a window, across and down.
const TILES: [u32; 2] = [3, 2];
/// Where windows are in a picture, in sixths of its width and height.
const SIXTHS: [u32; 3] = [1, 3, 5];

/// A part of the finest level over one group: some tiles side by side.
pub struct SampleWindow {
    /// Number of the face, and its pixel that is looked at.
    pub face: u32,
    /// The same in pixels of the face.
    pub gaze: [u32; 2],
    /// Top left corner in pixels of the face.
    pub corner: [u32; 2],
    /// Columns and rows of pixels.
    pub size: [u32; 2],
    tiles: Vec<SampleTile>,
}

/// A tile of a window.
struct SampleTile {
    /// Top left corner in the window.
    at: [u32; 2],
    group: Vec<Picture>,
}

/// The windows of an input that is to be prepared as planned, group by group. What cannot be read
/// is left out: preparing will say so.
#[must_use]
pub fn sample_windows(input: &Path, plan: &PreparationPlan) -> Vec<SampleWindow> {
    let Ok(mut video) = VideoInput::open_with(input, plan.reading) else {
        return Vec::new();
    };
    let pixels = plan.description.source.size.map(u64::from);
    let pixels = (pixels[0] * pixels[1]).max(1);
    let (starts, length) = sampled_groups(plan, pixels);
    let (cutter, places) = (Cutter::new(plan), places(&plan.grid));
    let mut windows: Vec<SampleWindow> = Vec::new();
    let Some(last) = starts.last().map(|last| last + length) else {
        return windows;
    };
    for frame in 0..last {
        let Ok(Some(read)) = video.next_frame() else {
            break;
        };
        if starts.contains(&frame) {
            windows.extend(places.iter().map(|place| place.window()));
        }
        if !starts
            .iter()
            .any(|start| (*start..start + length).contains(&frame))
        {
            continue;
        }
        let tiles: Vec<(Tile, [u32; 2])> = places.iter().flat_map(|it| it.tiles.clone()).collect();
        let first = windows.len() - places.len();
        let cut = cutter.parts(&read.picture, &tiles);
        let all = windows[first..]
            .iter_mut()
            .flat_map(|window| &mut window.tiles);
        for (tile, picture) in all.zip(cut) {
            tile.group.push(picture);
        }
    }
    windows
}

/// The first frames of the groups that are looked at, and how many frames each has.
fn sampled_groups(plan: &PreparationPlan, pixels: u64) -> (Vec<u32>, u32) {
    let group = plan.description.groups.first().copied().unwrap_or(1);
    let told = plan.frames.unwrap_or(u64::from(group)).max(1);
    let asked = u64::from(plan.most_frames.unwrap_or(MAX_FRAMES));
    let readable = told.min(asked).min((MOST_READ / pixels).max(1)) as u32;
    let most = (MOST_CUT / pixels).clamp(1, u64::from(GROUPS * group)) as u32;
    let length = group.min(most).min(readable);
    let count = (most / length).clamp(1, GROUPS);
    let groups = readable.div_ceil(group).max(1);
    // The last one may be short: the part that exists counts.
    let mut starts: Vec<u32> = match count.min(groups) {
        1 => vec![(groups - 1) / 2],
        count => (0..count).map(|k| k * (groups - 1) / (count - 1)).collect(),
    };
    starts.dedup();
    (
        starts.into_iter().map(|start| start * group).collect(),
        length,
    )
}

/// Where a window is.
struct WindowPlace {
    face: u32,
    gaze: [u32; 2],
    /// Tiles, and what of each is looked at.
    tiles: Vec<(Tile, [u32; 2])>,
    corner: [u32; 2],
    size: [u32; 2],
    /// Top left corners of the tiles in the face.
    origins: Vec<[u32; 2]>,
}

impl WindowPlace {
    fn window(&self) -> SampleWindow {
        let tile = |origin: &[u32; 2]| SampleTile {
            at: [0, 1].map(|k| origin[k] - self.corner[k]),
            group: Vec::new(),
        };
        SampleWindow {
            face: self.face,
            gaze: self.gaze,
            corner: self.corner,
            size: self.size,
            tiles: self.origins.iter().map(tile).collect(),
        }
    }
}

/// Nine of a flat picture, one in the middle of each face of an eye.
fn places(grid: &TileGrid) -> Vec<WindowPlace> {
    let faces = grid.surface.faces_of_an_eye();
    let at = |face: u32, sixths: [u32; 2]| {
        let gaze = [0, 1].map(|k| {
            let sixth = u64::from(grid.surface.size[k]) * u64::from(sixths[k]) / 6;
            sixth as u32
        });
        place_at(grid, face, gaze)
    };
    match faces {
        1 => {
            let all = SIXTHS.into_iter().flat_map(|y| SIXTHS.map(|x| [x, y]));
            all.map(|sixths| at(0, sixths)).collect()
        }
        faces => (0..faces).map(|face| at(face, [3, 3])).collect(),
    }
}

/// The window round a place of a face: whole tiles, or the beginning of one that is large.
fn place_at(grid: &TileGrid, face: u32, gaze: [u32; 2]) -> WindowPlace {
    let middle = grid.cell_at(face, gaze.map(f64::from));
    let (cells, span) = (grid.cells(), grid.span(0));
    let count = [0, 1].map(|k| (WINDOW[k] / span[k]).clamp(1, TILES[k]).min(cells[k]));
    let first = [(middle.x, 0), (middle.y, 1)].map(|(cell, k)| {
        let before = u32::from(cell).saturating_sub((count[k] - 1) / 2);
        before.min(cells[k] - count[k])
    });
    let mut tiles = Vec::new();
    for y in first[1]..first[1] + count[1] {
        for x in first[0]..first[0] + count[0] {
            let tile = Tile {
                x: x as u16,
                y: y as u16,
                ..middle
            };
            let size = grid.tile_size(tile).map(|side| side.min(LARGEST_TILE));
            tiles.push((tile, size));
        }
    }
    let origins: Vec<[u32; 2]> = tiles.iter().map(|(tile, _)| grid.origin(*tile)).collect();
    let corner = origins[0];
    let ends = origins.iter().zip(&tiles);
    let size = ends.fold([0; 2], |size, (origin, (_, tile))| {
        [0, 1].map(|k| size[k].max(origin[k] + tile[k] - corner[k]))
    });
    // A large tile is looked at from its corner on.
    let gaze = [0, 1].map(|k| gaze[k].clamp(corner[k], corner[k] + size[k] - 1));
    WindowPlace {
        face,
        gaze,
        tiles,
        corner,
        size,
        origins,
    }
}

impl SampleWindow {
    /// Its pictures as they are before coding.
    #[must_use]
    pub fn pictures(&self) -> Vec<Picture> {
        let groups = self.tiles.iter().map(|tile| (tile.at, &tile.group));
        joined(self.size, &groups.collect::<Vec<_>>())
    }

    /// Its pictures as a pack shows them whose finest level has this quantiser.
    ///
    /// # Errors
    /// As of coding and decoding.
    pub fn shown(&self, plan: &PreparationPlan, finest: u8) -> Result<Vec<Picture>, MediaError> {
        let coded = self.tiles.iter().map(|tile| {
            let rate = rate_of_tile(
                Rate::Quantiser(finest),
                &tile.group,
                plan.description.colour,
            );
            let (pictures, _) = coded(plan, rate, &tile.group)?;
            Ok((tile.at, pictures))
        });
        let coded = coded.collect::<Result<Vec<_>, MediaError>>()?;
        let groups: Vec<_> = coded.iter().map(|(at, group)| (*at, group)).collect();
        Ok(joined(self.size, &groups))
    }

    /// Frames of its group.
    #[must_use]
    pub fn frames(&self) -> usize {
        self.tiles.first().map_or(0, |tile| tile.group.len())
    }

    /// Its tiles one by one, each a group of pictures.
    pub fn groups(&self) -> impl Iterator<Item = &[Picture]> {
        self.tiles.iter().map(|tile| &tile.group[..])
    }
}

/// A group as it is shown when it is coded so, and its bytes.
///
/// # Errors
/// As of coding and decoding.
pub fn coded(
    plan: &PreparationPlan,
    rate: Rate,
    group: &[Picture],
) -> Result<(Vec<Picture>, usize), MediaError> {
    let Some(first) = group.first() else {
        return Ok((Vec::new(), 0));
    };
    let about = &plan.description;
    let settings = EncodeSettings {
        codec: about.codec,
        rate,
        frame_rate: about.frame_rate.map(|n| n.min(i32::MAX as u32) as i32),
        speed: plan.speed.at_level(0),
    };
    let units = encode_group(&settings, group)?;
    let mut decoder = GroupDecoder::new(about.codec, [first.width, first.height])?;
    let pictures = units.iter().zip(0..).map(|(unit, frame)| {
        let (picture, _) = decoder.decode(unit, frame)?;
        Ok(picture)
    });
    let pictures = pictures.collect::<Result<Vec<_>, MediaError>>()?;
    Ok((pictures, units.iter().map(Vec::len).sum()))
}

/// Pictures that are put side by side, frame by frame.
fn joined(size: [u32; 2], groups: &[([u32; 2], &Vec<Picture>)]) -> Vec<Picture> {
    let frames = groups
        .iter()
        .map(|(_, group)| group.len())
        .min()
        .unwrap_or(0);
    let frame = |frame: usize| {
        let mut whole = Picture::filled(size[0], size[1], [0, 128, 128]);
        for (at, group) in groups {
            put(&mut whole, &group[frame], *at);
        }
        whole
    };
    (0..frames).map(frame).collect()
}

/// Puts a picture into a larger one at an even place.
fn put(whole: &mut Picture, part: &Picture, at: [u32; 2]) {
    for plane in 0..3 {
        let half = u32::from(plane > 0);
        let [across, _] = whole.plane_size(plane);
        let [width, _] = part.plane_size(plane);
        let rows = part.planes[plane].chunks_exact(width as usize);
        for (y, row) in (at[1] >> half..).zip(rows) {
            let from = (y * across + (at[0] >> half)) as usize;
            whole.planes[plane][from..][..row.len()].copy_from_slice(row);
        }
    }
}

impl PreparationPlan {
    /// Whether quantisers are to be looked for before anything is coded.
    #[must_use]
    pub fn looks_for_quantisers(&self) -> bool {
        self.description.quality_by_tile
    }

    /// The same with this quantiser for the finest level and those that follow from it for the
    /// others, where quantisers are to be looked for.
    #[must_use]
    pub fn with_finest(mut self, finest: u8) -> Self {
        if self.description.quality_by_tile {
            let quantisers = ladder(finest, self.grid.levels);
            self.rates = quantisers.iter().map(|q| Rate::Quantiser(*q)).collect();
            self.description.quality = quantisers;
        }
        self
    }

    /// Colour of what is looked at.
    #[must_use]
    pub fn colour(&self) -> Colour {
        self.description.colour
    }
}
