//! How do tiles get decoded while a window goes on?
//!
//! One thread hands the decode pool a few tiles at a time, so that what is wanted can change at any
//! moment: only what has begun is finished in vain.

use anyhow::bail;
use foveal_core::content::video::grid::tile_grid::Tile;
use foveal_core::session::playback::{Delivery, Feed, TileOfFrame};
use foveal_media::tiles::decode_pool::{DecodePool, DecodedTile};
use std::collections::{HashSet, VecDeque};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Tiles under way for each decoding thread.
const AHEAD: usize = 2;
/// The window is not woken more often than this.
const LEAST_SLEEP: Duration = Duration::from_millis(8);

/// Decodes what is wanted, in that order.
pub(crate) struct DecodeFeed {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
    /// The pack, for messages.
    path: PathBuf,
    /// Damage was told of.
    told: bool,
}

#[derive(Default)]
struct Shared {
    state: Mutex<State>,
    wake: Condvar,
}

/// Bounded by what was wanted last and what is under way.
#[derive(Default)]
struct State {
    queue: VecDeque<TileOfFrame>,
    under_way: HashSet<TileOfFrame>,
    done: Vec<DecodedTile>,
    stop: bool,
}

impl DecodeFeed {
    /// Begins to decode with a pool of `jobs` threads; `woken` is called when something is done, at
    /// most every 8 ms.
    pub(crate) fn new(
        path: PathBuf,
        pool: DecodePool,
        jobs: usize,
        woken: impl Fn() + Send + 'static,
    ) -> anyhow::Result<Self> {
        let shared = Arc::new(Shared::default());
        let theirs = Arc::clone(&shared);
        let thread = std::thread::Builder::new()
            .name("decode feed".to_owned())
            .spawn(move || theirs.work(pool, jobs.max(1) * AHEAD, &woken))?;
        Ok(Self {
            shared,
            thread: Some(thread),
            path,
            told: false,
        })
    }

    /// The pack.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// What the stage is given of a tile, of the frame that was asked for.
    fn delivery(&mut self, done: DecodedTile) -> anyhow::Result<Delivery> {
        let DecodedTile { tile, frame, .. } = done;
        let picture = match done.picture {
            Ok((picture, number)) if number == i64::from(frame) => Some(picture),
            Ok((_, number)) => bail!(
                "{}: asked for frame {frame} of {tile:?}, the decoder gave {number}",
                self.path.display()
            ),
            Err(error) => {
                if !std::mem::replace(&mut self.told, true) {
                    let Tile { level, face, x, y } = tile;
                    crate::report::output::say(&format!(
                        "{}: level {level}, face {face}, column {x}, row {y} cannot be decoded at \
                         frame {frame}; what there is else is shown ({error}; `foveal verify` \
                         lists all damage)",
                        self.path.display(),
                    ));
                }
                None
            }
        };
        let decoded = done.decoded;
        Ok(Delivery {
            tile,
            frame,
            decoded,
            picture,
        })
    }
}

impl Feed for DecodeFeed {
    type Error = anyhow::Error;

    fn want(&mut self, wanted: Vec<TileOfFrame>) {
        let mut state = self.shared.lock();
        let done: HashSet<TileOfFrame> = state
            .done
            .iter()
            .map(|done| (done.tile, done.frame))
            .collect();
        let under_way = &state.under_way;
        let missing = |wanted: &TileOfFrame| !under_way.contains(wanted) && !done.contains(wanted);
        let queue = wanted.into_iter().filter(missing).collect();
        state.queue = queue;
        drop(state);
        self.shared.wake.notify_one();
    }

    fn take(&mut self) -> anyhow::Result<Vec<Delivery>> {
        let done = std::mem::take(&mut self.shared.lock().done);
        done.into_iter().map(|done| self.delivery(done)).collect()
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
            state.under_way.remove(&(done.tile, done.frame));
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
                let Some((tile, frame)) = state.queue.pop_front() else {
                    break;
                };
                state.under_way.insert((tile, frame));
                pool.request(tile, frame);
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
