//! How is drawing shared among threads, with the same outcome for any number of them?

use anyhow::Context;
use std::thread::{Builder, ScopedJoinHandle, scope};

/// What `make` makes of all, on so many threads, in their order.
///
/// # Errors
/// The first that `make` meets, or a thread that cannot be had.
pub(crate) fn in_parallel<A: Sync, B: Send>(
    jobs: usize,
    all: &[A],
    make: impl Fn(&A) -> anyhow::Result<B> + Sync,
) -> anyhow::Result<Vec<B>> {
    let some = all.len().div_ceil(jobs.max(1)).max(1);
    let make = &make;
    let made = scope(|scope| {
        let parts = all.chunks(some).map(|part| {
            let work = move || part.iter().map(make).collect::<anyhow::Result<Vec<B>>>();
            Builder::new().spawn_scoped(scope, work)
        });
        let parts = parts.collect::<Result<Vec<_>, _>>();
        let parts = parts.context("no thread can be had for drawing")?;
        let join = |part: ScopedJoinHandle<'_, _>| {
            part.join()
                .unwrap_or_else(|panic| std::panic::resume_unwind(panic))
        };
        parts
            .into_iter()
            .map(join)
            .collect::<anyhow::Result<Vec<Vec<B>>>>()
    })?;
    Ok(made.into_iter().flatten().collect())
}
