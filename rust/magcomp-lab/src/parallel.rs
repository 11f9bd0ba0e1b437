//! Work over all cores, with results that do not depend on their number.

use magcomp_replay::progress;
use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Threads that run at once here, at least one.
pub fn cores() -> NonZeroUsize {
    std::thread::available_parallelism().unwrap_or(NonZeroUsize::MIN)
}

/// What `of` makes of each item, in the order of the items; `threads` of them are worked on at a time.
pub fn map<T: Sync, R: Send>(items: &[T], threads: NonZeroUsize, of: impl Fn(&T) -> R + Sync) -> Vec<R> {
    let next = AtomicUsize::new(0);
    let work = || {
        let mut done = Vec::new();
        while let Some((k, item)) = Some(next.fetch_add(1, Ordering::Relaxed)).and_then(|k| Some((k, items.get(k)?))) {
            done.push((k, of(item)));
        }
        done
    };
    let mut all: Vec<(usize, R)> = std::thread::scope(|scope| {
        let threads: Vec<_> = (0..threads.get()).map(|_| scope.spawn(work)).collect();
        let done = threads.into_iter().map(|thread| thread.join());
        done.flat_map(|done| done.unwrap_or_else(|panic| std::panic::resume_unwind(panic))).collect()
    });
    all.sort_by_key(|(k, _)| *k);
    all.into_iter().map(|(_, result)| result).collect()
}

/// What `of` makes of each item, as [`map`], a step of progress for each.
pub fn map_shown<T: Sync, R: Send>(
    what: &'static str,
    items: &[T],
    threads: NonZeroUsize,
    of: impl Fn(&T) -> R + Sync,
) -> Vec<R> {
    let bar = progress::bar(items.len(), what);
    let made = map(items, threads, |item| {
        let made = of(item);
        bar.inc(1);
        made
    });
    bar.finish_and_clear();
    made
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_come_in_order_whatever_the_number_of_threads() {
        let items: Vec<u64> = (0..200).collect();
        // the first items take longest, so that later ones are done before them
        let slow =
            |item: &u64| (0..(200 - item) * 1000).fold(*item, |sum, k| std::hint::black_box(sum ^ (k & 1) ^ (k & 1)));
        for threads in [1, 2, 7, 300] {
            assert_eq!(map(&items, NonZeroUsize::new(threads).unwrap(), slow), items, "{threads}");
        }
        assert!(map(&[], cores(), slow).is_empty());
    }
}
