//! How do units get decoded while a window goes on?
//!
//! One thread hands a decoder a few pieces at a time, so that what is wanted can change at any
//! moment: work that has started is finished even if it is no longer wanted.

use crate::error::PlayError;
use foveal_core::content::payload::Payload;
use foveal_core::session::actions::{Cache, SessionEvent};
use foveal_core::session::unit_states::Piece;
use std::collections::{HashSet, VecDeque};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// The window is not woken more often than this.
const LEAST_SLEEP: Duration = Duration::from_millis(8);

/// Who makes of a piece what is drawn.
pub(crate) trait Decoder: Send {
    /// Asks for a piece, after all that was asked for before.
    fn request(&mut self, piece: Piece);

    /// The next piece that is done, once it is; `None` where none is under way.
    fn receive(&mut self) -> Option<Done>;
}

/// A piece that a decoder is done with.
#[derive(Debug)]
pub(crate) struct Done {
    pub(crate) piece: Piece,
    /// Frames decoded for it, those to catch up included.
    pub(crate) frames: u32,
    pub(crate) payload: Result<Payload, Failure>,
}

/// Why a piece has no payload.
#[derive(Debug)]
pub(crate) enum Failure {
    /// It is damaged: what a person should know.
    Damaged(String),
    /// The decoder does what it must not.
    Wrong(PlayError),
}

/// Decodes what is wanted, in that order.
#[derive(Debug)]
pub(crate) struct DecodeFeed {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
    tell: fn(&str),
    /// Damage was reported.
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
    done: Vec<Done>,
    stop: bool,
}

impl DecodeFeed {
    /// Begins to decode, at most `most` pieces at once; `woken` is called when something is done,
    /// at most every 8 ms, and `tell` with what a person should know.
    ///
    /// # Errors
    /// No thread can be had.
    pub(crate) fn new(
        decoder: Box<dyn Decoder>,
        most: usize,
        tell: fn(&str),
        woken: impl Fn() + Send + 'static,
    ) -> Result<Self, PlayError> {
        let shared = Arc::new(Shared::default());
        let theirs = Arc::clone(&shared);
        let thread = std::thread::Builder::new()
            .name("decode feed".to_owned())
            .spawn(move || theirs.work(decoder, most, &woken))
            .map_err(PlayError::Thread)?;
        Ok(Self {
            shared,
            thread: Some(thread),
            tell,
            told: false,
        })
    }

    /// From now on these are wanted, in this order, and nothing else.
    pub(crate) fn want(&mut self, wanted: &[Piece]) {
        let mut state = self.shared.lock();
        let done: HashSet<Piece> = state.done.iter().map(|done| done.piece).collect();
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

    fn event(&mut self, done: Done, cache: &mut Cache<Payload>) -> Result<SessionEvent, PlayError> {
        let Done { piece, frames, .. } = done;
        match done.payload {
            Ok(payload) => {
                cache.insert(piece, payload);
                Ok(SessionEvent::Decoded { piece, frames })
            }
            Err(Failure::Wrong(error)) => Err(error),
            Err(Failure::Damaged(what)) => {
                if !std::mem::replace(&mut self.told, true) {
                    (self.tell)(&what);
                }
                Ok(SessionEvent::Damaged { piece, frames })
            }
        }
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

    fn work(&self, mut decoder: Box<dyn Decoder>, most: usize, woken: &impl Fn()) {
        let mut woke = Instant::now();
        while self.order(&mut *decoder, most) {
            let Some(done) = decoder.receive() else {
                continue;
            };
            let mut state = self.lock();
            state.under_way.remove(&done.piece);
            state.done.push(done);
            let over = state.queue.is_empty() && state.under_way.is_empty();
            drop(state);
            if over || woke.elapsed() >= LEAST_SLEEP {
                woke = Instant::now();
                woken();
            }
        }
    }

    /// Hands the decoder what comes next, once there is something under way; `false` to stop.
    fn order(&self, decoder: &mut dyn Decoder, most: usize) -> bool {
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
                decoder.request(piece);
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
