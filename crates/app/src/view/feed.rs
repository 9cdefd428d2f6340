//! How do tiles get decoded while a window goes on?
//!
//! One thread hands the decode pool a few tiles at a time, so that what is wanted can change at any
//! moment: only what has begun is finished in vain.

use foveal_core::asset::tile_grid::Tile;
use foveal_media::decode_pool::{DecodePool, DecodedTile};
use std::collections::{HashSet, VecDeque};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Tiles under way for each decoding thread.
const AHEAD: usize = 2;
/// The window is not woken more often than this.
const LEAST_SLEEP: Duration = Duration::from_millis(8);

/// A tile of a frame.
pub(crate) type TileOfFrame = (Tile, u32);

/// Decodes what is wanted, in that order.
pub(crate) struct DecodeFeed {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
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
        })
    }

    /// From now on these are wanted, in this order, and nothing else.
    pub(crate) fn want(&self, wanted: impl IntoIterator<Item = TileOfFrame>) {
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

    /// What was decoded since the last call.
    pub(crate) fn take(&self) -> Vec<DecodedTile> {
        std::mem::take(&mut self.shared.lock().done)
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
