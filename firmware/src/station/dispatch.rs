//! What goes from the desk to the tick: words at once, orders in their turn, and none of either lost where a queue has no room.

use arcfeed_shared::units::{Micros, Nm};
use heapless::Deque;

use crate::active::ActiveSegment;
use crate::spsc::{Consumer, Producer};
use crate::supervisor::Supervisor;

use super::order::{Ahead, Order, Told, Word};

/// Words that may wait for the tick.
const WORDS: usize = 8;

/// The desk's side of the queues; state.
pub struct Dispatch<'q> {
    orders: Producer<'q, Order>,
    words: Producer<'q, Word>,
    told: Consumer<'q, Told>,
    waiting: Deque<Word, WORDS>,
    /// Parameters or settings that the tick has still to be told.
    owed: Option<Supervisor>,
    run: u32,
}

impl<'q> Dispatch<'q> {
    /// Nothing said yet.
    pub fn new(orders: Producer<'q, Order>, words: Producer<'q, Word>, told: Consumer<'q, Told>) -> Self {
        Dispatch { orders, words, told, waiting: Deque::new(), owed: None, run: 0 }
    }

    /// Whether nothing waits for room.
    pub fn is_done(&self) -> bool {
        self.waiting.is_empty() && self.owed.is_none()
    }

    /// Hands on what waits, as far as there is room.
    pub fn hand_on(&mut self) {
        while self.words.ready()
            && let Some(word) = self.waiting.pop_front()
        {
            let _room = self.words.enqueue(word);
        }
        if self.waiting.is_empty()
            && self.orders.ready()
            && let Some(supervisor) = self.owed.take()
        {
            let _room = self.orders.enqueue(Order::Parameters(supervisor));
        }
    }

    /// Says something that the tick must know at once.
    pub fn say(&mut self, word: Word) {
        let at_once = self.waiting.is_empty() && self.words.enqueue(word).is_ok();
        if !at_once {
            // Full only where no tick comes any more.
            let _room = self.waiting.push_back(word);
        }
    }

    /// The host was heard. It will be heard again: other words go first.
    pub fn heard(&mut self, at: Micros) {
        if self.waiting.is_empty() && self.words.len() < self.words.capacity() / 2 {
            let _room = self.words.enqueue(Word::Heard(at));
        }
    }

    /// Begins a new run: segments that are not done are forgotten.
    pub fn begin_run(&mut self) {
        self.run = self.run.wrapping_add(1);
        self.say(Word::Run(self.run));
    }

    /// Parameters and settings in force from here on.
    pub fn order(&mut self, supervisor: Supervisor) {
        self.owed = Some(supervisor);
        self.hand_on();
    }

    /// Adds a segment of this run; false, and nothing changed, if there is no room.
    pub fn put(&mut self, count: u32, segment: ActiveSegment, begins_at: Option<[Nm; 3]>) -> bool {
        let ahead = Ahead { run: self.run, count, begins_at, segment };
        self.orders.enqueue(Order::Segment(ahead)).is_ok()
    }

    /// Whether nothing is ahead of the tick.
    pub fn is_empty(&self) -> bool {
        self.orders.is_empty()
    }

    /// How many segments there is room for.
    pub fn room(&self) -> usize {
        self.capacity().saturating_sub(self.orders.len())
    }

    /// How many there could be room for.
    pub fn capacity(&self) -> usize {
        self.orders.capacity()
    }

    /// What the tick told next.
    pub fn told(&mut self) -> Option<Told> {
        self.told.dequeue()
    }
}
