//! How do the tiles of a frame become pictures at once, on all cores?
//!
//! Every tile that is followed keeps a decoder of its own. Asked for a frame in the middle of a
//! group, the decoder starts at the group's key frame and catches up without showing; whoever
//! shows pictures keeps a coarser level on screen meanwhile. The frame number of a picture is what
//! came out of the decoder, so that tiles of different frames are never mixed unnoticed.

use crate::decode::GroupDecoder;
use crate::error::MediaError;
use crate::pack_file::{PackFile, PackFileError};
use foveal_core::asset::pack::split_chunk;
use foveal_core::asset::picture::Picture;
use foveal_core::asset::tile_grid::Tile;
use foveal_core::asset::unit::UnitId;
use std::collections::{HashMap, VecDeque};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::Instant;
use thiserror::Error;

/// Most decoders that are kept open: a 16K sphere at its finest level has 1536 tiles.
const MOST_DECODERS: usize = 4096;

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
    /// The tile.
    pub tile: Tile,
    /// The frame that was asked for.
    pub frame: u32,
    /// The picture, and the frame number that came out of the decoder with it.
    pub picture: Result<(Picture, i64), TileError>,
    /// Pictures decoded for it, those to catch up included.
    pub decoded: u32,
}

/// Threads that decode tiles of one pack.
///
/// Bounded: a tile is queued once however often it is asked for, and at most 4096 decoders stay
/// open (about 0.5 MB each at 256 px).
#[derive(Debug)]
pub struct DecodePool {
    shared: Arc<Shared>,
    results: Receiver<DecodedTile>,
    workers: Vec<JoinHandle<()>>,
    waiting: usize,
}

#[derive(Debug)]
struct Shared {
    pack: Arc<PackFile>,
    state: Mutex<State>,
    wake: Condvar,
}

#[derive(Debug, Default)]
struct State {
    queue: VecDeque<(Tile, u32)>,
    streams: HashMap<Tile, Stream>,
    uses: u64,
    stop: bool,
}

/// A decoder that follows one tile.
struct Stream {
    decoder: GroupDecoder,
    chunk: Vec<u8>,
    unit: UnitId,
    /// The frame that comes out next.
    next: u32,
    used: u64,
}

impl std::fmt::Debug for Stream {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            out,
            "Stream {{ unit: {}, next: {} }}",
            self.unit.0, self.next
        )
    }
}

impl DecodePool {
    /// A pool of `workers` threads (at least one) on a pack.
    #[must_use]
    pub fn new(pack: Arc<PackFile>, workers: usize) -> Self {
        let shared = Arc::new(Shared {
            pack,
            state: Mutex::default(),
            wake: Condvar::new(),
        });
        let (send, results) = channel();
        let workers = (0..workers.max(1))
            .map(|_| {
                let (shared, send) = (Arc::clone(&shared), send.clone());
                std::thread::spawn(move || shared.work(&send))
            })
            .collect();
        Self {
            shared,
            results,
            workers,
            waiting: 0,
        }
    }

    /// Asks for a tile at a frame, after all that was asked for before.
    pub fn request(&mut self, tile: Tile, frame: u32) {
        let mut state = self.shared.lock();
        if state.queue.contains(&(tile, frame)) {
            return;
        }
        state.queue.push_back((tile, frame));
        drop(state);
        self.waiting += 1;
        self.shared.wake.notify_one();
    }

    /// Takes back what no worker has begun.
    pub fn cancel(&mut self) {
        let mut state = self.shared.lock();
        self.waiting -= state.queue.len();
        state.queue.clear();
    }

    /// The next finished tile; `None` when nothing is under way, or nothing was finished by
    /// `deadline`.
    pub fn receive(&mut self, deadline: Option<Instant>) -> Option<DecodedTile> {
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
        while let Some((tile, frame, stream)) = self.next_job() {
            let mut decoded = 0;
            // A lost answer would leave whoever waits for it waiting for ever.
            let answer = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
                self.follow(tile, frame, stream, &mut decoded)
            }));
            let picture = answer.unwrap_or(Err(TileError::Panicked));
            if results
                .send(DecodedTile {
                    tile,
                    frame,
                    picture,
                    decoded,
                })
                .is_err()
            {
                return;
            }
        }
    }

    /// The next tile to decode, with the decoder that follows it if there is one; `None` to stop.
    fn next_job(&self) -> Option<(Tile, u32, Option<Stream>)> {
        let mut state = self.lock();
        loop {
            if state.stop {
                return None;
            }
            if let Some((tile, frame)) = state.queue.pop_front() {
                let stream = state.streams.remove(&tile);
                return Some((tile, frame, stream));
            }
            state = self
                .wake
                .wait(state)
                .unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Decodes up to `frame` and puts the decoder back for the frames that follow.
    fn follow(
        &self,
        tile: Tile,
        frame: u32,
        stream: Option<Stream>,
        decoded: &mut u32,
    ) -> Result<(Picture, i64), TileError> {
        let mut stream = self.stream_at(tile, frame, stream)?;
        let picture = self.catch_up(&mut stream, frame, decoded)?;
        let mut state = self.lock();
        state.uses += 1;
        stream.used = state.uses;
        state.streams.insert(tile, stream);
        if state.streams.len() > MOST_DECODERS {
            let oldest = state.streams.iter().min_by_key(|(_, stream)| stream.used);
            if let Some(oldest) = oldest.map(|(tile, _)| *tile) {
                state.streams.remove(&oldest);
            }
        }
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
        let begin = pack.frames_of(unit).start;
        match stream {
            Some(stream) if stream.unit == unit && stream.next <= frame => Ok(stream),
            Some(mut stream) => {
                if stream.unit != unit {
                    stream.chunk = self.pack.read_chunk(unit)?;
                }
                stream.decoder.restart();
                Ok(Stream {
                    unit,
                    next: begin,
                    ..stream
                })
            }
            None => {
                let size = pack.grid().tile_size(tile);
                let decoder = GroupDecoder::new(pack.description().codec, size)?;
                let chunk = self.pack.read_chunk(unit)?;
                Ok(Stream {
                    decoder,
                    chunk,
                    unit,
                    next: begin,
                    used: 0,
                })
            }
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
            let picture = stream.decoder.decode(unit, i64::from(number))?;
            *decoded += 1;
            stream.next += 1;
            if number == frame {
                return Ok(picture);
            }
        }
    }
}
