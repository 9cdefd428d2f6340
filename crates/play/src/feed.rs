//! How do units get decoded while a window goes on?
//!
//! One thread hands the decode pool a few tiles at a time, so that what is wanted can change at any
//! moment: work that has started is finished even if it is no longer wanted.

use crate::decoding::Decoding;
use crate::error::PlayError;
use foveal_core::content::payload::Payload;
use foveal_core::content::unit::{AssetId, UnitRef};
use foveal_core::content::video::grid::tile_grid::Tile;
use foveal_core::session::actions::{Cache, SessionEvent};
use foveal_core::session::unit_states::Piece;
use foveal_media::pack::pack_file::PackFile;
use foveal_media::tiles::decode_pool::{DecodePool, DecodedTile};
use std::collections::{HashSet, VecDeque};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Tiles under way for each decoding thread.
const AHEAD: usize = 2;
/// The window is not woken more often than this.
const LEAST_SLEEP: Duration = Duration::from_millis(8);

/// Decodes what is wanted, in that order.
#[derive(Debug)]
pub(crate) struct DecodeFeed {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
    file: Arc<PackFile>,
    tell: fn(&str),
    /// Damage was told of.
    told: bool,
}

#[derive(Debug, Default)]
struct Shared {
    state: Mutex<State>,
    wake: Condvar,
}

/// Bounded by what was wanted last and what is under way.
#[derive(Debug, Default)]
struct State {
    queue: VecDeque<Piece>,
    under_way: HashSet<Piece>,
    done: Vec<DecodedTile>,
    stop: bool,
}

impl DecodeFeed {
    /// Begins to decode a pack; `woken` is called when something is done, at most every 8 ms, and
    /// `tell` with what a person should know.
    ///
    /// # Errors
    /// Nothing decodes this pack, or no thread can be had.
    pub(crate) fn new(
        file: &Arc<PackFile>,
        decoding: Decoding,
        tell: fn(&str),
        woken: impl Fn() + Send + 'static,
    ) -> Result<Self, PlayError> {
        let shared = Arc::new(Shared::default());
        let theirs = Arc::clone(&shared);
        let pool = decoding.pool(Arc::clone(file))?;
        let most = decoding.jobs.max(1) * AHEAD;
        let thread = std::thread::Builder::new()
            .name("decode feed".to_owned())
            .spawn(move || theirs.work(pool, most, &woken))
            .map_err(PlayError::Thread)?;
        Ok(Self {
            shared,
            thread: Some(thread),
            file: Arc::clone(file),
            tell,
            told: false,
        })
    }

    /// From now on these are wanted, in this order, and nothing else.
    pub(crate) fn want(&mut self, wanted: &[Piece]) {
        let mut state = self.shared.lock();
        let done: HashSet<Piece> = state.done.iter().map(piece_of).collect();
        let under_way = &state.under_way;
        let missing = |wanted: &&Piece| !under_way.contains(wanted) && !done.contains(wanted);
        let queue = wanted.iter().filter(missing).copied().collect();
        state.queue = queue;
        drop(state);
        self.shared.wake.notify_one();
    }

    /// What came since the last call, for the session; what was decoded goes into the cache.
    ///
    /// # Errors
    /// A decoder gave another frame than it was asked for.
    pub(crate) fn take(
        &mut self,
        cache: &mut Cache<Payload>,
    ) -> Result<Vec<SessionEvent>, PlayError> {
        let done = std::mem::take(&mut self.shared.lock().done);
        let events = done.into_iter().map(|done| self.event(done, cache));
        events.collect()
    }

    fn event(
        &mut self,
        done: DecodedTile,
        cache: &mut Cache<Payload>,
    ) -> Result<SessionEvent, PlayError> {
        let (piece, frames) = (piece_of(&done), done.decoded);
        let tile = self.file.pack().tile_of(done.unit);
        let path = self.file.path();
        match done.picture {
            Ok((picture, number)) if number == i64::from(done.frame) => {
                cache.insert(piece, Payload::Picture(picture));
                Ok(SessionEvent::Decoded { piece, frames })
            }
            Ok((_, number)) => Err(PlayError::WrongFrame {
                path: path.to_owned(),
                tile,
                frame: done.frame,
                number,
            }),
            Err(error) => {
                if !std::mem::replace(&mut self.told, true) {
                    let Tile { level, face, x, y } = tile;
                    (self.tell)(&format!(
                        "{}: level {level}, face {face}, column {x}, row {y} cannot be decoded at \
                         frame {}; what there is else is shown ({error}; `foveal verify` lists all \
                         damage)",
                        path.display(),
                        done.frame,
                    ));
                }
                Ok(SessionEvent::Damaged { piece, frames })
            }
        }
    }
}

fn piece_of(done: &DecodedTile) -> Piece {
    Piece {
        unit: UnitRef {
            asset: AssetId(0),
            unit: done.unit,
        },
        frame: done.frame,
    }
}

impl Drop for DecodeFeed {
    fn drop(&mut self) {
        self.shared.lock().stop = true;
        self.shared.wake.notify_one();
        if let Some(thread) = self.thread.take() {
            // A thread that panicked has already said so.
            let _ = thread.join();
        }
    }
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn work(&self, mut pool: DecodePool, most: usize, woken: &impl Fn()) {
        let mut woke = Instant::now();
        while self.order(&mut pool, most) {
            let Some(done) = pool.receive(None) else {
                continue;
            };
            let mut state = self.lock();
            state.under_way.remove(&piece_of(&done));
            state.done.push(done);
            let over = state.queue.is_empty() && state.under_way.is_empty();
            drop(state);
            if over || woke.elapsed() >= LEAST_SLEEP {
                woke = Instant::now();
                woken();
            }
        }
    }

    /// Hands the pool what comes next, once there is something under way; `false` to stop.
    fn order(&self, pool: &mut DecodePool, most: usize) -> bool {
        let mut state = self.lock();
        loop {
            if state.stop {
                return false;
            }
            while state.under_way.len() < most {
                let Some(piece) = state.queue.pop_front() else {
                    break;
                };
                state.under_way.insert(piece);
                pool.request(piece.unit.unit, piece.frame);
            }
            if !state.under_way.is_empty() {
                return true;
            }
            state = self
                .wake
                .wait(state)
                .unwrap_or_else(PoisonError::into_inner);
        }
    }
}
