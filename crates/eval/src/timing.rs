//! How long does a piece of work take one thread?

use serde::Serialize;
use std::time::Instant;

/// Times of one way to do something.
#[derive(Clone, Debug, Serialize)]
pub struct TimedRow {
    /// What was done.
    pub name: String,
    /// Half of the runs took at most this, in milliseconds.
    pub median_ms: f64,
    /// The fastest and the slowest run.
    pub range_ms: [f64; 2],
    /// Runs after the first, which is left out.
    pub runs: usize,
    /// Which time was taken.
    pub clock: Clock,
}

/// A way to measure time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Clock {
    /// What the thread has run for: other work on a busy machine is not counted. Linux moves this
    /// clock on by some milliseconds at a time.
    ThreadCpu,
    /// The GPU's own time stamps.
    Gpu,
    /// Time that passes, where the system does not report the other.
    Wall,
}

/// Milliseconds that this thread has run for, where the system says so (Linux).
fn thread_cpu_ms() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    let nanoseconds: f64 = text.split_whitespace().next()?.parse().ok()?;
    Some(nanoseconds / 1e6)
}

/// Milliseconds that this thread has run for, or where the system does not say, that have passed
/// since `begun`; with the clock.
#[must_use]
pub fn thread_ms(begun: Instant) -> (f64, Clock) {
    match thread_cpu_ms() {
        Some(ms) => (ms, Clock::ThreadCpu),
        None => (begun.elapsed().as_secs_f64() * 1000.0, Clock::Wall),
    }
}

/// Runs `work` once to warm up and `runs` times by the clock.
pub(crate) fn timed(name: &str, runs: usize, work: impl FnMut()) -> TimedRow {
    timed_parts(name, runs, 1, work)
}

/// The same for work that does something `parts` times: the times are those of one part.
pub(crate) fn timed_parts(
    name: &str,
    runs: usize,
    parts: usize,
    mut work: impl FnMut(),
) -> TimedRow {
    work();
    let mut clock = Clock::ThreadCpu;
    let mut times: Vec<f64> = (0..runs.max(1))
        .map(|_| {
            let start = (thread_cpu_ms(), Instant::now());
            work();
            let spent = match (start.0, thread_cpu_ms()) {
                (Some(before), Some(after)) => after - before,
                _ => {
                    clock = Clock::Wall;
                    start.1.elapsed().as_secs_f64() * 1000.0
                }
            };
            spent / parts as f64
        })
        .collect();
    times.sort_by(f64::total_cmp);
    TimedRow {
        name: name.to_owned(),
        median_ms: times[times.len() / 2],
        range_ms: [times[0], times[times.len() - 1]],
        runs: times.len(),
        clock,
    }
}
