//! Work on all threads of the computer.
//!
//! Rayon's own functions are compiled anew, some forty of them, for each closure; these are compiled once for each type of item and result.

use std::sync::OnceLock;

use rayon::iter::{IntoParallelIterator, ParallelIterator};

/// Most parts into which work is divided; a thread that is free takes the next one.
const PARTS_MAX: usize = 512;

/// Results of `each` for all items, in their order.
pub fn map<T: Sync, R: Send + Sync>(items: &[T], each: &(dyn Fn(&T) -> R + Sync)) -> Vec<R> {
    filter_map(items, &|item| Some(each(item)))
}

/// Results of `each` for the items for which it has one, in their order.
pub fn filter_map<T: Sync, R: Send + Sync>(items: &[T], each: &(dyn Fn(&T) -> Option<R> + Sync)) -> Vec<R> {
    let found: Vec<OnceLock<R>> = items.iter().map(|_| OnceLock::new()).collect();
    for_each(items.len(), &|index| {
        if let Some(result) = each(&items[index]) {
            found[index].get_or_init(|| result);
        }
    });
    found.into_iter().filter_map(OnceLock::into_inner).collect()
}

/// Results of two functions, which run at the same time if a thread is free.
pub fn join<A: Send, B: Send>(one: impl FnOnce() -> A + Send, other: impl FnOnce() -> B + Send) -> (A, B) {
    let (mut one, mut other) = (Some(one), Some(other));
    let (mut found, mut found_other) = (None, None);
    both(&mut || found = one.take().map(|one| one()), &mut || found_other = other.take().map(|other| other()));
    found.zip(found_other).expect("both have run")
}

fn for_each(count: usize, each: &(dyn Fn(usize) + Sync)) {
    let length = count.div_ceil(PARTS_MAX).max(1);
    let part = |part: usize| (part * length..count.min((part + 1) * length)).for_each(each);
    (0..count.div_ceil(length)).into_par_iter().for_each(part);
}

fn both(one: &mut (dyn FnMut() + Send), other: &mut (dyn FnMut() + Send)) {
    rayon::join(one, other);
}

#[cfg(test)]
mod tests {
    use core::sync::atomic::{AtomicUsize, Ordering};
    use std::time::{Duration, Instant};

    use super::*;

    /// Begins, and waits until another one has begun; whether it has.
    fn meets_another(begun: &AtomicUsize) -> bool {
        begun.fetch_add(1, Ordering::SeqCst);
        let start = Instant::now();
        while begun.load(Ordering::SeqCst) < 2 && start.elapsed() < Duration::from_secs(20) {
            std::thread::yield_now();
        }
        begun.load(Ordering::SeqCst) == 2
    }

    #[test]
    fn two_threads_work_at_the_same_time() {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap();
        let begun = AtomicUsize::new(0);
        assert_eq!(pool.install(|| map(&[(); 2], &|()| meets_another(&begun))), [true; 2]);
        let begun = AtomicUsize::new(0);
        assert_eq!(pool.install(|| join(|| meets_another(&begun), || meets_another(&begun))), (true, true));
    }

    #[test]
    fn results_are_in_the_order_of_their_items() {
        for count in [0, 1, 511, 512, 513, 100_003] {
            let items: Vec<usize> = (0..count).collect();
            assert_eq!(map(&items, &|item| item * 3), items.iter().map(|item| item * 3).collect::<Vec<_>>());
            let odd = filter_map(&items, &|item| (item % 2 == 1).then_some(*item));
            assert_eq!(odd, items.iter().copied().skip(1).step_by(2).collect::<Vec<_>>());
        }
    }

    #[test]
    fn each_function_has_its_own_result() {
        let (sum, (text, none)) = join(|| (1..=100).sum::<u32>(), || join(|| "b".repeat(3), || None::<u8>));
        assert_eq!((sum, text.as_str(), none), (5050, "bbb", None));
    }
}
