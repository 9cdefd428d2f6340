//! How is sound played in step with the picture?
//!
//! One thread reads samples ahead, the device's callback takes them and notes which moment of the
//! content is heard when: that moment is the clock of the picture. Without a device there is
//! silence and the picture has its own clock.

use crate::commands::view::sound::heard::{Appetite, HeardLine};
use crate::commands::view::sound::samples::Samples;
use anyhow::{Context, anyhow};
use cpal::traits::{DeviceTrait, HostTrait, StreamTrait};
use cpal::{BufferSize, ErrorKind, OutputCallbackInfo, SampleFormat, StreamConfig};
use foveal_core::units::Seconds;
use std::collections::VecDeque;
use std::sync::mpsc::{Sender, channel};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Sound that is read ahead of what is heard.
const AHEAD_S: f64 = 0.25;
/// Sound that is read at once.
const CHUNK_S: f64 = 0.02;
/// What a device takes at once: enough for a busy machine, little compared with what it plays late.
const BUFFER_S: f64 = 0.04;
/// Time until a broken device is tried again.
const RETRY: Duration = Duration::from_secs(1);
/// How long a device that plays nothing waits for more.
const DISCARDED: Duration = Duration::from_millis(20);
/// What was heard longer ago than this says nothing of now.
const STALE: Duration = Duration::from_millis(500);
/// Longest time that a device is believed to hold sound back.
const MOST_LATENCY: Duration = Duration::from_secs(5);
/// How long the picture waits for a device that plays nothing yet.
const MOST_WAIT_S: f64 = 3.0;

/// Sound on its way to a device.
pub(crate) struct Sound {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

struct Shared {
    begun: Instant,
    state: Mutex<State>,
    wake: Condvar,
}

/// Bounded by what is read ahead.
struct State {
    playing: bool,
    /// What is played is silent.
    muted: bool,
    stop: bool,
    /// Counts the jumps, so that what was read before one is not played after it.
    jumps: u64,
    /// Interleaved, at the device's rate.
    ahead: VecDeque<f32>,
    /// Time in the content of the first sample of `ahead`.
    front: f64,
    /// Where in the content it was asked to begin, and when, in seconds since `begun`.
    start: Start,
    /// When which time of the content is heard, in seconds since `begun`.
    heard: HeardLine,
    appetite: Appetite,
    /// The device takes sound without playing it, so that the picture goes by the wall's clock.
    discards: bool,
    /// Callbacks that found too little, and what the device missed by itself.
    gaps: u64,
    /// The device is gone.
    broken: bool,
    /// A device is open that has no place to begin yet.
    waits: bool,
}

#[derive(Clone, Copy, Debug, Default)]
struct Start {
    at: f64,
    told: f64,
    /// The device has taken the first sample.
    is_taken: bool,
}

/// What a device takes.
#[derive(Clone, Copy, Debug)]
struct Taken {
    rate: u32,
    channels: u16,
}

impl Sound {
    /// Opens the default device for samples that repeat with the content, every `round`.
    pub(crate) fn open(samples: Samples, round: Seconds) -> anyhow::Result<Self> {
        let shared = Arc::new(Shared {
            begun: Instant::now(),
            state: Mutex::new(State {
                playing: false,
                muted: false,
                stop: false,
                jumps: 0,
                ahead: VecDeque::new(),
                front: 0.0,
                start: Start::default(),
                heard: HeardLine::default(),
                appetite: Appetite::from(0.0),
                discards: false,
                gaps: 0,
                broken: false,
                waits: false,
            }),
            wake: Condvar::new(),
        });
        let (send, opened) = channel();
        let theirs = Arc::clone(&shared);
        // A stream stays on the thread that made it.
        let thread = std::thread::Builder::new()
            .name("sound".to_owned())
            .spawn(move || play(&theirs, samples, round, &send))?;
        let opened = opened.recv().context("the sound thread ended");
        opened.and_then(|opened| opened)?;
        Ok(Self {
            shared,
            thread: Some(thread),
        })
    }

    /// Plays on from a time of the content, or stops there.
    pub(crate) fn set(&self, playing: bool, at: Seconds) {
        let mut state = self.shared.lock();
        state.playing = playing;
        state.jumps += 1;
        state.ahead.clear();
        state.front = at.0;
        state.start = Start {
            at: at.0,
            told: self.shared.begun.elapsed().as_secs_f64(),
            is_taken: false,
        };
        state.heard.forget();
        state.waits = false;
        drop(state);
        self.shared.wake.notify_one();
    }

    /// Makes it silent, or heard again; returns whether it is heard. It goes on in step with the
    /// picture either way.
    pub(crate) fn toggle(&self) -> bool {
        let mut state = self.shared.lock();
        state.muted = !state.muted;
        !state.muted
    }

    /// Whether a device came back and must be [`Self::set`].
    pub(crate) fn waits(&self) -> bool {
        self.shared.lock().waits
    }

    /// The time of the content that is heard now; `None` while nothing is.
    pub(crate) fn heard(&self) -> Option<Seconds> {
        let state = self.shared.lock();
        let heard = state.heard_at(self.shared.begun.elapsed().as_secs_f64())?;
        (heard >= state.start.at).then_some(Seconds(heard))
    }

    /// Where the sound begins that is on its way and not heard yet, and in what time it will be, as
    /// far as that is known: the picture waits there.
    pub(crate) fn begins(&self) -> Option<(Seconds, Option<Seconds>)> {
        let state = self.shared.lock();
        let now = self.shared.begun.elapsed().as_secs_f64();
        let start = state.start;
        let until = state.heard_at(now).map(|heard| start.at - heard);
        let waits = match until {
            Some(until) => until > 0.0,
            None => !start.is_taken && now < start.told + MOST_WAIT_S,
        };
        let can_begin = state.playing && !state.discards && !state.broken;
        (waits && can_begin).then_some((Seconds(start.at), until.map(Seconds)))
    }

    /// Times that the device found too little to play.
    pub(crate) fn gaps(&self) -> u64 {
        self.shared.lock().gaps
    }
}

impl Drop for Sound {
    fn drop(&mut self) {
        self.shared.lock().stop = true;
        self.shared.wake.notify_one();
        if let Some(thread) = self.thread.take() {
            // A thread that panicked has already said so.
            let _ = thread.join();
        }
    }
}

impl State {
    /// The time of the content that is heard; before where it began while that is on its way.
    fn heard_at(&self, now: f64) -> Option<f64> {
        self.heard.at(now, STALE.as_secs_f64())
    }
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Fills what the device asks for, and notes what is heard when.
    fn fill(&self, out: &mut [f32], taken: Taken, latency: Duration) {
        out.fill(0.0);
        let mut state = self.lock();
        let now = self.begun.elapsed().as_secs_f64();
        let seconds_of =
            |samples: usize| (samples / usize::from(taken.channels)) as f64 / f64::from(taken.rate);
        let hears = state.appetite.takes(seconds_of(out.len()), now);
        if !hears && !state.discards {
            state.discards = true;
            state.heard.forget();
            crate::report::output::say(
                "warning: sound: the device takes sound faster than it can be heard; the picture \
                 goes on without",
            );
        }
        if state.discards {
            drop(state);
            // No one hears that this device waits, and nothing else would slow it down.
            std::thread::sleep(DISCARDED);
            return;
        }
        // What a device takes to fill its own memory would be heard in pieces.
        if !state.playing || !state.appetite.is_sated() {
            return;
        }
        let count = out.len().min(state.ahead.len());
        state.gaps += u64::from(count < out.len());
        if count == 0 {
            state.heard.forget();
            return;
        }
        out.iter_mut()
            .zip(state.ahead.drain(..count))
            .for_each(|(out, sample)| *out = sample);
        if state.muted {
            out.fill(0.0);
        }
        state.start.is_taken = true;
        let front = state.front;
        state.heard.note(now, now + latency.as_secs_f64(), front);
        if count < out.len() {
            // What follows is heard later by what was missing.
            state.heard.forget();
        }
        state.front += seconds_of(count);
        drop(state);
        self.wake.notify_one();
    }

    /// The device reports a fault: what it missed is counted, what ends it ends the stream.
    fn fault(&self, error: &cpal::Error) {
        let mut state = self.lock();
        match error.kind() {
            ErrorKind::Xrun => state.gaps += 1,
            ErrorKind::DeviceChanged | ErrorKind::RealtimeDenied => {}
            _ if !state.broken => {
                state.broken = true;
                state.heard.forget();
                crate::report::output::say(&format!("warning: sound: {error}; trying again"));
            }
            _ => {}
        }
        drop(state);
        self.wake.notify_one();
    }

    /// Waits before a device is tried again; `false` to stop.
    fn pause_before_retry(&self) -> bool {
        let state = self.lock();
        let waited = self
            .wake
            .wait_timeout_while(state, RETRY, |state| !state.stop);
        !waited.unwrap_or_else(PoisonError::into_inner).0.stop
    }

    /// Reads ahead until stopped.
    fn read_ahead(&self, samples: &mut Samples, round: Seconds, taken: Taken) {
        let channels = usize::from(taken.channels);
        let frames = (f64::from(taken.rate) * CHUNK_S) as usize;
        let most = (f64::from(taken.rate) * AHEAD_S) as usize * channels;
        let mut chunk = vec![0.0; frames * channels];
        let mut state = self.lock();
        while !state.stop && !state.broken {
            if !state.playing || state.ahead.len() >= most {
                state = self
                    .wake
                    .wait(state)
                    .unwrap_or_else(PoisonError::into_inner);
                continue;
            }
            let jumps = state.jumps;
            let read = (state.ahead.len() / channels) as f64 / f64::from(taken.rate);
            let from = Seconds(state.front + read);
            drop(state);
            samples.fill(from, round, taken.rate, &mut chunk);
            state = self.lock();
            if state.jumps == jumps {
                state.ahead.extend(&chunk);
            }
        }
    }
}

/// Opens a device, says how that went, and plays; opens it again when it breaks.
fn play(
    shared: &Arc<Shared>,
    mut samples: Samples,
    round: Seconds,
    opened: &Sender<anyhow::Result<()>>,
) {
    // What its functions print besides their results, this program says in one line.
    #[cfg(target_os = "linux")]
    let _complaints = alsa::Output::local_error_handler();
    let mut first = true;
    loop {
        match open_device(shared, &samples) {
            Ok((stream, taken)) => {
                if std::mem::take(&mut first) {
                    // The caller may be gone; the shared state says.
                    let _ = opened.send(Ok(()));
                }
                samples.mix_to(taken.channels);
                shared.read_ahead(&mut samples, round, taken);
                drop(stream);
            }
            Err(error) if first => {
                let _ = opened.send(Err(error));
                return;
            }
            Err(_) => {}
        }
        if !shared.pause_before_retry() {
            return;
        }
        let now = shared.begun.elapsed().as_secs_f64();
        let mut state = shared.lock();
        state.broken = false;
        state.appetite = Appetite::from(now);
        state.ahead.clear();
        state.playing = false;
        state.waits = true;
    }
}

fn open_device(shared: &Arc<Shared>, samples: &Samples) -> anyhow::Result<(cpal::Stream, Taken)> {
    let device = cpal::default_host()
        .default_output_device()
        .context("there is no sound device")?;
    let refused = |what: &str, error: cpal::Error| anyhow!("the sound device {what}: {error}");
    let default = device
        .default_output_config()
        .map_err(|error| refused("reports no format", error))?;
    let mut config: StreamConfig = default.config();
    let takes_rate = device
        .supported_output_configs()
        .map_err(|error| refused("reports no formats", error))?
        .any(|range| {
            range.channels() == config.channels
                && range.sample_format() == SampleFormat::F32
                && (range.min_sample_rate()..=range.max_sample_rate()).contains(&samples.rate())
        });
    if takes_rate {
        config.sample_rate = samples.rate();
    }
    config.buffer_size = BufferSize::Fixed((f64::from(config.sample_rate) * BUFFER_S) as u32);
    let taken = Taken {
        rate: config.sample_rate,
        channels: config.channels,
    };
    let theirs = Arc::clone(shared);
    let fill = move |out: &mut [f32], about: &OutputCallbackInfo| {
        let stamp = about.timestamp();
        let latency = stamp
            .playback
            .duration_since(stamp.callback)
            .min(MOST_LATENCY);
        theirs.fill(out, taken, latency);
    };
    let theirs = Arc::clone(shared);
    let failed = move |error: cpal::Error| theirs.fault(&error);
    let stream = device
        .build_output_stream(config, fill, failed, None)
        .map_err(|error| refused("gives no stream", error))?;
    stream
        .play()
        .map_err(|error| refused("does not play", error))?;
    Ok((stream, taken))
}
pub(crate) mod drift;
pub(crate) mod heard;
pub(crate) mod samples;
