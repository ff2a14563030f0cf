//! What a client has to send.

use super::super::super::bits::{head, part};
use super::super::super::can::{self, Splitter};
use super::super::super::{i2c, Direction};
use super::super::{Output, Transaction};
use super::{taken, Machine, QUEUE};

impl<const N: usize> Machine<N> {
    /// What is to be sent next.
    pub(in crate::wire::client) fn first(&self) -> Option<Output> {
        let [first, ..] = self.queue;
        first
    }

    /// Puts something to be sent behind what was not taken yet.
    pub(super) fn push(&mut self, output: Output) {
        if self.first() == Some(output) && self.queue[1].is_none() {
            self.repeats = self.repeats.saturating_add(1);
        } else if let Some(free) = self.queue.iter_mut().find(|place| place.is_none()) {
            *free = Some(output);
        }
    }

    /// The first of the queue was taken.
    pub(in crate::wire::client) fn sent(&mut self) {
        self.begun = 0;
        self.encoder = None;
        if self.repeats > 0 {
            self.repeats -= 1;
        } else {
            let [_, second, third, fourth] = self.queue;
            self.queue = [second, third, fourth, None];
        }
    }

    /// Return the number of transmissions of the request of which nothing was taken.
    pub(super) fn untaken(&self) -> u16 {
        let requests = self.queue.iter().flatten();
        let count = requests
            .filter(|output| **output == Output::Request)
            .count();
        let count = u16::try_from(count).unwrap_or(u16::MAX);
        let repeats = match self.first() {
            Some(Output::Request) => self.repeats,
            _ => 0,
        };
        let begun = u16::from(self.begun > 0 || self.encoder.is_some());
        count.saturating_add(repeats).saturating_sub(begun)
    }

    /// Nothing more is to be sent.
    pub(super) fn drop_output(&mut self) {
        self.begun = 0;
        self.encoder = None;
        self.repeats = 0;
        self.queue = [None; QUEUE];
    }

    pub(in crate::wire::client) fn packets(&self) -> Option<Splitter<'_>> {
        let message = can::Message {
            kind: match self.direction {
                Direction::Telecommand => can::Kind::Telecommand,
                Direction::Telemetry => can::Kind::Request,
            },
            id: self.id.into(),
            source: self.address,
            destination: self.link.can.as_ref()?.node_address.into(),
            data: part(&self.message, 1, self.length.saturating_sub(1)),
        };
        Splitter::new(self.link, &message).ok()
    }

    /// I2C: return what `taken` stores of a transaction.
    pub(in crate::wire::client) fn taken_as(&self, output: Output) -> taken::Transaction {
        let [poll_id] = self.poll;
        match output {
            Output::Request => taken::Transaction {
                id: self.id,
                reads: self.direction == Direction::Telemetry,
            },
            Output::Poll => taken::Transaction {
                id: poll_id,
                reads: true,
            },
        }
    }

    pub(in crate::wire::client) fn transaction(&self, output: Output) -> Transaction<'_> {
        let read = |id| i2c::read_length(self.link, id, self.checks_telemetry).unwrap_or(0);
        match output {
            Output::Request => Transaction {
                write: head(&self.message, self.length),
                read: match self.direction {
                    Direction::Telemetry => read(self.id),
                    Direction::Telecommand => 0,
                },
            },
            Output::Poll => {
                let [id] = self.poll;
                Transaction {
                    write: &self.poll,
                    read: read(id),
                }
            }
        }
    }
}
