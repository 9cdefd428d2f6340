//! How do units get decoded while a window goes on?
//!
//! One thread hands a decoder a few pieces at a time, so that what is wanted can change at any
//! moment: work that has started is finished even if it is no longer wanted.

use crate::at_once::Ahead;
use crate::error::PlayError;
use crate::options::Decoding;
use crate::player::Player;
use crate::supply::Supply;
use foveal_core::content::opened::Opened;
use foveal_core::session::decoder::{Decoded, Decoder, PackBytes};
use foveal_core::session::session::SessionSettings;
use foveal_core::session::unit_states::Piece;
use foveal_media::pack::pack::Pack;
use foveal_render::Drawer;
use std::collections::{HashSet, VecDeque};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// The window is not woken more often than this.
const LEAST_SLEEP: Duration = Duration::from_millis(8);

impl Player {
    /// Plays a pack, opened on a screen, while something else goes on; `woken` is called when
    /// something was decoded, and `tell` with what a person should know but is not an error.
    ///
    /// # Errors
    /// The pack cannot be decoded.
    pub fn live(
        (pack, opened): (&Pack, &Opened),
        (settings, decoding): (SessionSettings, Decoding),
        drawer: Drawer,
        tell: fn(&str),
        woken: impl Fn() + Send + 'static,
    ) -> Result<Self, PlayError> {
        let (decoder, most) = pack.decoder(decoding.jobs, decoding.choice)?;
        let bytes = PackBytes::new(opened.content(), pack.source());
        let feed = Box::new(DecodeFeed::new(bytes, decoder, most, woken)?);
        Ok(Self::new(opened.clone(), settings, drawer, feed, tell))
    }
}

/// Decodes what is wanted, in that order.
#[derive(Debug)]
pub(crate) struct DecodeFeed {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
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
    done: VecDeque<Decoded>,
    stop: bool,
}

impl DecodeFeed {
    /// Begins to decode, at most `most` pieces at once; `woken` is called when something is done,
    /// at most every 8 ms.
    ///
    /// # Errors
    /// No thread can be had.
    fn new(
        bytes: PackBytes,
        decoder: Box<dyn Decoder>,
        most: usize,
        woken: impl Fn() + Send + 'static,
    ) -> Result<Self, PlayError> {
        let shared = Arc::new(Shared::default());
        let theirs = Arc::clone(&shared);
        let thread = std::thread::Builder::new()
            .name("decode feed".to_owned())
            .spawn(move || theirs.work(&bytes, decoder, most, &woken))
            .map_err(PlayError::Thread)?;
        Ok(Self {
            shared,
            thread: Some(thread),
        })
    }
}

impl Supply for DecodeFeed {
    fn want(&mut self, wanted: &[Piece]) {
        let mut state = self.shared.lock();
        let done: HashSet<Piece> = state.done.iter().map(|done| done.piece).collect();
        let under_way = &state.under_way;
        let missing = |wanted: &&Piece| !under_way.contains(wanted) && !done.contains(wanted);
        let queue = wanted.iter().filter(missing).copied().collect();
        state.queue = queue;
        drop(state);
        self.shared.wake.notify_one();
    }

    /// What is not there yet is not waited for.
    fn next(&mut self, _patience: Option<Duration>) -> Option<Decoded> {
        self.shared.lock().done.pop_front()
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

    fn work(
        &self,
        bytes: &PackBytes,
        mut decoder: Box<dyn Decoder>,
        most: usize,
        woken: &impl Fn(),
    ) {
        let (mut woke, mut ahead) = (Instant::now(), Ahead::of(bytes));
        while self.order((bytes, &mut ahead), &mut *decoder, most) {
            let Some(done) = decoder.receive(None) else {
                continue;
            };
            let mut state = self.lock();
            state.under_way.remove(&done.piece);
            state.done.push_back(done);
            let over = state.queue.is_empty() && state.under_way.is_empty();
            drop(state);
            if over || woke.elapsed() >= LEAST_SLEEP {
                woke = Instant::now();
                woken();
            }
        }
    }

    /// Hands the decoder what comes next, once there is something under way; `false` to stop.
    fn order(
        &self,
        (bytes, ahead): (&PackBytes, &mut Ahead),
        decoder: &mut dyn Decoder,
        most: usize,
    ) -> bool {
        let mut state = self.lock();
        loop {
            if state.stop {
                return false;
            }
            let room = most.saturating_sub(state.under_way.len());
            let few = room.min(state.queue.len());
            let next: Vec<Piece> = state.queue.drain(..few).collect();
            if let Some(last) = next.last() {
                state.under_way.extend(&next);
                let with_bytes = |piece: &Piece| (*piece, bytes.of(piece.unit.unit));
                decoder.request(next.iter().map(with_bytes).collect());
                ahead.expect(last.frame, bytes, decoder);
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
