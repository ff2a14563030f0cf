//! Lines: how requests are encoded for a link, and what its input is.

use super::awaited::Awaited;
use super::machine::Machine;
use crate::wire::link::{Bus, Response, ResponseKind, StreamRow, Verdict};
use crate::wire::stream::Values;
use crate::wire::{Error, Event, Request};
use core::fmt;

/// The line of a [`Client`](crate::wire::Client): `uart::Line`, `i2c::Line`, `can::Line` or
/// `stream::Line`.
pub trait Line: Transport {}

impl<L: Transport> Line for L {}

/// A line of bytes: `uart::Line` or `stream::Line`.
pub trait ByteLine: ByteTransport {}

impl<L: ByteTransport> ByteLine for L {}

/// Memory for a message.
pub trait Buffer: Copy + fmt::Debug + AsRef<[u8]> + AsMut<[u8]> {
    /// Zeros.
    const EMPTY: Self;
}

impl<const N: usize> Buffer for [u8; N] {
    const EMPTY: Self = [0; N];
}

/// The methods of [`Line`].
pub trait Transport {
    /// Memory for the longest message.
    type Buffer: Buffer;

    /// The bus; None: a framed link.
    const BUS: Option<Bus>;

    /// Return how a request is sent, and the responses to it.
    fn plan(&self, request: &Request<'_>) -> Result<Plan, Error>;

    /// Discard incomplete messages whose time is up.
    fn expire(&mut self, _now: u32, _on_event: &mut dyn FnMut(Event<'_>)) {}
}

/// The methods of [`ByteLine`].
pub trait ByteTransport: Transport {
    /// The numbers in front of a message that responses may repeat.
    type Header: AsRef<[u8]>;

    /// Encode what is sent for a request. Return its size and its header.
    fn encode(
        &mut self,
        sent: Sent,
        data: &[u8],
        out: &mut [u8],
    ) -> Result<(usize, Self::Header), Error>;

    /// Process received bytes.
    fn feed<const R: usize>(
        &mut self,
        bytes: &[u8],
        machine: &mut Machine<Self::Buffer, R>,
        on_event: &mut dyn FnMut(Event<'_>),
    );
}

/// What is sent, with its id.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sent {
    /// A telecommand.
    Telecommand(u32),
    /// A request of telemetry.
    Request(u32),
}

/// How a request is sent, and the responses to it.
#[derive(Clone, Copy, Debug)]
pub struct Plan {
    /// What is sent.
    pub sent: Sent,
    /// Least and most bytes of its data.
    pub lengths: (usize, usize),
    /// Whether it may be sent again after a time-out.
    pub repeats: bool,
    /// Whether it has a checksum that the device can find wrong.
    pub is_checked: bool,
    /// Its responses. The numbers of the data are missing.
    pub awaited: Awaited,
}

/// Telemetry or a packet without a message.
#[derive(Clone, Copy, Debug)]
pub struct Arrival<'a> {
    /// Id of the telemetry or packet.
    pub id: u32,
    /// Index of the format of a packet without a message.
    pub packet: Option<usize>,
    /// Bytes in front of the data, from which the places of numbers count.
    pub head: &'a [u8],
    /// The data.
    pub data: &'a [u8],
    /// Values of the header and trailer fields that the sender chose.
    pub values: &'a Values,
    /// Whether the device sends it only as a response.
    pub is_response: bool,
}

impl<'a> Arrival<'a> {
    /// Return telemetry on UART, I2C or CAN, which the device sends only if it is requested.
    pub(super) const fn of_telemetry(id: u32, data: &'a [u8]) -> Self {
        Self {
            id,
            packet: None,
            head: &[],
            data,
            values: &Values::NONE,
            is_response: true,
        }
    }

    pub(super) fn kind(&self) -> ResponseKind {
        self.packet
            .map_or(ResponseKind::Telemetry(self.id), ResponseKind::Packet)
    }

    pub(super) fn verdict(&self, response: &Response) -> Verdict {
        response.verdict_of(self.head, self.data)
    }

    /// Return the event of an arrival to a request that has ended.
    pub(super) const fn late(&self) -> Event<'a> {
        let Self {
            id, packet, data, ..
        } = *self;
        Event::Late { id, packet, data }
    }

    /// Return the event of an arrival for which no request waits.
    pub(super) const fn unawaited(&self) -> Event<'a> {
        let (packet, data, values) = (self.packet, self.data, self.values);
        if self.is_response {
            let id = Some(self.id);
            Event::Stray { id, packet, data }
        } else {
            let id = self.id;
            Event::Arrived { id, data, values }
        }
    }
}

/// Return the first telemetry that has this length, and otherwise the first.
pub(super) fn with_length(
    mut rows: impl Iterator<Item = &'static StreamRow> + Clone,
    length: usize,
) -> Option<(&'static StreamRow, bool)> {
    let fits = |row: &&StreamRow| (row.least..=row.most).contains(&length);
    let fitting = rows.clone().find(fits).map(|row| (row, true));
    fitting.or_else(|| rows.next().map(|row| (row, false)))
}
