//! Which tile is decoded next?
//!
//! Frames come in the order in which they were asked for. Of one frame the coarsest level comes
//! first, which no picture can do without, and then what takes most decoding, so that no worker
//! begins the longest work when the others are done. What is expected of the next frame comes
//! before finer tiles of this one: a frame without a finer tile is shown, one without its coarsest
//! level is late. All else that is expected comes when nothing else can be taken. A tile is in the
//! hands of one worker at a time, as its pictures build on each other.

use foveal_core::content::video::grid::tile_grid::Tile;
use std::cmp::Reverse;
use std::collections::{BTreeMap, HashMap, VecDeque};

/// A share is one of workers x this of what is left, so that all workers come again.
const ROUNDS: u32 = 2;
/// Pictures that a batch takes at most; a tile that takes more is a batch of its own. What a worker
/// holds cannot be shown when a frame is due, and cannot be taken back.
const MOST_OF_BATCH: u32 = 4;

/// A frame of a tile.
pub(crate) type TileFrame = (Tile, u32);

/// A tile to be decoded.
#[derive(Debug)]
pub(crate) struct Job<T> {
    pub(crate) place: TileFrame,
    /// Pictures that are decoded for it, those to catch up included.
    pub(crate) pictures: u32,
    /// What it is decoded from.
    pub(crate) bytes: T,
}

/// What comes first is less.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Rank {
    /// Which of the frames that were asked for.
    turn: u64,
    is_finer: bool,
    pictures: Reverse<u32>,
    number: u64,
}

/// The tiles that wait for a worker.
#[derive(Debug)]
pub(crate) struct DecodeQueue<T> {
    asked: BTreeMap<Rank, Job<T>>,
    /// Pictures that all of them take.
    pictures: u32,
    /// What is expected, in the order in which it is decoded.
    ahead: VecDeque<Job<T>>,
    /// The frame that is expected next.
    soon: Option<u32>,
    /// The tiles that workers have, and of which frame.
    taken: HashMap<Tile, u32>,
    /// The frame that was asked for last.
    frame: Option<u32>,
    /// How many frames were asked for.
    turn: u64,
    /// How many tiles were asked for.
    number: u64,
}

impl<T> Default for DecodeQueue<T> {
    fn default() -> Self {
        Self {
            asked: BTreeMap::new(),
            pictures: 0,
            ahead: VecDeque::new(),
            soon: None,
            taken: HashMap::new(),
            frame: None,
            turn: 0,
            number: 0,
        }
    }
}

impl<T> DecodeQueue<T> {
    /// Adds a tile that is waited for; it is expected no more.
    pub(crate) fn ask(&mut self, job: Job<T>, is_coarsest: bool) {
        self.ahead.retain(|other| other.place != job.place);
        if self.frame != Some(job.place.1) {
            self.frame = Some(job.place.1);
            self.turn += 1;
        }
        self.number += 1;
        self.pictures += job.pictures;
        let rank = Rank {
            turn: self.turn,
            is_finer: !is_coarsest,
            pictures: Reverse(job.pictures),
            number: self.number,
        };
        self.asked.insert(rank, job);
    }

    /// Replaces what is expected: tiles that are decoded before anybody asks for them, those of the
    /// same tile in this order; those of the frame that comes `soon` first.
    pub(crate) fn expect(&mut self, soon: Option<u32>, jobs: impl Iterator<Item = Job<T>>) {
        self.soon = soon;
        self.ahead = jobs.filter(|job| !self.is_taken(job.place)).collect();
    }

    /// Takes back what was asked for and no worker has.
    pub(crate) fn cancel(&mut self) -> impl Iterator<Item = TileFrame> + use<T> {
        self.pictures = 0;
        let asked = std::mem::take(&mut self.asked);
        asked.into_values().map(|job| job.place)
    }

    /// What a worker, one of `workers`, decodes next: a fair share, at least one tile where one
    /// can be taken. Each of its tiles must be [given back](Self::give_back).
    pub(crate) fn take(&mut self, workers: u32) -> Vec<Job<T>> {
        let next = self.next();
        if next.is_none_or(|rank| rank.is_finer)
            && let Some(job) = self.take_ahead(next.is_some())
        {
            return vec![job];
        }
        let share = self.pictures / workers.saturating_mul(ROUNDS).max(1);
        let mut left = share.clamp(1, MOST_OF_BATCH);
        let mut batch: Vec<Job<T>> = Vec::new();
        while let Some(rank) = self.next() {
            let Reverse(pictures) = rank.pictures;
            if pictures > left && !batch.is_empty() {
                break;
            }
            left = left.saturating_sub(pictures);
            self.pictures -= pictures;
            if let Some(job) = self.asked.remove(&rank) {
                self.taken.insert(job.place.0, job.place.1);
                batch.push(job);
            }
        }
        batch
    }

    /// What is expected first, or first of the next frame, and can be taken.
    fn take_ahead(&mut self, is_of_next: bool) -> Option<Job<T>> {
        let comes = |job: &Job<T>| !is_of_next || self.soon == Some(job.place.1);
        let mut ahead = self.ahead.iter();
        let at = ahead.position(|job| comes(job) && self.is_free(job))?;
        let job = self.ahead.remove(at)?;
        self.taken.insert(job.place.0, job.place.1);
        Some(job)
    }

    /// A tile that was taken may be taken again.
    pub(crate) fn give_back(&mut self, tile: Tile) {
        self.taken.remove(&tile);
    }

    /// Whether a worker has this frame of the tile.
    pub(crate) fn is_taken(&self, (tile, frame): TileFrame) -> bool {
        self.taken.get(&tile) == Some(&frame)
    }

    /// Tiles that are waited for.
    pub(crate) fn asked(&self) -> usize {
        self.asked.len()
    }

    fn next(&self) -> Option<Rank> {
        let mut free = self.asked.iter().filter(|(_, job)| self.is_free(job));
        free.next().map(|(rank, _)| *rank)
    }

    fn is_free(&self, job: &Job<T>) -> bool {
        !self.taken.contains_key(&job.place.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tile(level: u8, x: u16) -> Tile {
        Tile {
            level,
            face: 0,
            x,
            y: 0,
        }
    }

    fn job(tile: Tile, frame: u32, pictures: u32) -> Job<()> {
        Job {
            place: (tile, frame),
            pictures,
            bytes: (),
        }
    }

    /// What a worker of so many takes.
    fn taken(queue: &mut DecodeQueue<()>, workers: u32) -> Vec<TileFrame> {
        let batch = queue.take(workers).into_iter();
        batch.map(|job| job.place).collect()
    }

    #[test]
    fn of_a_frame_the_coarsest_level_comes_first_and_then_the_longest_work() {
        let mut queue = DecodeQueue::default();
        queue.ask(job(tile(0, 1), 5, 2), false);
        queue.ask(job(tile(0, 2), 5, 6), false);
        queue.ask(job(tile(4, 0), 5, 1), true);
        queue.ask(job(tile(0, 3), 5, 6), false);
        // The next frame waits, whatever it takes.
        queue.ask(job(tile(4, 1), 6, 8), true);
        let order: Vec<_> = (0..5).flat_map(|_| taken(&mut queue, 64)).collect();
        let expected = [
            (tile(4, 0), 5),
            (tile(0, 2), 5),
            (tile(0, 3), 5),
            (tile(0, 1), 5),
            (tile(4, 1), 6),
        ];
        assert_eq!(order, expected);
        assert!(taken(&mut queue, 64).is_empty() && queue.asked() == 0);
    }

    #[test]
    fn workers_share_tiles_of_the_coarsest_level_one_worker_a_tile() {
        let mut queue = DecodeQueue::default();
        for frame in [5, 6] {
            (0..2).for_each(|x| queue.ask(job(tile(4, x), frame, 1), true));
        }
        assert_eq!(taken(&mut queue, 4), [(tile(4, 0), 5)]);
        assert_eq!(taken(&mut queue, 4), [(tile(4, 1), 5)]);
        // Its pictures build on each other.
        assert!(taken(&mut queue, 4).is_empty());
        queue.give_back(tile(4, 1));
        assert_eq!(taken(&mut queue, 4), [(tile(4, 1), 6)]);
        assert!(queue.is_taken((tile(4, 1), 6)) && !queue.is_taken((tile(4, 1), 5)));
    }

    #[test]
    fn a_batch_is_a_fair_share_of_what_is_left_and_at_least_a_tile() {
        let batches = |tiles: u16, pictures: u32, workers: u32| {
            let mut queue = DecodeQueue::default();
            (0..tiles).for_each(|x| queue.ask(job(tile(0, x), 0, pictures), false));
            let all = std::iter::from_fn(|| Some(taken(&mut queue, workers).len()));
            all.take_while(|count| *count > 0).collect::<Vec<usize>>()
        };
        assert_eq!(batches(12, 1, 2), [3, 2, 1, 1, 1, 1, 1, 1, 1]);
        assert_eq!(batches(40, 1, 2)[..3], [4, 4, 4], "not too many");
        assert_eq!(batches(3, 8, 2), [1, 1, 1], "a long one");
        assert_eq!(batches(5, 1, 16), [1; 5], "more workers than tiles");
        assert!(batches(0, 1, 16).is_empty());
    }

    #[test]
    fn what_is_expected_of_the_next_frame_comes_before_finer_tiles_and_the_rest_after_them() {
        let mut queue = DecodeQueue::default();
        let ahead = [(0, 6), (1, 6), (2, 7)];
        let ahead = ahead.map(|(x, frame)| job(tile(4, x), frame, 1));
        queue.ask(job(tile(4, 3), 5, 1), true);
        queue.ask(job(tile(0, 9), 5, 1), false);
        queue.expect(Some(6), ahead.into_iter());
        let order: Vec<_> = (0..5).flat_map(|_| taken(&mut queue, 64)).collect();
        let expected = [
            (tile(4, 3), 5),
            (tile(4, 0), 6),
            (tile(4, 1), 6),
            (tile(0, 9), 5),
            (tile(4, 2), 7),
        ];
        assert_eq!(order, expected);
    }

    #[test]
    fn what_is_asked_for_is_expected_no_more() {
        let mut queue = DecodeQueue::default();
        let ahead = [(0, 6), (1, 6), (0, 7), (1, 7)];
        let ahead = ahead.map(|(x, frame)| job(tile(4, x), frame, 1));
        queue.expect(Some(6), ahead.into_iter());
        assert_eq!(taken(&mut queue, 1), [(tile(4, 0), 6)]);
        queue.ask(job(tile(4, 1), 6, 1), true);
        assert_eq!(queue.asked(), 1);
        assert_eq!(taken(&mut queue, 1), [(tile(4, 1), 6)]);
        assert!(taken(&mut queue, 1).is_empty(), "both tiles are taken");
        queue.give_back(tile(4, 1));
        assert_eq!(taken(&mut queue, 1), [(tile(4, 1), 7)]);
        queue.expect(Some(7), std::iter::once(job(tile(4, 1), 7, 1)));
        queue.give_back(tile(4, 1));
        assert!(taken(&mut queue, 1).is_empty(), "a worker had it");
    }

    #[test]
    fn cancelling_takes_back_what_no_worker_has_and_leaves_what_is_expected() {
        let mut queue = DecodeQueue::default();
        (0..3).for_each(|x| queue.ask(job(tile(0, x), 5, 1), false));
        queue.expect(None, std::iter::once(job(tile(4, 0), 6, 1)));
        assert_eq!(taken(&mut queue, 8), [(tile(0, 0), 5)]);
        let back: Vec<_> = queue.cancel().collect();
        assert_eq!(back, [(tile(0, 1), 5), (tile(0, 2), 5)]);
        assert_eq!(taken(&mut queue, 8), [(tile(4, 0), 6)]);
        queue.ask(job(tile(0, 1), 5, 1), false);
        assert_eq!(taken(&mut queue, 8), [(tile(0, 1), 5)]);
    }
}
