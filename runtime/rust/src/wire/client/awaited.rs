//! Responses to requests.

use super::line::Arrival;
use crate::wire::link::{Exchange, NumberPlace, Response, ResponseKind, StreamRow, Verdict};

/// Exchange of a telecommand to which nothing responds.
const SILENCE: &Exchange = &Exchange {
    sources: &[],
    in_header: 0,
    responses: &[],
    timeout_ms: 0,
    poll: None,
};

/// Telemetry that was requested, or that the caller names as the reply.
const REPLY: &Response = &Response {
    kind: ResponseKind::Requested,
    verdict: Verdict::Reply,
    echoes: &[],
    status: None,
    meanings: &[],
    reason: None,
    detail: None,
};

/// Responses without which a request is not done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Needed {
    pub(super) ack: bool,
    pub(super) reply: bool,
}

impl Needed {
    pub(super) const NONE: Self = Self {
        ack: false,
        reply: false,
    };
}

/// Numbers of responses that may still arrive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Owed {
    ack: u16,
    reply: u16,
}

impl Owed {
    pub(super) const NONE: Self = Self { ack: 0, reply: 0 };

    /// Add the responses to a transmission.
    pub(super) fn add(&mut self, needed: Needed) {
        self.ack = self.ack.saturating_add(u16::from(needed.ack));
        self.reply = self.reply.saturating_add(u16::from(needed.reply));
    }

    /// Remove the responses that one with this verdict is or replaces.
    pub(super) fn remove(&mut self, verdict: Verdict) {
        let (ack, reply) = match verdict {
            Verdict::Progress => (0, 0),
            Verdict::Ack => (1, 0),
            Verdict::Reply => (0, 1),
            Verdict::Nak | Verdict::Busy | Verdict::Again => (1, 1),
        };
        self.ack = self.ack.saturating_sub(ack);
        self.reply = self.reply.saturating_sub(reply);
    }
}

/// Responses to a request: what can arrive, and the numbers that it must repeat.
#[derive(Clone, Copy, Debug)]
pub struct Awaited {
    pub(super) exchange: &'static Exchange,
    id: u32,            // in which numbers are
    reply: Option<u32>, // id of the telemetry that replaces the replies of the exchange
    sources: [u32; Exchange::SOURCES],
    /// Expected telemetry that comes in a packet without its id.
    pub(super) nameless: Option<&'static StreamRow>,
}

impl Awaited {
    pub(super) const NOTHING: Self = Self {
        exchange: SILENCE,
        id: 0,
        reply: None,
        sources: [0; Exchange::SOURCES],
        nameless: None,
    };

    /// Return the responses to a request with this id. `named` is the id of the telemetry that is
    /// requested, or that the caller names as the reply.
    pub(super) fn new(exchange: Option<&'static Exchange>, named: Option<u32>, id: u32) -> Self {
        let exchange = exchange.unwrap_or(SILENCE);
        let mut replies = exchange.responses.iter();
        let kind = named.map(ResponseKind::Telemetry);
        // A reply of the exchange stays as it is, with its echo and status.
        let is_described =
            replies.any(|reply| Some(reply.kind) == kind && reply.can_be(Verdict::Reply));
        Self {
            exchange,
            id,
            reply: named.filter(|_| !is_described),
            ..Self::NOTHING
        }
    }

    /// Store the numbers of id and data.
    pub(super) fn set_data(&mut self, data: &[u8]) {
        let (in_message, _) = self.exchange.parts();
        for (number, place) in self.sources.iter_mut().zip(in_message) {
            *number = place.get(&self.id.to_be_bytes(), data);
        }
    }

    /// Store the numbers of the header with which the request was sent.
    pub(super) fn set_header(&mut self, header: &[u8]) {
        let (in_message, in_header) = self.exchange.parts();
        let numbers = self.sources.iter_mut().skip(in_message.len());
        for (number, place) in numbers.zip(in_header) {
            *number = place.get(header, &[]);
        }
    }

    /// Return whether a number is in id and data, so that it is known before it is sent.
    fn is_in_message(&self, source: usize) -> bool {
        source < self.exchange.parts().0.len()
    }

    fn responses(&self) -> impl Iterator<Item = &'static Response> {
        let is_named = self.reply.is_some();
        let others = self.exchange.responses.iter().filter(move |response| {
            let is_requested = response.kind == ResponseKind::Requested;
            !is_named || is_requested || !response.can_be(Verdict::Reply)
        });
        others.chain(self.reply.map(|_| REPLY))
    }

    /// Return what a response is, with the id of the telemetry that was requested.
    fn kind_of(&self, response: &Response) -> ResponseKind {
        match (self.reply, response.kind) {
            (Some(id), ResponseKind::Requested) => ResponseKind::Telemetry(id),
            (_, kind) => kind,
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.responses().next().is_none()
    }

    pub(super) fn needed(&self) -> Needed {
        let needs = |verdict| self.responses().any(|response| response.can_be(verdict));
        Needed {
            ack: needs(Verdict::Ack),
            reply: needs(Verdict::Reply),
        }
    }

    /// Return the response that an arrival is; None if it is none of them.
    pub(super) fn matching(&self, arrival: &Arrival<'_>) -> Option<&'static Response> {
        let number = |place: NumberPlace| Some(place.get(arrival.head, arrival.data));
        self.responses().find(|response| {
            let mut echoes = response.echoes.iter();
            self.kind_of(response) == arrival.kind()
                && echoes.all(|echo| number(echo.place) == self.source(echo.source))
        })
    }

    fn source(&self, index: usize) -> Option<u32> {
        self.sources.get(index).copied()
    }

    /// Return whether a response to one request could be taken for a response to the other.
    pub(super) fn is_like(&self, other: &Self) -> bool {
        if self.nameless.is_some() && other.nameless.is_some() {
            return true;
        }
        self.responses().any(|mine| {
            other.responses().any(|theirs| {
                self.kind_of(mine) == other.kind_of(theirs) && !self.differs(mine, other, theirs)
            })
        })
    }

    /// Return whether a number that both responses repeat is a different one.
    fn differs(&self, mine: &Response, other: &Self, theirs: &Response) -> bool {
        mine.echoes.iter().any(|echo| {
            theirs.echoes.iter().any(|repeated| {
                echo.place == repeated.place
                    && self.is_in_message(echo.source)
                    && other.is_in_message(repeated.source)
                    && self.source(echo.source) != other.source(repeated.source)
            })
        })
    }
}

impl Exchange {
    /// Return the sources in id and data, and those in the header.
    fn parts(&self) -> (&'static [NumberPlace], &'static [NumberPlace]) {
        let in_message = self.sources.len().saturating_sub(self.in_header);
        // `split_at` leaves a panic where a compiler does not see that this is inside.
        (
            self.sources.get(..in_message).unwrap_or(&[]),
            self.sources.get(in_message..).unwrap_or(&[]),
        )
    }
}

impl Response {
    fn can_be(&self, verdict: Verdict) -> bool {
        let mut meanings = self.meanings.iter();
        self.verdict == verdict || meanings.any(|(_, meaning)| *meaning == verdict)
    }

    /// Return what the response says.
    pub(in crate::wire) fn verdict_of(&self, head: &[u8], data: &[u8]) -> Verdict {
        let status = self.status.map(|place| place.get(head, data));
        let mut meanings = self.meanings.iter();
        let listed = meanings.find(|(value, _)| Some(*value) == status);
        listed.map_or(self.verdict, |(_, meaning)| *meaning)
    }
}
