//! How do the tiles of a frame become pictures at once, on all cores?
//!
//! Every tile that is followed keeps a decoder of its own. Asked for a frame in the middle of a
//! group, the decoder starts at the group's key frame and catches up without showing; a
//! coarser level stays on screen meanwhile. All workers take tiles of all levels; those of the
//! coarsest, which every frame needs wherever the gaze is, are decoded ahead when nothing else is
//! waiting. A worker takes several tiles at a time and hands them over together, and who waits for
//! a frame is woken once. The frame number of a picture is what came out of the decoder, so that
//! tiles of different frames are never mixed unnoticed.
//!
//! What the workers share is behind one lock, which no thread holds while it reads, decodes, opens
//! or closes anything.

use crate::error::MediaError;
use crate::pack::pack_file::PackFile;
use crate::tiles::decode_queue::{DecodeQueue, Job, TileFrame};
use crate::tiles::decode_streams::{Held, Stream, Streams};
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
use std::collections::{HashMap, HashSet, VecDeque};
use std::path::PathBuf;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};
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
    workers: Vec<JoinHandle<()>>,
    /// The pack, for people.
    path: PathBuf,
}

#[derive(Debug)]
struct Shared {
    pack: Arc<VideoPack>,
    decoders: Decoders,
    workers: u32,
    state: Mutex<State>,
    /// There is something to decode.
    wake: Condvar,
    /// As many tiles are decoded as the player waits for.
    arrived: Condvar,
}

#[derive(Debug, Default)]
struct State {
    queue: DecodeQueue<UnitBytes>,
    streams: Streams,
    /// What was asked for and neither handed out nor taken back.
    owed: HashSet<TileFrame>,
    /// Of that, what is decoded.
    done: VecDeque<DecodedTile>,
    /// What was decoded before anybody asked.
    ready: HashMap<TileFrame, DecodedTile>,
    /// Workers that sleep and were not woken.
    asleep: usize,
    /// Tiles that the player waits for; `None` while it does not.
    awaited: Option<usize>,
    stop: bool,
}

/// A tile that a worker has, and a decoder for it.
struct Task {
    job: Job<UnitBytes>,
    held: Held,
}

/// What a worker made of it: the decoder, if it can go on, and the picture.
struct Finished {
    place: TileFrame,
    stream: Option<Stream>,
    tile: DecodedTile,
}

impl DecodePool {
    /// A pool of `workers` threads (at least one) for a pack.
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
        let workers = workers.max(1);
        let shared = Arc::new(Shared {
            pack: Arc::clone(file.pack()),
            decoders,
            workers: u32::try_from(workers).unwrap_or(u32::MAX),
            state: Mutex::default(),
            wake: Condvar::new(),
            arrived: Condvar::new(),
        });
        let start = || {
            let shared = Arc::clone(&shared);
            let thread = std::thread::Builder::new().name("decode".to_owned());
            thread.spawn(move || shared.work())
        };
        let first = start().map_err(|source| MediaError::Thread {
            what: "decoding",
            source,
        })?;
        // Fewer than were asked for take longer.
        let more = (1..workers).map_while(|_| start().ok());
        Ok(Self {
            workers: std::iter::once(first).chain(more).collect(),
            path: file.path().to_owned(),
            shared,
        })
    }
}

impl Decoder for DecodePool {
    fn request(&mut self, pieces: Vec<(Piece, UnitBytes)>) {
        let pack = &self.shared.pack;
        let coarsest = pack.grid().coarsest();
        let mut state = self.shared.lock();
        for (piece, bytes) in pieces {
            let place = (pack.tile_of(piece.unit.unit), piece.frame);
            state.streams.asked(piece.frame);
            if !state.owed.insert(place) || state.queue.is_taken(place) {
                continue;
            }
            if let Some(done) = state.ready.remove(&place) {
                state.done.push_back(done);
                continue;
            }
            let pictures = self.shared.pictures_of(&state.streams, place);
            let job = Job {
                place,
                pictures,
                bytes,
            };
            state.queue.ask(job, place.0.level == coarsest);
        }
        let asked = state.queue.asked();
        self.shared.wake_workers(state, asked);
    }

    /// Of the coarsest level only.
    fn expect(&mut self, pieces: Vec<(Piece, UnitBytes)>) {
        let pack = &self.shared.pack;
        let soon = pieces.first().map(|(piece, _)| piece.frame);
        let jobs = pieces.into_iter().map(|(piece, bytes)| Job {
            place: (pack.tile_of(piece.unit.unit), piece.frame),
            pictures: 1,
            bytes,
        });
        let of_coarsest = jobs.filter(|job| job.place.0.level == pack.grid().coarsest());
        let jobs: Vec<Job<UnitBytes>> = of_coarsest.collect();
        let expected: HashSet<TileFrame> = jobs.iter().map(|job| job.place).collect();
        let mut state = self.shared.lock();
        let State {
            queue, owed, ready, ..
        } = &mut *state;
        ready.retain(|place, _| expected.contains(place));
        let is_new = |job: &Job<_>| !owed.contains(&job.place) && !ready.contains_key(&job.place);
        queue.expect(soon, jobs.into_iter().filter(is_new));
        // Those that are awake join it; to wake more would cost more than it saves.
        self.shared.wake_workers(state, 1);
    }

    fn wait_for_all(&mut self, patience: Option<Duration>) {
        drop(self.shared.wait_for(usize::MAX, patience));
    }

    fn receive(&mut self, patience: Option<Duration>) -> Option<Decoded> {
        let done = self.shared.next(patience)?;
        let DecodedTile {
            unit,
            frame,
            picture,
            decoded,
        } = done;
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
        let State { queue, owed, .. } = &mut *self.shared.lock();
        queue.cancel().for_each(|place| {
            owed.remove(&place);
        });
    }
}

impl Drop for DecodePool {
    fn drop(&mut self) {
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

    fn work(&self) {
        let mut finished = Vec::new();
        while let Some(tasks) = self.exchange(finished) {
            finished = tasks.into_iter().map(|task| self.decode(task)).collect();
        }
    }

    /// Hands over what a worker did, and gives it the next, once there is something; `None` to
    /// stop.
    fn exchange(&self, finished: Vec<Finished>) -> Option<Vec<Task>> {
        let mut state = self.lock();
        let closed: Vec<Stream> = {
            let finished = finished.into_iter();
            finished.flat_map(|it| state.hand_over(it)).collect()
        };
        if state.awaited.is_some_and(|it| state.done.len() >= it) {
            state.awaited = None;
            self.arrived.notify_one();
        }
        if !closed.is_empty() {
            drop(state);
            drop(closed);
            state = self.lock();
        }
        loop {
            if state.stop {
                return None;
            }
            let jobs = state.queue.take(self.workers);
            if !jobs.is_empty() {
                let size = |tile| self.pack.grid().tile_size(tile);
                let task = |job: Job<UnitBytes>| Task {
                    held: state.streams.take(job.place.0, size(job.place.0)),
                    job,
                };
                return Some(jobs.into_iter().map(task).collect());
            }
            state.asleep += 1;
            let woken = self.wake.wait(state);
            state = woken.unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Wakes up to `most` sleeping workers.
    fn wake_workers(&self, mut state: MutexGuard<'_, State>, most: usize) {
        let woken = most.min(state.asleep);
        state.asleep -= woken;
        drop(state);
        (0..woken).for_each(|_| self.wake.notify_one());
    }

    /// Waits until `count` tiles are done, or all that were asked for, at most this long.
    fn wait_for(&self, count: usize, patience: Option<Duration>) -> MutexGuard<'_, State> {
        let until = patience.and_then(|patience| Instant::now().checked_add(patience));
        let mut state = self.lock();
        loop {
            let awaited = count.min(state.owed.len());
            if state.done.len() >= awaited {
                return state;
            }
            let left = until.map(|until| until.saturating_duration_since(Instant::now()));
            if left == Some(Duration::ZERO) {
                return state;
            }
            state.awaited = Some(awaited);
            state = match left {
                None => {
                    let woken = self.arrived.wait(state);
                    woken.unwrap_or_else(PoisonError::into_inner)
                }
                Some(left) => {
                    let woken = self.arrived.wait_timeout(state, left);
                    woken.unwrap_or_else(PoisonError::into_inner).0
                }
            };
            state.awaited = None;
        }
    }

    /// The next tile that is done, within this time.
    fn next(&self, patience: Option<Duration>) -> Option<DecodedTile> {
        let mut state = self.wait_for(1, patience);
        let done = state.done.pop_front()?;
        let tile = self.pack.tile_of(done.unit);
        state.owed.remove(&(tile, done.frame));
        Some(done)
    }

    /// Pictures that a decoder makes for a frame of a tile, those to catch up included.
    fn pictures_of(&self, streams: &Streams, (tile, frame): TileFrame) -> u32 {
        if self.pack.description().codec.is_intra() {
            return 1;
        }
        let unit = self.pack.unit(tile, frame);
        let next = streams.next_of(tile, unit).filter(|next| *next <= frame);
        let next = next.unwrap_or_else(|| self.pack.frames_of(unit).start);
        frame - next + 1
    }

    fn decode(&self, Task { job, held }: Task) -> Finished {
        let (place, mut decoded) = (job.place, 0);
        // A lost answer would leave its receiver waiting for ever.
        let answer = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
            self.follow(place, &job.bytes, held, &mut decoded)
        }));
        let (stream, picture) = match answer {
            Ok(Ok((stream, picture))) => (Some(stream), Ok(picture)),
            Ok(Err(error)) => (None, Err(error)),
            Err(_) => (None, Err(TileError::Panicked)),
        };
        let (tile, frame) = place;
        Finished {
            place,
            stream,
            tile: DecodedTile {
                unit: self.pack.unit(tile, frame),
                frame,
                picture,
                decoded,
            },
        }
    }

    /// Decodes up to the frame; returns the decoder too, for the frames that follow.
    fn follow(
        &self,
        place: TileFrame,
        bytes: &UnitBytes,
        held: Held,
        decoded: &mut u32,
    ) -> Result<(Stream, (Picture, i64)), TileError> {
        let mut stream = self.stream_at(place, bytes, held)?;
        let picture = self.catch_up(&mut stream, place.1, decoded)?;
        Ok((stream, picture))
    }

    /// A decoder in the right group that has not passed the frame.
    fn stream_at(
        &self,
        (tile, frame): TileFrame,
        bytes: &UnitBytes,
        held: Held,
    ) -> Result<Stream, TileError> {
        let unit = self.pack.unit(tile, frame);
        let (mut decoder, chunk) = match held {
            Held::Stream(stream) if stream.unit == unit && stream.next <= frame => {
                return Ok(stream);
            }
            Held::Stream(stream) if stream.unit == unit => (stream.decoder, Some(stream.chunk)),
            Held::Stream(stream) => (stream.decoder, None),
            Held::Spare(decoder) => (decoder, None),
            Held::Nothing => {
                let size = self.pack.grid().tile_size(tile);
                (self.decoders.open(size)?, None)
            }
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

impl State {
    /// Takes what a worker did; what is returned is to be closed.
    fn hand_over(&mut self, finished: Finished) -> Vec<Stream> {
        let Finished {
            place,
            stream,
            tile,
        } = finished;
        self.queue.give_back(place.0);
        if self.owed.contains(&place) {
            self.done.push_back(tile);
        } else {
            self.ready.insert(place, tile);
        }
        stream.map_or_else(Vec::new, |stream| self.streams.put(place.0, stream))
    }
}
