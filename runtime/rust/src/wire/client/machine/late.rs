//! Responses that may still arrive although their request has ended.

use super::super::super::bits::reached;
use super::super::super::link::MOST_AWAITED;
use super::super::super::Direction;

#[derive(Clone, Copy, Debug)]
struct Entry {
    direction: Direction,
    id: u8,
    responses: u16,
    until: u32,
}

#[derive(Clone, Debug)]
pub(super) struct Late([Option<Entry>; MOST_AWAITED]);

impl Late {
    pub(super) const NONE: Self = Self([None; MOST_AWAITED]);

    /// Remember the responses to a request that has ended. They can arrive until a time.
    pub(super) fn add(&mut self, direction: Direction, id: u8, responses: u16, until: u32) {
        let free = self.0.iter_mut().find(|entry| entry.is_none());
        if let Some(free) = free.filter(|_| responses > 0) {
            *free = Some(Entry {
                direction,
                id,
                responses,
                until,
            });
        }
    }

    /// Forget the responses that can no longer arrive.
    pub(super) fn forget(&mut self, now: u32) {
        self.retain(|entry| !reached(now, entry.until));
    }

    /// Count a response that no request waits for. Return whether its request has ended.
    pub(super) fn count(&mut self, direction: Direction, id: u32) -> bool {
        let mut is_late = false;
        for entry in self.0.iter_mut().flatten() {
            if entry.direction == direction && u32::from(entry.id) == id {
                entry.responses -= 1;
                is_late = true;
            }
        }
        self.retain(|entry| entry.responses > 0);
        is_late
    }

    /// Return until when a request must not be sent; None: it may be sent. A late response could be
    /// taken for its own. So that the responses to all requests can be remembered, no other one is
    /// sent either while the memory is full.
    pub(super) fn hold(&self, direction: Direction, id: u8) -> Option<u32> {
        let is_full = self.0.iter().all(Option::is_some);
        let entries = self.0.iter().flatten();
        let blocking = entries.filter(|it| is_full || (it.direction, it.id) == (direction, id));
        let ends = blocking.map(|entry| entry.until);
        ends.reduce(|time, other| if reached(time, other) { other } else { time })
    }

    fn retain(&mut self, is_kept: impl Fn(&Entry) -> bool) {
        for entry in &mut self.0 {
            *entry = entry.filter(&is_kept);
        }
    }
}
