//! Which bytes of the file are needed, in which order, and what for?

use crate::page_player::PagePlayer;
use crate::stretches::{Need, Part, PictureNeed};
use foveal_core::content::demand::Content;
use foveal_core::content::opened::Opened;
use foveal_core::content::scene::Scene;
use foveal_core::content::video::Video;
use foveal_core::content::video::bytes::frame_times::FRAME_TIMES;
use foveal_core::content::video::bytes::sound::SOUND;
use foveal_core::content::video::grid::tile_grid::{Cut, Tile};
use foveal_core::content::video::units::VideoUnits;
use foveal_core::pack::unit::UnitId;
use foveal_core::pack::{TableEntry, UnitPlace};
use foveal_core::session::unit_states::Piece;
use std::collections::HashSet;

/// How far ahead bytes are fetched while the content plays, in seconds.
const AHEAD_S: f64 = 2.0;
/// Most units and pages that are asked for at once.
const MOST_NEEDS: usize = 4096;

/// Collects what is needed of a video, each page once.
struct Collected<'a> {
    video: &'a Video,
    needs: Vec<Need>,
    pages: HashSet<u32>,
    units: HashSet<UnitId>,
}

impl Collected<'_> {
    fn is_full(&self) -> bool {
        self.needs.len() >= MOST_NEEDS
    }

    /// All pages of a level in the group of a frame that are to come.
    fn pages_of(&mut self, level: u8, frame: u32) {
        for page in self.video.pages_of(level, frame) {
            self.page(page);
        }
    }

    fn page(&mut self, page: u32) {
        if let Some(place) = self.video.pack().index().page_place(page)
            && !self.video.is_settled(page)
            && self.pages.insert(page)
        {
            self.needs.push(Need::of(Part::Page(page), place));
        }
    }

    /// The picture of a frame of a tile.
    fn picture(&mut self, tile: Tile, frame: u32) {
        let unit = self.video.pack().unit(tile, frame);
        let Some(need) = self.unit(unit) else { return };
        self.units.insert(unit);
        let frames = self.video.pack().frames_of(unit);
        let [width, height] = self.video.grid().tile_size(tile);
        let picture = PictureNeed {
            unit,
            frame,
            first: frames.start,
            frames: frames.len() as u32,
            width,
            height,
        };
        self.needs.push(Need {
            picture: Some(picture),
            ..need
        });
    }

    /// The bytes of a tile that may be shown soon, once.
    fn ahead(&mut self, tile: Tile, frame: u32) {
        let unit = self.video.pack().unit(tile, frame);
        if let Some(need) = self.unit(unit)
            && self.units.insert(unit)
        {
            self.needs.push(Need {
                early: true,
                ahead: Some(unit),
                ..need
            });
        }
    }

    /// The chunk of a unit; before its page of the index has come, that page is asked for.
    fn unit(&mut self, unit: UnitId) -> Option<Need> {
        match self.video.place(unit) {
            UnitPlace::At(entry) => Some(Need::of(Part::Unit(unit), entry.range())),
            UnitPlace::OnPage { page, .. } => {
                self.page(page);
                None
            }
            UnitPlace::Lost => None,
        }
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
                self.ahead(Tile { x, y, ..tile }, frame);
            }
        }
    }
}

impl PagePlayer {
    /// What is to be fetched, decoded and taken now: first what is waited for, by what matters
    /// most, then side tables, then what is fetched ahead.
    pub fn needs(&mut self) -> &[Need] {
        let needs = match &self.pack.content {
            Opened::Video(video) => self.needs_of_video(video),
            Opened::Scene(scene) => self.needs_of_scene(scene),
        };
        let needs = needs.into_iter().take(MOST_NEEDS);
        let (ahead, mut needs): (Vec<_>, _) = needs.partition(|need| need.ahead.is_some());
        needs.extend(self.tables().map(|table| {
            let place = table.offset..table.offset + table.bytes;
            let early = true;
            Need {
                early,
                ..Need::of(Part::Table(table.name.clone()), place)
            }
        }));
        needs.extend(ahead);
        self.fetching.needs = needs;
        &self.fetching.needs
    }

    /// The side tables that are to come.
    fn tables(&self) -> impl Iterator<Item = &TableEntry> {
        let always = [(FRAME_TIMES, !self.is_poster), (SOUND, self.fetching.hears)];
        let [times, sound] = always.map(|(name, is_needed)| is_needed.then_some(name));
        let chosen_by = Video::tables_of(self.play.session().policy());
        let names = times
            .into_iter()
            .chain(chosen_by.iter().copied())
            .chain(sound);
        names.filter_map(|name| self.pack.table_to_come(name))
    }

    /// Whether tables by which the policy chooses are still to come.
    pub fn awaits_tables(&self) -> bool {
        let mut names = Video::tables_of(self.play.session().policy()).iter();
        names.any(|name| self.pack.table_to_come(name).is_some())
    }

    /// Asks for the sound from now on; whether it is still to come.
    pub fn awaits_sound(&mut self) -> bool {
        self.fetching.hears = true;
        self.pack.table_to_come(SOUND).is_some()
    }

    /// The chunks of units, as the session asks for them; the index pages for them are loaded.
    fn needs_of_scene(&self, scene: &Scene) -> Vec<Need> {
        let asked = self.play.session().requested().iter();
        let need = |piece: &Piece| match scene.place(piece.unit.unit) {
            UnitPlace::At(entry) => Some(Need::of(Part::Unit(piece.unit.unit), entry.range())),
            UnitPlace::OnPage { .. } | UnitPlace::Lost => None,
        };
        asked.filter_map(need).collect()
    }

    fn needs_of_video(&self, video: &Video) -> Vec<Need> {
        let mut all = Collected {
            video,
            needs: Vec::new(),
            pages: HashSet::new(),
            units: HashSet::new(),
        };
        let coarsest = video.grid().coarsest();
        let tile_of = |piece: &Piece| (video.pack().tile_of(piece.unit.unit), piece.frame);
        let wanted: Vec<(Tile, u32)> = self
            .play
            .session()
            .requested()
            .iter()
            .map(tile_of)
            .collect();
        let tick = self.play.session().wanted().map_or(0, |(tick, _)| tick);
        let frame = self.play.session().timeline().frame_of(tick);
        all.pages_of(coarsest, frame);
        let is_base = |tile: &Tile| tile.level == coarsest;
        for (tile, frame) in wanted.iter().filter(|(tile, _)| is_base(tile)) {
            all.picture(*tile, *frame);
        }
        // A saccade must not wait for the index.
        (0..coarsest)
            .rev()
            .for_each(|level| all.pages_of(level, frame));
        if let Some(next) = video.next_group(frame)
            && self.play.session().policy().policy.spends_a_budget()
        {
            // What is bought for this frame is weighed against the next group.
            (0..=coarsest).for_each(|level| all.pages_of(level, next));
        }
        for (tile, frame) in wanted.iter().filter(|(tile, _)| !is_base(tile)) {
            if self.coarse {
                all.block(*tile, *frame);
            }
            all.picture(*tile, *frame);
        }
        if self.is_moving() {
            self.look_ahead(&mut all, tick);
        }
        all.needs
    }

    /// What the same tiles need in the next groups, soonest first.
    fn look_ahead(&self, all: &mut Collected<'_>, tick: u64) {
        let Some((_, pieces)) = self.play.session().wanted() else {
            return;
        };
        let pack = all.video.pack();
        let tiles: Vec<Tile> = pieces.iter().map(|it| pack.tile_of(it.unit.unit)).collect();
        let timeline = self.play.session().timeline();
        let groups = &all.video.pack().description().groups;
        let shortest = u64::from(groups.first().copied().unwrap_or(1));
        let until = timeline.time_of(tick).0 + AHEAD_S;
        let round = timeline.frames();
        // What follows in the units that are shown now.
        let frame = timeline.frame_of(tick);
        tiles.iter().for_each(|tile| all.ahead(*tile, frame));
        let mut next = tick;
        loop {
            let frame = next % round;
            // Groups start over with every round.
            next += (shortest - frame % shortest).min(round - frame);
            if timeline.time_of(next).0 > until || all.is_full() {
                return;
            }
            let frame = timeline.frame_of(next);
            for level in (0..all.video.grid().levels).rev() {
                all.pages_of(level, frame);
            }
            for tile in &tiles {
                if self.coarse && tile.level < all.video.grid().coarsest() {
                    all.block(*tile, frame);
                }
                all.ahead(*tile, frame);
            }
        }
    }
}
