//! How do the tiles of a frame become pictures at once, on all cores?
//!
//! Every tile that is followed keeps a decoder of its own. Asked for a frame in the middle of a
//! group, the decoder starts at the group's key frame and catches up without showing; a
//! coarser level stays on screen meanwhile. The coarsest level, which every frame
//! needs wherever the gaze is, has a worker of its own that runs ahead. The frame number of a
//! picture is what came out of the decoder, so that tiles of different frames are never mixed
//! unnoticed.

use crate::error::MediaError;
use crate::pack::pack_file::PackFile;
use crate::tiles::decode::GroupDecoder;
use crate::tiles::decode_streams::{Stream, Streams};
use crate::tiles::decoders::{DecoderChoice, Decoders};
use foveal_core::content::payload::Payload;
use foveal_core::content::unit::{AssetId, UnitRef};
use foveal_core::content::video::bytes::chunk::split_chunk;
use foveal_core::content::video::bytes::pack::VideoPack;
use foveal_core::content::video::grid::tile_grid::Tile;
use foveal_core::pack::PackError;
use foveal_core::pack::unit::UnitId;
use foveal_core::session::decoder::{DecodeError, Decoded, Decoder, SourceError, UnitBytes};
use foveal_core::session::unit_states::Piece;
use foveal_core::view::picture::Picture;
use std::collections::{HashMap, VecDeque};
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;
use thiserror::Error;

/// Why a tile has no picture.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum TileError {
    /// Its chunk cannot be read.
    #[error(transparent)]
    Source(#[from] SourceError),
    /// Its chunk is not cut into frames as it should be.
    #[error(transparent)]
    Format(#[from] PackError),
    /// Its chunk cannot be decoded.
    #[error(transparent)]
    Media(#[from] MediaError),
    /// The decoder failed in a way that it should not; the panic's message is on stderr.
    #[error("a tile's decoder panicked; please report the message above with the pack")]
    Panicked,
}

/// A tile that cannot be decoded.
#[derive(Debug, Error)]
#[error(
    "{}: level {}, face {}, column {}, row {} cannot be decoded at frame {frame}",
    path.display(), tile.level, tile.face, tile.x, tile.y
)]
struct BadTile {
    path: PathBuf,
    tile: Tile,
    frame: u32,
    source: TileError,
}

/// A decoder gave another frame than it was asked for.
#[derive(Debug, Error)]
#[error("{}: asked for frame {frame} of {tile:?}, the decoder gave {number}", path.display())]
struct WrongFrame {
    path: PathBuf,
    tile: Tile,
    frame: u32,
    number: i64,
}

/// A frame of a tile.
type Place = (Tile, u32);

/// A tile of one frame, decoded.
#[derive(Debug)]
struct DecodedTile {
    /// The unit that shows it.
    unit: UnitId,
    /// The frame that was asked for.
    frame: u32,
    /// The picture, and the frame number that came out of the decoder with it.
    picture: Result<(Picture, i64), TileError>,
    /// Pictures decoded for it, those to catch up included.
    decoded: u32,
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
    /// The pack, for people.
    path: PathBuf,
}

#[derive(Debug)]
struct Shared {
    pack: Arc<VideoPack>,
    decoders: Decoders,
    state: Mutex<State>,
    wake: Condvar,
    wake_coarsest: Condvar,
}

#[derive(Debug, Default)]
struct State {
    queue: VecDeque<(Place, UnitBytes)>,
    coarsest: Coarsest,
    streams: Streams,
    stop: bool,
}

/// What the worker of the coarsest level has to do.
#[derive(Debug, Default)]
struct Coarsest {
    queue: VecDeque<(Place, UnitBytes)>,
    /// To be decoded before anybody asks.
    ahead: VecDeque<(Place, UnitBytes)>,
    /// Decoded already.
    ready: HashMap<Place, DecodedTile>,
}

impl Coarsest {
    /// The next tile to decode, and whether it is waited for.
    fn next(&mut self) -> Option<(Place, UnitBytes, bool)> {
        let asked = self.queue.pop_front().map(|(at, bytes)| (at, bytes, true));
        asked.or_else(|| self.ahead.pop_front().map(|(at, bytes)| (at, bytes, false)))
    }
}

impl DecodePool {
    /// A pool of `workers` threads (at least one) for a pack, and one more for its coarsest level.
    ///
    /// # Errors
    /// The system gives no thread.
    pub fn new(file: &PackFile, workers: usize) -> Result<Self, MediaError> {
        let decoders = Decoders::software(file.pack().description().codec);
        Self::with(file, workers, decoders)
    }

    /// The same with decoders on a graphics device, as chosen.
    ///
    /// # Errors
    /// [`DecoderChoice::Hardware`] without a device, or the system gives no thread.
    pub fn choosing(
        file: &PackFile,
        workers: usize,
        choice: DecoderChoice,
    ) -> Result<Self, MediaError> {
        let pack = file.pack();
        let (grid, codec) = (pack.grid(), pack.description().codec);
        let first = |level| grid.tiles_of(level).next();
        let largest = (0..grid.levels)
            .filter_map(first)
            .map(|tile| grid.tile_pixels(tile));
        let decoders = Decoders::new(choice, codec, largest.max().unwrap_or(0))?;
        Self::with(file, workers, decoders)
    }

    /// The decoders, which count what a graphics device decoded.
    #[must_use]
    pub fn decoders(&self) -> &Decoders {
        &self.shared.decoders
    }

    fn with(file: &PackFile, workers: usize, decoders: Decoders) -> Result<Self, MediaError> {
        let shared = Arc::new(Shared {
            pack: Arc::clone(file.pack()),
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
            path: file.path().to_owned(),
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

    /// The next finished tile, within this time.
    fn next(&mut self, patience: Option<Duration>) -> Option<DecodedTile> {
        if let Some(done) = self.at_hand.pop_front() {
            return Some(done);
        }
        if self.waiting == 0 {
            return None;
        }
        let done = match patience {
            None => self
                .results
                .recv()
                .map_err(|_| RecvTimeoutError::Disconnected),
            Some(patience) => self.results.recv_timeout(patience),
        };
        let done = done.ok()?;
        self.waiting -= 1;
        Some(done)
    }
}

impl Decoder for DecodePool {
    fn request(&mut self, piece: Piece, bytes: UnitBytes) {
        let (pack, frame) = (&self.shared.pack, piece.frame);
        let tile = pack.tile_of(piece.unit.unit);
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
            self.at_hand.push_back(done);
            return;
        }
        let queue = if is_coarsest {
            &mut state.coarsest.queue
        } else {
            &mut state.queue
        };
        if queue.iter().any(|(place, _)| *place == (tile, frame)) {
            return;
        }
        queue.push_back(((tile, frame), bytes));
        self.waiting += 1;
        drop(state);
        wake.notify_one();
    }

    /// Of the coarsest level only.
    fn expect(&mut self, pieces: Vec<(Piece, UnitBytes)>) {
        let pack = &self.shared.pack;
        let placed = pieces.into_iter().map(|(piece, bytes)| {
            let tile = pack.tile_of(piece.unit.unit);
            ((tile, piece.frame), bytes)
        });
        let of_coarsest = placed.filter(|((tile, _), _)| tile.level == pack.grid().coarsest());
        let mut ahead: VecDeque<(Place, UnitBytes)> = of_coarsest.collect();
        let mut state = self.shared.lock();
        let coarsest = &mut state.coarsest;
        let is_of_use = |place: &Place| {
            let mut asked = coarsest.queue.iter().chain(&ahead);
            asked.any(|(asked, _)| asked == place)
        };
        coarsest.ready.retain(|place, _| is_of_use(place));
        ahead.retain(|(place, _)| !coarsest.ready.contains_key(place));
        coarsest.ahead = ahead;
        drop(state);
        self.shared.wake_coarsest.notify_one();
    }

    fn receive(&mut self, patience: Option<Duration>) -> Option<Decoded> {
        let DecodedTile {
            unit,
            frame,
            picture,
            decoded,
        } = self.next(patience)?;
        let tile = self.shared.pack.tile_of(unit);
        let payload = match picture {
            Ok((picture, number)) if number == i64::from(frame) => Ok(Payload::Picture(picture)),
            Ok((_, number)) => Err(DecodeError::Wrong(Box::new(WrongFrame {
                path: self.path.clone(),
                tile,
                frame,
                number,
            }))),
            Err(source) => Err(DecodeError::Damaged(Box::new(BadTile {
                path: self.path.clone(),
                tile,
                frame,
                source,
            }))),
        };
        let asset = AssetId::ONLY;
        Some(Decoded {
            piece: Piece {
                unit: UnitRef { asset, unit },
                frame,
            },
            frames: decoded,
            payload,
        })
    }

    fn cancel(&mut self) {
        let mut state = self.shared.lock();
        self.waiting -= state.queue.len() + state.coarsest.queue.len();
        state.queue.clear();
        state.coarsest.queue.clear();
        self.at_hand.clear();
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
        while let Some((place, bytes)) = self.wait(&self.wake, |state| state.queue.pop_front()) {
            if results.send(self.decode(place, &bytes)).is_err() {
                return;
            }
        }
    }

    fn work_on_coarsest(&self, results: &Sender<DecodedTile>) {
        let next = |state: &mut State| state.coarsest.next();
        while let Some((place, bytes, asked)) = self.wait(&self.wake_coarsest, next) {
            let ready = self.lock().coarsest.ready.remove(&place);
            let done = ready.unwrap_or_else(|| self.decode(place, &bytes));
            if !asked {
                // It may have been asked for meanwhile: then it is at hand for that.
                self.lock().coarsest.ready.insert(place, done);
            } else if results.send(done).is_err() {
                return;
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

    fn decode(&self, (tile, frame): Place, bytes: &UnitBytes) -> DecodedTile {
        let mut decoded = 0;
        // A lost answer would leave its receiver waiting for ever.
        let answer = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
            self.follow((tile, frame), bytes, &mut decoded)
        }));
        let picture = answer.unwrap_or(Err(TileError::Panicked));
        DecodedTile {
            unit: self.pack.unit(tile, frame),
            frame,
            picture,
            decoded,
        }
    }

    /// Decodes up to the frame and puts the decoder back for those that follow.
    fn follow(
        &self,
        (tile, frame): Place,
        bytes: &UnitBytes,
        decoded: &mut u32,
    ) -> Result<(Picture, i64), TileError> {
        let stream = self.lock().streams.take(tile);
        let mut stream = self.stream_at((tile, frame), bytes, stream)?;
        let picture = self.catch_up(&mut stream, frame, decoded)?;
        self.lock().streams.put(tile, stream);
        Ok(picture)
    }

    /// A decoder in the right group that has not passed the frame.
    fn stream_at(
        &self,
        (tile, frame): Place,
        bytes: &UnitBytes,
        stream: Option<Stream>,
    ) -> Result<Stream, TileError> {
        let unit = self.pack.unit(tile, frame);
        let (mut decoder, chunk) = match stream {
            Some(stream) if stream.unit == unit && stream.next <= frame => return Ok(stream),
            Some(stream) if stream.unit == unit => (stream.decoder, Some(stream.chunk)),
            Some(stream) => (stream.decoder, None),
            None => (self.decoder_of(self.pack.grid().tile_size(tile))?, None),
        };
        decoder.restart();
        Ok(Stream {
            decoder,
            chunk: match chunk {
                Some(chunk) => chunk,
                None => bytes.read()?,
            },
            unit,
            next: self.pack.frames_of(unit).start,
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
        let frames = self.pack.frames_of(stream.unit);
        let units = split_chunk(&stream.chunk, frames.len())?;
        if self.pack.description().codec.is_intra() {
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
