//! Responses to requests.

use crate::wire::link::{Exchange, Response, Verdict};

/// Exchange of a telecommand to which nothing responds.
const SILENCE: &Exchange = &Exchange {
    sources: &[],
    responses: &[],
    timeout_ms: 0,
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

    pub(super) fn count(self) -> u16 {
        u16::from(self.ack) + u16::from(self.reply)
    }
}

/// Responses to a request: what can arrive, and the numbers that it must repeat.
#[derive(Clone, Copy, Debug)]
pub(super) struct Awaited {
    exchange: &'static Exchange,
    reply: Option<u32>, // id of the telemetry that the caller names instead
    sources: [u32; Exchange::SOURCES],
}

impl Awaited {
    pub(super) const NOTHING: Self = Self {
        exchange: SILENCE,
        reply: None,
        sources: [0; Exchange::SOURCES],
    };

    /// Return the responses to a telecommand with this id and data.
    pub(super) fn new(
        exchange: Option<&'static Exchange>,
        reply: Option<u32>,
        id: u32,
        data: &[u8],
    ) -> Self {
        let exchange = exchange.unwrap_or(SILENCE);
        let mut sources = [0; Exchange::SOURCES];
        for (number, place) in sources.iter_mut().zip(exchange.sources) {
            *number = place.get(&id.to_be_bytes(), data);
        }
        Self {
            exchange,
            reply,
            sources,
        }
    }

    fn responses(&self) -> impl Iterator<Item = Response> {
        let named = self.reply.map(|telemetry| Response {
            telemetry,
            verdict: Verdict::Reply,
            echoes: &[],
            status: None,
            meanings: &[],
            reason: None,
        });
        let others = self.exchange.responses.iter().copied();
        others
            .filter(move |response| named.is_none() || response.verdict != Verdict::Reply)
            .chain(named)
    }

    pub(super) fn is_empty(&self) -> bool {
        self.responses().next().is_none()
    }

    pub(super) fn needed(&self) -> Needed {
        let needs = |verdict| {
            self.responses().any(|response| {
                let mut meanings = response.meanings.iter();
                response.verdict == verdict || meanings.any(|(_, meaning)| *meaning == verdict)
            })
        };
        Needed {
            ack: needs(Verdict::Ack),
            reply: needs(Verdict::Reply),
        }
    }

    /// Return the response that telemetry is; None if it is none of them.
    pub(super) fn matching(&self, telemetry: u32, data: &[u8]) -> Option<Response> {
        self.responses().find(|response| {
            let mut echoes = response.echoes.iter();
            response.telemetry == telemetry
                && echoes.all(|echo| Some(echo.place.get(data, &[])) == self.source(echo.source))
        })
    }

    fn source(&self, index: usize) -> Option<u32> {
        self.sources.get(index).copied()
    }

    /// Return whether a response to one request could be taken for a response to the other.
    pub(super) fn is_like(&self, other: &Self) -> bool {
        self.responses().any(|mine| {
            other.responses().any(|theirs| {
                mine.telemetry == theirs.telemetry && !self.differs(&mine, other, &theirs)
            })
        })
    }

    /// Return whether a number that both responses repeat is a different one.
    fn differs(&self, mine: &Response, other: &Self, theirs: &Response) -> bool {
        mine.echoes.iter().any(|echo| {
            theirs.echoes.iter().any(|repeated| {
                echo.place == repeated.place
                    && self.source(echo.source) != other.source(repeated.source)
            })
        })
    }

    /// Return the number of awaited responses that one with this verdict replaces.
    pub(super) fn answered(&self, verdict: Verdict) -> u16 {
        match verdict {
            Verdict::Progress => 0,
            Verdict::Ack | Verdict::Reply => 1,
            Verdict::Nak | Verdict::Busy => self.needed().count(),
        }
    }
}

impl Response {
    /// Return what the response says.
    pub(super) fn verdict_of(&self, data: &[u8]) -> Verdict {
        let status = self.status.map(|place| place.get(data, &[]));
        let mut meanings = self.meanings.iter();
        let listed = meanings.find(|(value, _)| Some(*value) == status);
        listed.map_or(self.verdict, |(_, meaning)| *meaning)
    }
}
