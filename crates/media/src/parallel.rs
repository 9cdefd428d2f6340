//! How does work that falls into independent parts use all cores?

use std::sync::atomic::{AtomicUsize, Ordering};

/// The results of `work(0)` to `work(count - 1)` in that order, computed by `jobs` threads.
///
/// Each part is computed by one thread alone, so the results do not depend on `jobs`.
pub(crate) fn in_parallel<T: Send>(
    jobs: usize,
    count: usize,
    work: impl Fn(usize) -> T + Sync,
) -> Vec<T> {
    let next = AtomicUsize::new(0);
    let take = || {
        let mut done = Vec::new();
        loop {
            let part = next.fetch_add(1, Ordering::Relaxed);
            if part >= count {
                return done;
            }
            done.push((part, work(part)));
        }
    };
    let mut all = std::thread::scope(|scope| {
        // Where the system gives fewer threads, these take longer.
        let other = |_| std::thread::Builder::new().spawn_scoped(scope, take).ok();
        let others: Vec<_> = (1..jobs.clamp(1, count.max(1))).map_while(other).collect();
        let mut all = take();
        for other in others {
            match other.join() {
                Ok(done) => all.extend(done),
                Err(panic) => std::panic::resume_unwind(panic),
            }
        }
        all
    });
    all.sort_unstable_by_key(|&(part, _)| part);
    all.into_iter().map(|(_, result)| result).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_come_in_order_for_any_number_of_threads() {
        for jobs in [0, 1, 2, 7, 100] {
            let squares = in_parallel(jobs, 50, |n| n * n);
            assert_eq!(squares, (0..50).map(|n| n * n).collect::<Vec<_>>());
        }
        assert!(in_parallel(4, 0, |n| n).is_empty());
    }
}
