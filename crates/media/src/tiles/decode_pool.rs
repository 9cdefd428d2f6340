//! How do the tiles of a frame become pictures at once, on all cores?
//!
//! Every tile that is followed keeps a decoder of its own. Asked for a frame in the middle of a
//! group, the decoder starts at the group's key frame and catches up without showing; a
//! coarser level stays on screen meanwhile. The coarsest level, which every frame
//! needs wherever the gaze is, has a worker of its own that runs ahead. The frame number of a
//! picture is what came out of the decoder, so that tiles of different frames are never mixed
//! unnoticed.

use crate::error::MediaError;
use crate::pack::pack_file::{PackFile, PackFileError};
use crate::tiles::decode::GroupDecoder;
use crate::tiles::decode_streams::{Stream, Streams};
use crate::tiles::decoders::{DecoderChoice, Decoders, DeviceUse};
use foveal_core::content::video::bytes::chunk::split_chunk;
use foveal_core::content::video::grid::tile_grid::Tile;
use foveal_core::pack::unit::UnitId;
use foveal_core::view::picture::Picture;
use std::collections::{HashMap, VecDeque};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::Instant;
use thiserror::Error;

/// Frames that the coarsest level is decoded ahead.
const AHEAD: u32 = 2;

/// Why a tile has no picture.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum TileError {
    /// Its chunk cannot be read.
    #[error(transparent)]
    Pack(#[from] PackFileError),
    /// Its chunk cannot be decoded.
    #[error(transparent)]
    Media(#[from] MediaError),
    /// The decoder failed in a way that it should not; the panic's message is on stderr.
    #[error("a tile's decoder panicked; please report the message above with the pack")]
    Panicked,
}

/// A tile of one frame, decoded.
#[derive(Debug)]
pub struct DecodedTile {
    /// The unit that shows it.
    pub unit: UnitId,
    /// The frame that was asked for.
    pub frame: u32,
    /// The picture, and the frame number that came out of the decoder with it.
    pub picture: Result<(Picture, i64), TileError>,
    /// Pictures decoded for it, those to catch up included.
    pub decoded: u32,
}

/// Threads that decode tiles of one pack.
///
/// Bounded: a tile is queued once however often it is asked for, and twice as many decoders stay
/// open as one frame needs (about 0.5 MB each at 256 px).
#[derive(Debug)]
pub struct DecodePool {
    shared: Arc<Shared>,
    results: Receiver<DecodedTile>,
    /// Tiles that had been decoded when they were asked for.
    at_hand: VecDeque<DecodedTile>,
    workers: Vec<JoinHandle<()>>,
    waiting: usize,
}

#[derive(Debug)]
struct Shared {
    pack: Arc<PackFile>,
    decoders: Decoders,
    state: Mutex<State>,
    wake: Condvar,
    wake_coarsest: Condvar,
}

#[derive(Debug, Default)]
struct State {
    queue: VecDeque<(Tile, u32)>,
    coarsest: Coarsest,
    streams: Streams,
    stop: bool,
}

/// What the worker of the coarsest level has to do.
#[derive(Debug, Default)]
struct Coarsest {
    queue: VecDeque<(Tile, u32)>,
    /// To be decoded before anybody asks.
    ahead: VecDeque<(Tile, u32)>,
    /// Decoded already.
    ready: HashMap<(Tile, u32), DecodedTile>,
}

impl Coarsest {
    /// The next tile to decode, and whether it is waited for.
    fn next(&mut self) -> Option<(Tile, u32, bool)> {
        let asked = self
            .queue
            .pop_front()
            .map(|(tile, frame)| (tile, frame, true));
        asked.or_else(|| {
            self.ahead
                .pop_front()
                .map(|(tile, frame)| (tile, frame, false))
        })
    }

    /// Plans the frames that follow one that was asked for, and forgets all others of this tile.
    fn look_ahead(&mut self, tile: Tile, frame: u32, frames: u32) {
        let next = |step: u32| (frame + step) % frames;
        let follows = |other: u32| (1..=AHEAD).any(|step| next(step) == other);
        self.ready
            .retain(|(of, other), _| *of != tile || follows(*other));
        self.ahead.retain(|(of, _)| *of != tile);
        let planned = (1..=AHEAD).map(|step| (tile, next(step)));
        self.ahead
            .extend(planned.filter(|place| !self.ready.contains_key(place)));
    }
}

impl DecodePool {
    /// A pool of `workers` threads (at least one) on a pack, and one more for its coarsest level.
    ///
    /// # Errors
    /// The system gives no thread.
    pub fn new(pack: Arc<PackFile>, workers: usize) -> Result<Self, MediaError> {
        let decoders = Decoders::software(pack.pack().description().codec);
        Self::with(pack, workers, decoders)
    }

    /// The same with decoders on a graphics device, as chosen.
    ///
    /// # Errors
    /// [`DecoderChoice::Hardware`] without a device, or the system gives no thread.
    pub fn choosing(
        pack: Arc<PackFile>,
        workers: usize,
        choice: DecoderChoice,
    ) -> Result<Self, MediaError> {
        let (grid, codec) = (pack.pack().grid(), pack.pack().description().codec);
        let first = |level| grid.tiles_of(level).next();
        let largest = (0..grid.levels)
            .filter_map(first)
            .map(|tile| grid.tile_pixels(tile));
        let decoders = Decoders::new(choice, codec, largest.max().unwrap_or(0))?;
        Self::with(pack, workers, decoders)
    }

    /// What was decoded on a graphics device so far.
    #[must_use]
    pub fn device_use(&self) -> DeviceUse {
        self.shared.decoders.device_use()
    }

    fn with(pack: Arc<PackFile>, workers: usize, decoders: Decoders) -> Result<Self, MediaError> {
        let shared = Arc::new(Shared {
            pack,
            decoders,
            state: Mutex::default(),
            wake: Condvar::new(),
            wake_coarsest: Condvar::new(),
        });
        let (send, results) = channel();
        let start = |work: fn(&Shared, &Sender<DecodedTile>)| {
            let (shared, send) = (Arc::clone(&shared), send.clone());
            let thread = std::thread::Builder::new().name("decode".to_owned());
            thread.spawn(move || work(&shared, &send))
        };
        let mut pool = Self {
            shared: Arc::clone(&shared),
            results,
            at_hand: VecDeque::new(),
            workers: Vec::new(),
            waiting: 0,
        };
        // Those that began end with the pool.
        let none = |source| MediaError::Thread {
            what: "decoding",
            source,
        };
        pool.workers
            .push(start(Shared::work_on_coarsest).map_err(none)?);
        pool.workers.push(start(Shared::work).map_err(none)?);
        // Fewer than were asked for take longer.
        let more = (1..workers).map_while(|_| start(Shared::work).ok());
        pool.workers.extend(more);
        Ok(pool)
    }

    /// Asks for a frame of a unit, after all that was asked for before.
    pub fn request(&mut self, unit: UnitId, frame: u32) {
        let pack = self.shared.pack.pack();
        let tile = pack.tile_of(unit);
        let is_coarsest = tile.level == pack.grid().coarsest();
        let mut state = self.shared.lock();
        state.streams.asked(frame);
        let wake = if is_coarsest {
            &self.shared.wake_coarsest
        } else {
            &self.shared.wake
        };
        if let Some(done) = state.coarsest.ready.remove(&(tile, frame)) {
            // Already decoded: no wake-up.
            let frames = pack.description().frames;
            state.coarsest.look_ahead(tile, frame, frames);
            self.at_hand.push_back(done);
        } else {
            let queue = if is_coarsest {
                &mut state.coarsest.queue
            } else {
                &mut state.queue
            };
            if queue.contains(&(tile, frame)) {
                return;
            }
            queue.push_back((tile, frame));
            self.waiting += 1;
        }
        drop(state);
        wake.notify_one();
    }

    /// Takes back what no worker has begun.
    pub fn cancel(&mut self) {
        let mut state = self.shared.lock();
        self.waiting -= state.queue.len() + state.coarsest.queue.len();
        state.queue.clear();
        state.coarsest.queue.clear();
        self.at_hand.clear();
    }

    /// The next finished tile; `None` when nothing is under way, or nothing was finished by
    /// `deadline`.
    pub fn receive(&mut self, deadline: Option<Instant>) -> Option<DecodedTile> {
        if let Some(done) = self.at_hand.pop_front() {
            return Some(done);
        }
        if self.waiting == 0 {
            return None;
        }
        let done = match deadline {
            None => self
                .results
                .recv()
                .map_err(|_| RecvTimeoutError::Disconnected),
            Some(deadline) => {
                let left = deadline.saturating_duration_since(Instant::now());
                self.results.recv_timeout(left)
            }
        };
        let done = done.ok()?;
        self.waiting -= 1;
        Some(done)
    }
}

impl Drop for DecodePool {
    fn drop(&mut self) {
        self.cancel();
        self.shared.lock().stop = true;
        self.shared.wake.notify_all();
        self.shared.wake_coarsest.notify_all();
        for worker in self.workers.drain(..) {
            // A worker that panicked has already said so.
            let _ = worker.join();
        }
    }
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn work(&self, results: &Sender<DecodedTile>) {
        while let Some((tile, frame)) = self.wait(&self.wake, |state| state.queue.pop_front()) {
            if results.send(self.decode(tile, frame)).is_err() {
                return;
            }
        }
    }

    fn work_on_coarsest(&self, results: &Sender<DecodedTile>) {
        let next = |state: &mut State| state.coarsest.next();
        while let Some((tile, frame, asked)) = self.wait(&self.wake_coarsest, next) {
            let ready = self.lock().coarsest.ready.remove(&(tile, frame));
            let done = ready.unwrap_or_else(|| self.decode(tile, frame));
            if !asked {
                let ready = &mut self.lock().coarsest.ready;
                ready.insert((tile, frame), done);
            } else if results.send(done).is_err() {
                return;
            } else {
                let frames = self.pack.pack().description().frames;
                self.lock().coarsest.look_ahead(tile, frame, frames);
            }
        }
    }

    /// The next job, once there is one; `None` to stop.
    fn wait<T>(&self, wake: &Condvar, next: impl Fn(&mut State) -> Option<T>) -> Option<T> {
        let mut state = self.lock();
        loop {
            if state.stop {
                return None;
            }
            if let Some(job) = next(&mut state) {
                return Some(job);
            }
            state = wake.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }

    fn decode(&self, tile: Tile, frame: u32) -> DecodedTile {
        let mut decoded = 0;
        // A lost answer would leave its receiver waiting for ever.
        let answer = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
            self.follow(tile, frame, &mut decoded)
        }));
        let picture = answer.unwrap_or(Err(TileError::Panicked));
        DecodedTile {
            unit: self.pack.pack().unit(tile, frame),
            frame,
            picture,
            decoded,
        }
    }

    /// Decodes up to `frame` and puts the decoder back for the frames that follow.
    fn follow(
        &self,
        tile: Tile,
        frame: u32,
        decoded: &mut u32,
    ) -> Result<(Picture, i64), TileError> {
        let stream = self.lock().streams.take(tile);
        let mut stream = self.stream_at(tile, frame, stream)?;
        let picture = self.catch_up(&mut stream, frame, decoded)?;
        self.lock().streams.put(tile, stream);
        Ok(picture)
    }

    /// A decoder in the right group that has not passed `frame`.
    fn stream_at(
        &self,
        tile: Tile,
        frame: u32,
        stream: Option<Stream>,
    ) -> Result<Stream, TileError> {
        let pack = self.pack.pack();
        let unit = pack.unit(tile, frame);
        let (mut decoder, chunk) = match stream {
            Some(stream) if stream.unit == unit && stream.next <= frame => return Ok(stream),
            Some(stream) if stream.unit == unit => (stream.decoder, Some(stream.chunk)),
            Some(stream) => (stream.decoder, None),
            None => (self.decoder_of(pack.grid().tile_size(tile))?, None),
        };
        decoder.restart();
        Ok(Stream {
            decoder,
            chunk: match chunk {
                Some(chunk) => chunk,
                None => self.pack.read_chunk(unit)?,
            },
            unit,
            next: pack.frames_of(unit).start,
        })
    }

    fn decoder_of(&self, size: [u32; 2]) -> Result<GroupDecoder, TileError> {
        let spare = self.lock().streams.spare(size);
        match spare {
            Some(decoder) => Ok(decoder),
            None => Ok(self.decoders.open(size)?),
        }
    }

    fn catch_up(
        &self,
        stream: &mut Stream,
        frame: u32,
        decoded: &mut u32,
    ) -> Result<(Picture, i64), TileError> {
        let frames = self.pack.pack().frames_of(stream.unit);
        let units =
            split_chunk(&stream.chunk, frames.len()).map_err(|source| PackFileError::Format {
                path: self.pack.path().to_owned(),
                source,
            })?;
        if self.pack.pack().description().codec.is_intra() {
            stream.next = frame;
        }
        loop {
            let number = stream.next;
            let unit = units[(number - frames.start) as usize];
            *decoded += 1;
            stream.next += 1;
            if number == frame {
                return Ok(stream.decoder.decode(unit, i64::from(number))?);
            }
            stream.decoder.skip(unit, i64::from(number))?;
        }
    }
}
