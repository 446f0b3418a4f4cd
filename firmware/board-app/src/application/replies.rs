//! Answers to the host that wait for the link.

use arcfeed_link::message::codes::RefusalCode;
use arcfeed_link::message::{Message, table};
use heapless::Deque;

/// Maximum number of answers that wait for the link.
const CAPACITY: usize = 8;

/// Queue of answers to the host.
#[derive(Debug, Default)]
pub struct Replies {
    queue: Deque<Message, CAPACITY>,
}

impl Replies {
    /// Whether there is room for the answers of another message of the host.
    pub fn has_room(&self) -> bool {
        self.queue.len() < CAPACITY / 2
    }

    /// Queues an answer. A host that sends requests faster than it reads loses answers.
    pub fn push(&mut self, message: Message) {
        let _room = self.queue.push_back(message);
    }

    /// Queues the refusal of a message: its kind, the number in it that `why` refers to, and the reason.
    pub fn refuse(&mut self, kind: u8, reference: u32, why: RefusalCode) {
        self.push(table::Refused { kind, reference, why }.into());
    }

    /// The next answer; `None` if none waits.
    pub fn pop(&mut self) -> Option<Message> {
        self.queue.pop_front()
    }

    /// Puts an answer that could not be sent back in front of the others.
    pub fn requeue(&mut self, reply: Message) {
        let _room = self.queue.push_front(reply);
    }

    /// Discards all answers.
    pub fn clear(&mut self) {
        self.queue.clear();
    }
}
