//! Which frame is on screen, and what of it is there already?
//!
//! While one frame is shown the next one is decoded, what lies nearest to the gaze first. At its
//! time it is shown with what is there: a coarser level stands in for the rest, and all tiles are
//! of that frame. A frame that stays, paused or still, is refined until nothing is missing.

#[cfg(test)]
mod tests;

use crate::content::video::grid::level_map::histogram;
use crate::content::video::grid::tile_grid::{Tile, TileGrid};
use crate::session::aim::Aim;
use crate::session::figures::{Figures, Shown};
use crate::session::timeline::Timeline;
use crate::units::Seconds;
use crate::view::axes::angle_between;
use crate::view::picture::Picture;
use std::collections::{HashMap, HashSet};

/// How long a paused picture may stay as it is before the next one is shown unfinished.
const PATIENCE_S: f64 = 0.25;
/// Longest time that a frame is begun ahead of its own.
const MOST_LEAD_S: f64 = 1.0;
/// A picture is not chosen anew more often than this while the view moves.
const CHOOSE_EVERY_S: f64 = 0.03;

/// The moment that a step is made for.
pub struct Now {
    /// By the clock of whoever shows.
    pub wall: Seconds,
    /// In the content, counted on.
    pub media: Seconds,
    /// Whether the content moves.
    pub playing: bool,
    /// How long a picture is drawn while none can be shown: by [`Figures::slow_draw`].
    pub drawing: Seconds,
    /// Where the viewer looks.
    pub aim: Aim,
}

/// A tile of a frame.
pub type TileOfFrame = (Tile, u32);

/// What a decoder brings.
#[derive(Clone, Debug)]
pub struct Delivery {
    /// The tile.
    pub tile: Tile,
    /// The frame that was asked for.
    pub frame: u32,
    /// Frames of the tile that were decoded for it.
    pub decoded: u32,
    /// The picture; `None` where it is damaged.
    pub picture: Option<Picture>,
}

/// Where tiles come from.
pub trait Feed {
    /// Why it cannot go on.
    type Error;
    /// From now on these are wanted, in this order, and nothing else.
    fn want(&mut self, wanted: Vec<TileOfFrame>);
    /// What came since the last call.
    fn take(&mut self) -> Result<Vec<Delivery>, Self::Error>;
}

/// Where tiles are shown.
pub trait Easel {
    /// Why it cannot go on.
    type Error;
    /// From now on this frame is shown.
    fn begin_frame(&mut self, frame: u32);
    /// Takes a tile of a frame.
    fn upload(&mut self, tile: Tile, frame: u32, picture: Picture) -> Result<(), Self::Error>;
    /// Evicts all tiles but these and the coarsest level.
    fn retain(&mut self, wanted: &[Tile]);
    /// Resident tiles that hold another frame than the one shown.
    fn wrong_frame_tiles(&mut self) -> usize;
    /// Bytes of GPU memory in use.
    fn gpu_bytes(&mut self) -> u64;
}

/// Who says which tiles are wanted.
pub trait Chooses {
    /// Why it cannot go on.
    type Error;
    /// The tiles to show of a frame, the whole coarsest level included.
    fn choose(&mut self, frame: u32, aim: &Aim) -> Result<Vec<Tile>, Self::Error>;
    /// Whether the choice for `now` could be another than for `before`.
    fn differs(&self, now: &Aim, before: &Aim) -> bool;
}

/// Frames on their way to the screen.
pub struct Stage<F, E> {
    grid: TileGrid,
    timeline: Timeline,
    /// Where tiles come from.
    pub feed: F,
    /// Where they are shown.
    pub easel: E,
    shown: Option<Staged>,
    coming: Option<Staged>,
    /// The viewer went elsewhere in time, and what is on screen is no longer before what comes.
    jumped: bool,
    /// How long a frame is on its way, in seconds, where that is longer than it is shown: so far
    /// ahead of its time the next one is begun.
    lead: f64,
    /// The last tick whose coarsest level is damaged.
    damaged: Option<u64>,
}

/// One frame and its tiles.
struct Staged {
    tick: u64,
    frame: u32,
    aim: Aim,
    /// When its tiles were last chosen.
    chosen: f64,
    wanted: Vec<Tile>,
    /// Decoded and not yet on the GPU.
    decoded: HashMap<Tile, Picture>,
    /// On the GPU.
    resident: HashSet<Tile>,
    failed: HashSet<Tile>,
    begun: f64,
    /// How long drawing takes, as far as it was known by then.
    drawing: f64,
    /// When nothing was missing any more.
    complete: Option<f64>,
}

impl Staged {
    fn has(&self, tile: &Tile) -> bool {
        self.resident.contains(tile)
            || self.decoded.contains_key(tile)
            || self.failed.contains(tile)
    }

    fn missing(&self) -> impl Iterator<Item = Tile> + '_ {
        self.wanted.iter().copied().filter(|tile| !self.has(tile))
    }
}

impl<X, F: Feed<Error = X>, E: Easel<Error = X>> Stage<F, E> {
    /// An empty stage.
    #[must_use]
    pub fn new(grid: TileGrid, timeline: Timeline, feed: F, easel: E) -> Self {
        Self {
            grid,
            timeline,
            feed,
            easel,
            shown: None,
            coming: None,
            jumped: false,
            lead: 0.0,
            damaged: None,
        }
    }

    /// Begins anew on another device.
    pub fn restart(&mut self, easel: E) {
        self.easel = easel;
        self.fetch_anew();
    }

    /// Fetches all tiles once more: what shows them keeps none.
    pub fn fetch_anew(&mut self) {
        self.shown = None;
        self.coming = None;
    }

    /// How long the frame on screen is shown.
    pub fn period(&self) -> Seconds {
        let tick = self.shown_tick().unwrap_or(0);
        let [begin, end] = [tick, tick + 1].map(|tick| self.timeline.time_of(tick).0);
        Seconds(end - begin)
    }

    /// The frames in time.
    pub fn timeline(&self) -> &Timeline {
        &self.timeline
    }

    /// The tick on screen.
    pub fn shown_tick(&self) -> Option<u64> {
        self.shown.as_ref().map(|shown| shown.tick)
    }

    /// The tick that is worked on, and all tiles that it is to show.
    #[must_use]
    pub fn wanted(&self) -> Option<(u64, &[Tile])> {
        let staged = self.coming.as_ref().or(self.shown.as_ref())?;
        Some((staged.tick, &staged.wanted))
    }

    /// Other times of the frames, once they are known better.
    pub fn retime(&mut self, timeline: Timeline) {
        self.timeline = timeline;
    }

    /// Whether what is on screen is what is due, with nothing missing.
    pub fn is_settled(&self) -> bool {
        let complete = |shown: &Staged| shown.complete.is_some();
        self.coming.is_none() && self.shown.as_ref().is_some_and(complete)
    }

    /// When the frame that comes is due, by the content's time.
    pub fn next_due(&self) -> Option<Seconds> {
        let coming = self.coming.as_ref()?;
        Some(self.timeline.time_of(coming.tick))
    }

    /// Takes what was decoded, shows what is due, and orders what comes. Returns whether the
    /// picture changed.
    pub fn step(
        &mut self,
        now: &Now,
        choice: &mut impl Chooses<Error = X>,
        figures: &mut Figures,
    ) -> Result<bool, X> {
        let mut changed = self.take(now, figures)?;
        if self.is_due(now) {
            self.present(now, figures)?;
            changed = true;
        }
        self.order(now, choice)?;
        if !now.playing {
            changed |= self.settle(now, figures);
        }
        Ok(changed)
    }

    /// Puts what was decoded where it belongs.
    fn take(&mut self, now: &Now, figures: &mut Figures) -> Result<bool, X> {
        let mut changed = false;
        for done in self.feed.take()? {
            figures.decoded(u64::from(done.decoded) * self.grid.tile_pixels(done.tile));
            let (tile, frame) = (done.tile, done.frame);
            match done.picture {
                Some(picture) => changed |= self.place(tile, frame, picture, figures)?,
                None => self.give_up(tile, frame, figures),
            }
        }
        for staged in [&mut self.shown, &mut self.coming].into_iter().flatten() {
            if staged.complete.is_none() && staged.missing().next().is_none() {
                staged.complete = Some(now.wall.0);
                figures.complete(now.wall.0 - staged.begun);
            }
        }
        Ok(changed)
    }

    /// Keeps a picture for the frame that comes, or shows it in the one that is there.
    fn place(
        &mut self,
        tile: Tile,
        frame: u32,
        picture: Picture,
        figures: &mut Figures,
    ) -> Result<bool, X> {
        if let Some(coming) = self.coming.as_mut().filter(|coming| coming.frame == frame) {
            if coming.wanted.contains(&tile) {
                coming.decoded.insert(tile, picture);
            }
            return Ok(false);
        }
        match self.shown.as_mut().filter(|shown| shown.frame == frame) {
            Some(shown) if shown.wanted.contains(&tile) => {
                figures.uploaded(&picture);
                self.easel.upload(tile, frame, picture)?;
                shown.resident.insert(tile);
                Ok(true)
            }
            _ => Ok(false),
        }
    }

    /// Goes on without a tile: a coarser level stands in, and for the coarsest the frame before.
    fn give_up(&mut self, tile: Tile, frame: u32, figures: &mut Figures) {
        figures.damaged_tiles += 1;
        if let Some(coming) = self.coming.as_mut().filter(|coming| coming.frame == frame) {
            if tile.level < self.grid.coarsest() {
                coming.failed.insert(tile);
                return;
            }
            self.damaged = Some(coming.tick);
            self.coming = None;
            figures.damaged_frames += 1;
        } else if let Some(shown) = self.shown.as_mut().filter(|shown| shown.frame == frame) {
            shown.failed.insert(tile);
        }
    }

    /// Whether no frame at all has a whole coarsest level.
    #[must_use]
    pub fn is_hopeless(&self, figures: &Figures) -> bool {
        self.shown.is_none() && figures.damaged_frames >= self.timeline.frames()
    }

    /// The viewer goes elsewhere in time.
    pub fn jump(&mut self) {
        self.coming = None;
        self.lead = 0.0;
        self.jumped = true;
        self.damaged = None;
    }

    fn is_due(&self, now: &Now) -> bool {
        let Some(coming) = &self.coming else {
            return false;
        };
        let coarsest = self.grid.coarsest();
        let mut base = self.grid.tiles_of(coarsest);
        if coming.wanted.is_empty() || !base.all(|tile| coming.decoded.contains_key(&tile)) {
            return false;
        }
        if now.playing {
            return now.media.0 + 1e-4 >= self.timeline.time_of(coming.tick).0;
        }
        let waited = now.wall.0 - coming.begun;
        coming.complete.is_some() || self.shown.is_none() || waited > PATIENCE_S
    }

    /// Shows the frame that came, with the tiles that are there.
    fn present(&mut self, now: &Now, figures: &mut Figures) -> Result<(), X> {
        let Some(mut coming) = self.coming.take() else {
            return Ok(());
        };
        self.easel.begin_frame(coming.frame);
        for (tile, picture) in coming.decoded.drain() {
            figures.uploaded(&picture);
            self.easel.upload(tile, coming.frame, picture)?;
            coming.resident.insert(tile);
        }
        let tiles: Vec<Tile> = coming.resident.iter().copied().collect();
        self.easel.retain(&tiles);
        if now.playing {
            self.learn_lead(now, &coming);
        }
        let before = self.shown.as_ref().map(|shown| shown.tick);
        let overdue = now.media.0 > self.timeline.time_of(coming.tick + 1).0;
        let left_out = match before {
            Some(before) if now.playing && !self.jumped => coming.tick.saturating_sub(before + 1),
            _ => 0,
        };
        let follows = now.playing && before.is_some();
        let how = Shown {
            left_out,
            late: follows && overdue,
            incomplete: follows && coming.missing().next().is_some(),
        };
        figures.shown(now.wall, how);
        self.shown = Some(coming);
        self.jumped = false;
        self.count(figures);
        Ok(())
    }

    /// Begins frames earlier when they come after their time, though no earlier than they are on
    /// their way, and later again when they wait for it: a stall does not slow what follows.
    fn learn_lead(&mut self, now: &Now, shown: &Staged) {
        let [begin, end] = [shown.tick, shown.tick + 1].map(|tick| self.timeline.time_of(tick).0);
        let late = now.media.0 - end;
        self.lead = if late > 0.0 {
            let on_its_way = now.wall.0 - shown.begun;
            let longer = self.lead + 0.5 * (now.media.0 - begin);
            longer.min(on_its_way).min(MOST_LEAD_S)
        } else {
            let waited = shown.complete.map_or(0.0, |complete| now.wall.0 - complete);
            (self.lead * 0.95 - 0.5 * waited).max(0.0)
        };
    }

    /// Counts what is on screen.
    fn count(&mut self, figures: &mut Figures) {
        if let Some(shown) = &self.shown {
            let tiles: Vec<Tile> = shown.resident.iter().copied().collect();
            let pixels: u64 = tiles.iter().map(|tile| self.grid.tile_pixels(*tile)).sum();
            figures.histogram = histogram(&self.grid, &tiles);
            figures.share = pixels as f64 / self.grid.surface.pixels() as f64;
        }
        figures.wrong_frame_tiles += self.easel.wrong_frame_tiles() as u64;
        figures.gpu_bytes = self.easel.gpu_bytes();
    }

    /// Orders tiles for the frame that comes, or for the one that stays.
    fn order(&mut self, now: &Now, choice: &mut impl Chooses<Error = X>) -> Result<(), X> {
        let target = self.target(now);
        if !now.playing && self.shown_tick() == Some(target) {
            self.jumped = false;
            if self.coming.take().is_some() {
                self.want_missing(now);
            }
            return self.refine(now, choice);
        }
        // Damaged frames are given up one by one as they are due, not as fast as they fail.
        let due = self.timeline.tick_at(now.media);
        let is_given_up = |tick: u64| match now.playing {
            true => tick > due,
            false => tick == target,
        };
        if self.damaged.is_some_and(is_given_up) {
            self.coming = None;
            return Ok(());
        }
        // A frame under way is shown, however late, before another is begun; but not one that was
        // begun before it was known how long the one on screen is drawn.
        let period = self.period().0;
        let fits = |coming: &Staged| match now.playing {
            true if now.drawing.0 > coming.drawing + period => coming.tick >= target,
            true => coming.tick <= target + 1 || self.lead > 0.0,
            false => coming.tick == target,
        };
        if !self.coming.as_ref().is_some_and(fits) {
            self.coming = Some(self.staged(target, now));
        }
        self.choose_coming(now, choice)
    }

    /// The tick to work on: the one that is due, or playing the one after what is on screen.
    fn target(&self, now: &Now) -> u64 {
        let due = self.timeline.tick_at(now.media);
        if !now.playing {
            return due;
        }
        let shown = self.shown_tick().filter(|_| !self.jumped);
        let after = |tick: Option<u64>| tick.map_or(0, |tick| tick + 1);
        // What follows the frame on screen is shown once that has been drawn.
        let lead = shown.map_or(self.lead, |_| self.lead.max(now.drawing.0));
        let ahead = self.timeline.tick_at(Seconds(now.media.0 + lead));
        due.max(ahead).max(after(shown)).max(after(self.damaged))
    }

    fn staged(&self, tick: u64, now: &Now) -> Staged {
        Staged {
            tick,
            frame: self.timeline.frame_of(tick),
            aim: now.aim,
            chosen: f64::NEG_INFINITY,
            wanted: Vec::new(),
            decoded: HashMap::new(),
            resident: HashSet::new(),
            failed: HashSet::new(),
            begun: now.wall.0,
            drawing: now.drawing.0,
            complete: None,
        }
    }

    /// Chooses the tiles of the frame that comes, once, and again while it takes long.
    fn choose_coming(&mut self, now: &Now, choice: &mut impl Chooses<Error = X>) -> Result<(), X> {
        let Some(coming) = &mut self.coming else {
            return Ok(());
        };
        let first = coming.wanted.is_empty();
        let old = now.wall.0 - coming.chosen > CHOOSE_EVERY_S;
        let stays = !now.playing || now.wall.0 - coming.begun > 0.1;
        if first || old && stays && choice.differs(&now.aim, &coming.aim) {
            choose_tiles(coming, now, choice)?;
            self.want_missing(now);
        }
        Ok(())
    }

    /// Chooses the tiles of the frame that stays anew when the viewer looks elsewhere.
    fn refine(&mut self, now: &Now, choice: &mut impl Chooses<Error = X>) -> Result<(), X> {
        let Some(shown) = &mut self.shown else {
            return Ok(());
        };
        let old = now.wall.0 - shown.chosen > CHOOSE_EVERY_S;
        if old && choice.differs(&now.aim, &shown.aim) {
            shown.begun = now.wall.0;
            choose_tiles(shown, now, choice)?;
            self.want_missing(now);
        }
        Ok(())
    }

    /// Chooses anew at the next step, whoever looks wherever.
    pub fn forget_choice(&mut self) {
        if let Some(shown) = &mut self.shown {
            shown.chosen = f64::NEG_INFINITY;
            // Every view differs from one without pixels.
            shown.aim.view.size = [0, 0];
        }
        self.coming = None;
    }

    /// Whether a choice is still to be made for where the viewer looks.
    pub fn is_behind(&self, aim: &Aim, choice: &impl Chooses) -> bool {
        let shown = self.shown.as_ref();
        shown.is_none_or(|shown| choice.differs(aim, &shown.aim))
    }

    /// Evicts what is not wanted any more once all that is wanted is there.
    fn settle(&mut self, now: &Now, figures: &mut Figures) -> bool {
        let Some(shown) = &mut self.shown else {
            return false;
        };
        if shown.complete.is_none() && shown.missing().next().is_none() {
            shown.complete = Some(now.wall.0);
        }
        let stale = |tile: &Tile| !shown.wanted.contains(tile);
        let gone = shown.complete.is_some() && shown.resident.iter().any(stale);
        if gone {
            let wanted: HashSet<Tile> = shown.wanted.iter().copied().collect();
            shown.resident.retain(|tile| wanted.contains(tile));
            self.easel.retain(&shown.wanted);
        }
        self.count(figures);
        gone
    }

    /// Orders what is missing: the coarsest level first, then by distance to the gaze.
    pub fn want_missing(&mut self, now: &Now) {
        let Some(staged) = self.coming.as_mut().or(self.shown.as_mut()) else {
            return;
        };
        let (gaze, coarsest) = (now.aim.gaze.gaze_in_content, self.grid.coarsest());
        let mut order: Vec<(bool, f64, Tile)> = staged
            .missing()
            .map(|tile| {
                let angle = angle_between(gaze, self.grid.centre(tile)).0;
                (tile.level != coarsest, angle, tile)
            })
            .collect();
        order.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        let frame = staged.frame;
        let order = order.into_iter().map(|(.., tile)| (tile, frame));
        self.feed.want(order.collect());
    }
}

/// Chooses what a frame shows.
fn choose_tiles<X>(
    staged: &mut Staged,
    now: &Now,
    choice: &mut impl Chooses<Error = X>,
) -> Result<(), X> {
    staged.wanted = choice.choose(staged.frame, &now.aim)?;
    staged.aim = now.aim;
    staged.chosen = now.wall.0;
    staged.complete = None;
    staged
        .decoded
        .retain(|tile, _| staged.wanted.contains(tile));
    Ok(())
}
