//! What does a sender say right now?
//!
//! One thread receives; others take what came when they need a gaze. The queue between them is
//! bounded: a reader that is late loses the oldest rows, and they are counted.

use crate::gaze_source::choice::LiveChoice;
use crate::gaze_source::feed::{GazeFeed, Received};
use crate::gaze_source::intake::{Counts, Intake};
use crate::report::output::say;
use anyhow::bail;
use foveal_core::gaze::read::row::TraceRow;
use foveal_core::units::{Seconds, counted};
use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Most rows that wait: four seconds at 1000 Hz.
const MOST_WAITING: usize = 4096;

/// A live source.
pub(crate) struct Live {
    name: String,
    shared: Arc<Shared>,
}

struct Shared {
    begun: Instant,
    stop: AtomicBool,
    inner: Mutex<Inner>,
    came: Condvar,
}

struct Inner {
    intake: Intake,
    waiting: VecDeque<TraceRow>,
    dropped: u64,
    foreign: u64,
}

impl Live {
    /// Starts to receive.
    pub(crate) fn open(choice: &LiveChoice) -> anyhow::Result<Self> {
        let feed = GazeFeed::open(choice)?;
        let shared = Arc::new(Shared {
            begun: Instant::now(),
            stop: AtomicBool::new(false),
            inner: Mutex::new(Inner {
                intake: Intake::new(choice),
                waiting: VecDeque::new(),
                dropped: 0,
                foreign: 0,
            }),
            came: Condvar::new(),
        });
        let (name, theirs) = (choice.to_string(), Arc::clone(&shared));
        std::thread::Builder::new().name("gaze".to_owned()).spawn({
            let name = name.clone();
            move || receive(&name, feed, &theirs)
        })?;
        Ok(Self { name, shared })
    }

    /// Waits until a row came, at most `longest`; `interrupted` ends the wait with `false`.
    pub(crate) fn wait_for_first(
        &self,
        longest: Duration,
        interrupted: &AtomicBool,
    ) -> anyhow::Result<bool> {
        let until = Instant::now() + longest;
        let mut inner = self.shared.lock();
        while inner.waiting.is_empty() {
            if interrupted.load(Ordering::Relaxed) {
                return Ok(false);
            }
            if Instant::now() >= until {
                let skipped = match inner.intake.counts(0, 0).skipped {
                    0 => "nothing came at all".to_owned(),
                    skipped => format!("{} came without a gaze", counted(skipped, "message")),
                };
                let seconds = longest.as_secs();
                bail!(
                    "--gaze {}: no gaze came within {seconds} s ({skipped}); start the sender, or \
                     check where it sends to",
                    self.name
                );
            }
            let wait = Duration::from_millis(50);
            let woken = self.shared.came.wait_timeout(inner, wait);
            inner = woken.unwrap_or_else(PoisonError::into_inner).0;
        }
        Ok(true)
    }

    /// Takes the rows that came since the last call, oldest first.
    pub(crate) fn take(&self) -> Vec<TraceRow> {
        self.shared.lock().waiting.drain(..).collect()
    }

    /// The time now, by the clock of the rows.
    pub(crate) fn time(&self) -> Seconds {
        self.shared.lock().intake.stream.now(self.shared.elapsed())
    }

    /// What became of what was sent so far.
    pub(crate) fn counts(&self) -> Counts {
        let inner = self.shared.lock();
        inner.intake.counts(inner.dropped, inner.foreign)
    }

    /// The sender's own time of a row at 0.
    pub(crate) fn start(&self) -> Option<Seconds> {
        self.shared.lock().intake.stream.start()
    }
}

/// Whether the user, or the system, asked to stop. A second time ends the program at once.
pub(crate) fn interrupted() -> anyhow::Result<Arc<AtomicBool>> {
    let interrupted = Arc::new(AtomicBool::new(false));
    for signal in [signal_hook::consts::SIGINT, signal_hook::consts::SIGTERM] {
        signal_hook::flag::register_conditional_shutdown(signal, 1, Arc::clone(&interrupted))?;
        signal_hook::flag::register(signal, Arc::clone(&interrupted))?;
    }
    Ok(interrupted)
}

impl Drop for Live {
    /// Ends the thread at its next look, and says what could not be used.
    fn drop(&mut self) {
        self.shared.stop.store(true, Ordering::Relaxed);
        let counts = self.counts();
        if counts != Counts::default() {
            let Counts {
                skipped,
                late,
                dropped,
                foreign,
                anew,
                untimed,
            } = counts;
            say(&format!(
                "warning: {}: skipped {} without a gaze, {foreign} of other senders, {late} that \
                 came after newer ones, and {} not taken in time; its clock restarted {}, \
                 and {} were dated by their arrival",
                self.name,
                counted(skipped, "message"),
                counted(dropped, "sample"),
                counted(anew, "time"),
                counted(untimed, "sample")
            ));
        }
    }
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, Inner> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Our clock.
    fn elapsed(&self) -> Seconds {
        Seconds(self.begun.elapsed().as_secs_f64())
    }
}

impl Inner {
    fn push(&mut self, row: TraceRow) {
        if self.waiting.len() == MOST_WAITING {
            self.waiting.pop_front();
            self.dropped += 1;
        }
        self.waiting.push_back(row);
    }
}

fn receive(name: &str, mut feed: GazeFeed, shared: &Shared) {
    let mut buffer = Vec::new();
    while !shared.stop.load(Ordering::Relaxed) {
        let received = feed.receive(&mut buffer);
        let now = shared.elapsed();
        if let Received::Lost(why) = &received {
            say(&format!(
                "warning: {name}: connection lost ({why}); trying again"
            ));
        }
        let mut inner = shared.lock();
        if let Received::Foreign(sender) = &received {
            inner.foreign += 1;
            if inner.foreign == 1 {
                say(&format!(
                    "warning: {name}: {sender} sends too, and is left out while the first goes on; \
                     others like it are only counted"
                ));
            }
        }
        let mut rows = match received {
            Received::Message(sender) => {
                let skipped = inner.intake.counts(0, 0).skipped;
                let rows = inner.intake.take(&buffer, now);
                let is_gaze = !rows.is_empty() || inner.intake.counts(0, 0).skipped == skipped;
                if let Some(sender) = sender.filter(|_| is_gaze && !buffer.is_empty()) {
                    feed.hold(sender);
                }
                rows
            }
            _ => Vec::new(),
        };
        rows.extend(inner.intake.stream.silence(now));
        if !rows.is_empty() {
            rows.into_iter().for_each(|row| inner.push(row));
            shared.came.notify_all();
        }
    }
}
