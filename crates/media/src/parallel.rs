//! How is independent work spread over threads without changing its result?

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// `work` on every item, on up to `jobs` threads; results in the order of the items.
pub(crate) fn in_parallel<T: Send, R: Send>(
    jobs: usize,
    items: &mut [T],
    work: impl Fn(&mut T) -> R + Sync,
) -> Vec<R> {
    let next = AtomicUsize::new(0);
    let slots: Vec<Mutex<(&mut T, Option<R>)>> = items
        .iter_mut()
        .map(|item| Mutex::new((item, None)))
        .collect();
    let worker = || {
        // Each index is handed out once, so no lock is ever waited for.
        while let Some(slot) = slots.get(next.fetch_add(1, Ordering::Relaxed)) {
            if let Ok(mut slot) = slot.lock() {
                slot.1 = Some(work(slot.0));
            }
        }
    };
    std::thread::scope(|scope| {
        for _ in 1..jobs.clamp(1, slots.len().max(1)) {
            scope.spawn(worker);
        }
        worker();
    });
    let done = slots.into_iter().filter_map(|slot| slot.into_inner().ok());
    done.filter_map(|(_, result)| result).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_come_in_the_order_of_the_items_for_any_number_of_threads() {
        for jobs in [1, 2, 7, 100] {
            let mut items: Vec<u32> = (0..50).collect();
            let squares = in_parallel(jobs, &mut items, |n| *n * *n);
            assert_eq!(squares, (0..50).map(|n| n * n).collect::<Vec<_>>());
        }
        assert!(in_parallel(4, &mut [] as &mut [u32], |n| *n).is_empty());
    }
}
