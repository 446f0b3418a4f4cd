//! Single-producer, single-consumer queue between main loop and tick, lock-free and without a panic path.
//!
//! The queues are those of `heapless`, whose ends compute modulo a size that is known only at run time. For the
//! compiler it could be 0, and a remainder by 0 panics. Therefore each end checks the size first. A queue of size 0,
//! which does not exist, would always be full and empty.

use heapless::spsc::{self, Queue};

/// Capacity of a queue of size 0, after wrapping.
const SIZELESS: usize = usize::MAX;

/// Writing end of a queue.
pub struct Producer<'q, T>(spsc::Producer<'q, T>);

/// Reading end of a queue, first in, first out.
pub struct Consumer<'q, T>(spsc::Consumer<'q, T>);

/// Divides a queue into its writing and its reading end; it holds up to `N` - 1 items.
pub fn split<T, const N: usize>(queue: &mut Queue<T, N>) -> (Producer<'_, T>, Consumer<'_, T>) {
    let (producer, consumer) = queue.split();
    (Producer(producer), Consumer(consumer))
}

impl<T> Producer<'_, T> {
    /// Adds an item.
    ///
    /// # Errors
    /// Returns the item if the queue is full.
    #[inline(always)]
    pub fn enqueue(&mut self, item: T) -> Result<(), T> {
        if self.capacity() == SIZELESS { Err(item) } else { self.0.enqueue(item) }
    }

    /// Whether the queue can take another item.
    #[inline(always)]
    pub fn ready(&self) -> bool {
        self.capacity() != SIZELESS && self.0.ready()
    }

    /// Number of items in the queue.
    #[inline(always)]
    pub fn len(&self) -> usize {
        if self.capacity() == SIZELESS { 0 } else { self.0.len() }
    }

    /// Whether the queue is empty.
    #[inline(always)]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Largest number of items that the queue can hold.
    #[inline(always)]
    pub fn capacity(&self) -> usize {
        self.0.capacity()
    }
}

impl<T> Consumer<'_, T> {
    /// Removes and returns the first item.
    #[inline(always)]
    pub fn dequeue(&mut self) -> Option<T> {
        if self.0.capacity() == SIZELESS { None } else { self.0.dequeue() }
    }

    /// The first item, without removing it.
    #[inline(always)]
    pub fn peek(&self) -> Option<&T> {
        self.0.peek()
    }

    /// Number of items in the queue.
    #[inline(always)]
    pub fn len(&self) -> usize {
        if self.0.capacity() == SIZELESS { 0 } else { self.0.len() }
    }

    /// Whether the queue is empty.
    #[inline(always)]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn queue_keeps_the_order_and_returns_items_without_room() {
        let mut queue = Queue::<u8, 4>::new();
        let (mut producer, mut consumer) = split(&mut queue);
        for lap in 0..5 {
            assert_eq!((producer.len(), consumer.peek()), (0, None));
            assert_eq!([1, 2, 3, 4].map(|item| producer.enqueue(item + lap)), [Ok(()), Ok(()), Ok(()), Err(4 + lap)]);
            assert_eq!((producer.ready(), producer.capacity(), consumer.len()), (false, 3, 3));
            assert_eq!(consumer.peek(), Some(&(1 + lap)));
            assert_eq!([(); 4].map(|()| consumer.dequeue()), [Some(1 + lap), Some(2 + lap), Some(3 + lap), None]);
            assert!(consumer.is_empty() && producer.is_empty() && producer.ready());
        }
    }
}
