//! Which bytes of the file are needed, in which order?

use crate::page_player::PagePlayer;
use foveal_core::content::demand::Content;
use foveal_core::content::opened::Opened;
use foveal_core::content::scene::Scene;
use foveal_core::content::video::Video;
use foveal_core::content::video::grid::tile_grid::{Cut, Tile};
use foveal_core::content::video::units::VideoUnits;
use foveal_core::pack::UnitPlace;
use foveal_core::pack::unit::UnitId;
use foveal_core::session::unit_states::Piece;
use std::collections::HashSet;

/// Numbers of a row: kind, number, offset, bytes, frame, first frame of the unit, frames of the
/// unit, width, height, level.
pub const ROW: usize = 10;
/// How far ahead bytes are fetched while the content plays, in seconds.
const AHEAD_S: f64 = 2.0;
/// Most rows that are returned at once.
const MOST_ROWS: usize = 4096;

/// What a row asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Kind {
    /// A page of the index.
    Page = 0,
    /// A unit, and the picture of a frame of it.
    Picture = 1,
    /// A unit that may be needed soon: only its bytes.
    Bytes = 2,
    /// A unit whose chunk is handed over as it is.
    Whole = 3,
}

/// Collects rows, each unit and page once.
struct Rows<'a> {
    video: &'a Video,
    rows: Vec<f64>,
    pages: HashSet<u32>,
    units: HashSet<UnitId>,
}

impl Rows<'_> {
    fn push(&mut self, row: [f64; ROW]) {
        if self.rows.len() < MOST_ROWS * ROW {
            self.rows.extend(row);
        }
    }

    fn page(&mut self, page: u32) {
        let Some(place) = self.video.pack().index().page_place(page) else {
            return;
        };
        let is_gone = self.video.is_settled(page);
        if !is_gone && self.pages.insert(page) {
            let (offset, bytes) = (place.start as f64, (place.end - place.start) as f64);
            let kind = f64::from(Kind::Page as u8);
            let number = f64::from(page);
            self.push([kind, number, offset, bytes, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        }
    }

    /// All pages of a level in the group of a frame.
    fn pages_of(&mut self, level: u8, frame: u32) {
        for page in self.video.pages_of(level, frame) {
            self.page(page);
        }
    }

    fn tile(&mut self, kind: Kind, tile: Tile, frame: u32) {
        let pack = self.video.pack();
        let unit = pack.unit(tile, frame);
        let entry = match self.video.place(unit) {
            UnitPlace::At(entry) => entry,
            UnitPlace::OnPage { page, .. } => return self.page(page),
            UnitPlace::Lost => return,
        };
        if kind == Kind::Bytes && !self.units.insert(unit) {
            return;
        }
        self.units.insert(unit);
        let frames = pack.frames_of(unit);
        let [width, height] = self.video.grid().tile_size(tile);
        self.push([
            f64::from(kind as u8),
            f64::from(unit.0),
            entry.offset as f64,
            f64::from(entry.bytes),
            f64::from(frame),
            f64::from(frames.start),
            frames.len() as f64,
            f64::from(width),
            f64::from(height),
            f64::from(tile.level),
        ]);
    }

    /// The 3 x 3 tiles that a tile is one of, whichever of them it is: what a host sees is the
    /// block.
    fn block(&mut self, tile: Tile, frame: u32) {
        let [columns, rows] = match self.video.grid().cut {
            Cut::Tile(_) => self.video.grid().tiles(tile.level),
            Cut::Grid(cells) => cells,
        };
        let [x, y] = [tile.x, tile.y].map(|place| place - place % 3);
        for y in y..(u32::from(y) + 3).min(rows) as u16 {
            for x in x..(u32::from(x) + 3).min(columns) as u16 {
                self.tile(Kind::Bytes, Tile { x, y, ..tile }, frame);
            }
        }
    }
}

impl PagePlayer {
    /// What is to be fetched and decoded now, first what matters most: [`ROW`] numbers each.
    pub fn needs(&self) -> Vec<f64> {
        match &self.pack.content {
            Opened::Video(video) => self.needs_of_video(video),
            Opened::Scene(scene) => self.needs_of_scene(scene),
        }
    }

    /// The chunks of units, as the session asks for them; the index pages for them are loaded.
    fn needs_of_scene(&self, scene: &Scene) -> Vec<f64> {
        let pack = scene.pack();
        let asked = self.session.requested().iter().take(MOST_ROWS);
        let row = |piece: &Piece| {
            let unit = piece.unit.unit;
            let entry = pack.entry(unit);
            let (kind, number) = (f64::from(Kind::Whole as u8), f64::from(unit.0));
            let (offset, bytes) = (entry.offset as f64, f64::from(entry.bytes));
            let level = f64::from(pack.level_of(unit));
            [kind, number, offset, bytes, 0.0, 0.0, 1.0, 0.0, 0.0, level]
        };
        asked.flat_map(row).collect()
    }

    fn needs_of_video(&self, video: &Video) -> Vec<f64> {
        let mut rows = Rows {
            video,
            rows: Vec::new(),
            pages: HashSet::new(),
            units: HashSet::new(),
        };
        let coarsest = video.grid().coarsest();
        let tile_of = |piece: &Piece| (video.pack().tile_of(piece.unit.unit), piece.frame);
        let wanted: Vec<(Tile, u32)> = self.session.requested().iter().map(tile_of).collect();
        let tick = self.session.wanted().map_or(0, |(tick, _)| tick);
        let frame = self.session.timeline().frame_of(tick);
        rows.pages_of(coarsest, frame);
        let is_base = |tile: &Tile| tile.level == coarsest;
        for (tile, frame) in wanted.iter().filter(|(tile, _)| is_base(tile)) {
            rows.tile(Kind::Picture, *tile, *frame);
        }
        // A saccade must not wait for the index.
        (0..coarsest)
            .rev()
            .for_each(|level| rows.pages_of(level, frame));
        if let Some(next) = video.next_group(frame)
            && self.session.policy().policy.spends_a_budget()
        {
            // What is bought for this frame is weighed against the next group.
            (0..=coarsest).for_each(|level| rows.pages_of(level, next));
        }
        for (tile, frame) in wanted.iter().filter(|(tile, _)| !is_base(tile)) {
            if self.coarse {
                rows.block(*tile, *frame);
            }
            rows.tile(Kind::Picture, *tile, *frame);
        }
        if self.is_moving() {
            self.look_ahead(&mut rows, tick);
        }
        rows.rows
    }

    /// What the same tiles need in the next groups, soonest first.
    fn look_ahead(&self, rows: &mut Rows<'_>, tick: u64) {
        let Some((_, pieces)) = self.session.wanted() else {
            return;
        };
        let pack = rows.video.pack();
        let tiles: Vec<Tile> = pieces.iter().map(|it| pack.tile_of(it.unit.unit)).collect();
        let timeline = self.session.timeline();
        let groups = &rows.video.pack().description().groups;
        let shortest = u64::from(groups.first().copied().unwrap_or(1));
        let until = timeline.time_of(tick).0 + AHEAD_S;
        let round = timeline.frames();
        // What follows in the units that are shown now.
        let frame = timeline.frame_of(tick);
        tiles
            .iter()
            .for_each(|tile| rows.tile(Kind::Bytes, *tile, frame));
        let mut next = tick;
        loop {
            let frame = next % round;
            // Groups start over with every round.
            next += (shortest - frame % shortest).min(round - frame);
            if timeline.time_of(next).0 > until || rows.rows.len() >= MOST_ROWS * ROW {
                return;
            }
            let frame = timeline.frame_of(next);
            for level in (0..rows.video.grid().levels).rev() {
                rows.pages_of(level, frame);
            }
            for tile in &tiles {
                if self.coarse && tile.level < rows.video.grid().coarsest() {
                    rows.block(*tile, frame);
                }
                rows.tile(Kind::Bytes, *tile, frame);
            }
        }
    }
}
