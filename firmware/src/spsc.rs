//! The two ends of a queue between main loop and tick: one producer, one consumer, no lock, no panic within reach.
//!
//! The queues are those of `heapless`, whose ends count modulo a size that they look up as they go: as far as the compiler
//! knows it could be 0, and a remainder by 0 is a panic. So each end asks for the size first. A queue of size 0, which there is
//! none of, would be always full and always empty.

use heapless::spsc::{self, Queue};

/// What the capacity of a queue of size 0 wraps to.
const SIZELESS: usize = usize::MAX;

/// The end where things are put in.
pub struct Producer<'q, T>(spsc::Producer<'q, T>);

/// The end where they are taken out, in the same order.
pub struct Consumer<'q, T>(spsc::Consumer<'q, T>);

/// Both ends of a queue; it holds one less than its `N`.
pub fn split<T, const N: usize>(queue: &mut Queue<T, N>) -> (Producer<'_, T>, Consumer<'_, T>) {
    let (producer, consumer) = queue.split();
    (Producer(producer), Consumer(consumer))
}

impl<T> Producer<'_, T> {
    /// Puts one in.
    ///
    /// # Errors
    /// There is no room: it is given back.
    #[inline(always)]
    pub fn enqueue(&mut self, item: T) -> Result<(), T> {
        if self.capacity() == SIZELESS { Err(item) } else { self.0.enqueue(item) }
    }

    /// Whether there is room for one.
    #[inline(always)]
    pub fn ready(&self) -> bool {
        self.capacity() != SIZELESS && self.0.ready()
    }

    /// How many are in it.
    #[inline(always)]
    pub fn len(&self) -> usize {
        if self.capacity() == SIZELESS { 0 } else { self.0.len() }
    }

    /// Whether there is none.
    #[inline(always)]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// How many it holds at most.
    #[inline(always)]
    pub fn capacity(&self) -> usize {
        self.0.capacity()
    }
}

impl<T> Consumer<'_, T> {
    /// Takes the first one out.
    #[inline(always)]
    pub fn dequeue(&mut self) -> Option<T> {
        if self.0.capacity() == SIZELESS { None } else { self.0.dequeue() }
    }

    /// The first one, which stays.
    #[inline(always)]
    pub fn peek(&self) -> Option<&T> {
        self.0.peek()
    }

    /// How many are in it.
    #[inline(always)]
    pub fn len(&self) -> usize {
        if self.0.capacity() == SIZELESS { 0 } else { self.0.len() }
    }

    /// Whether there is none.
    #[inline(always)]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_goes_in_comes_out_in_order_and_what_has_no_room_comes_back() {
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
