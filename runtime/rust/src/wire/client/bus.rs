//! What the lines of UART, I2C and CAN have in common.

use super::awaited::Awaited;
use super::line::{Arrival, Plan, Sent};
use crate::wire::link::{Bus, BusExchanges, Link};
use crate::wire::message::octet;
use crate::wire::stream::Values;
use crate::wire::{i2c, Direction, Error, Event, Request};

/// Index of an acknowledge on UART and CAN.
pub const ACKNOWLEDGE: usize = 0;
/// Index of the refusal of a telecommand on CAN.
pub const REFUSAL: usize = 1;
/// Index of the refusal of a request on CAN.
pub const REQUEST_REFUSAL: usize = 2;
/// Index of a message that is neither a response nor telemetry of the device.
pub const OTHER: usize = 3;

/// What a line knows of its bus.
#[derive(Clone, Debug)]
pub(super) struct Messages {
    pub(super) link: &'static Link,
    exchanges: &'static BusExchanges,
    bus: Bus,
    pub(super) checks_telecommands: bool,
    pub(super) checks_telemetry: bool,
}

impl Messages {
    pub(super) fn new(link: &'static Link, bus: Bus) -> Result<Self, Error> {
        let exchanges = match bus {
            Bus::Uart => &link.exchanges.uart,
            Bus::I2c => &link.exchanges.i2c,
            Bus::Can => &link.exchanges.can,
        };
        let form = link.checksum.as_ref();
        Ok(Self {
            link,
            exchanges: exchanges.as_ref().ok_or(Error::Unsupported)?,
            bus,
            checks_telecommands: form.map_or(false, |form| form.telecommand_always.of(bus)),
            checks_telemetry: form.map_or(false, |form| form.telemetry_always.of(bus)),
        })
    }

    /// Use optional checksums.
    pub(super) fn enable_checksums(&mut self) {
        if let Some(form) = &self.link.checksum {
            self.checks_telecommands = form.telecommand_buses.of(self.bus);
            self.checks_telemetry = form.telemetry_buses.of(self.bus);
        }
    }

    pub(super) fn plan(&self, request: &Request<'_>) -> Result<Plan, Error> {
        let unknown = Error::UnknownId { id: request.id };
        let id = u8::try_from(request.id).map_err(|_| unknown)?;
        if request.direction == Direction::Telemetry {
            self.link.telemetry(id).ok_or(unknown)?;
            let exchange = Some(&self.exchanges.request);
            return Ok(Plan {
                sent: Sent::Request(request.id),
                lengths: (0, 0),
                repeats: true,
                is_checked: false,
                awaited: Awaited::new(exchange, Some(request.id), request.id),
            });
        }
        let form = self.link.telecommand(id).ok_or(unknown)?;
        if request.reply.is_some() {
            return Err(Error::Unsupported);
        }
        let exchange = self.exchanges.command.as_ref();
        let exchange = exchange.filter(|_| form.acknowledged);
        Ok(Plan {
            sent: Sent::Telecommand(request.id),
            lengths: (form.length, form.length),
            repeats: form.repeatable,
            is_checked: self.checks_telecommands,
            awaited: Awaited::new(exchange, None, request.id),
        })
    }

    /// Return the number of bytes that are sent for a request.
    pub(super) fn size(&self, sent: Sent, data_bytes: usize) -> usize {
        let is_checked = self.checks_telecommands && matches!(sent, Sent::Telecommand(_));
        let form = self.link.checksum.as_ref().filter(|_| is_checked);
        1 + data_bytes + form.map_or(0, |form| form.bytes)
    }

    /// Write what is sent for a request: id, data and checksum. Return the number of bytes.
    pub(super) fn write(&self, sent: Sent, data: &[u8], out: &mut [u8]) -> Result<usize, Error> {
        let (id, is_checked) = match sent {
            Sent::Telecommand(id) => (id, self.checks_telecommands),
            Sent::Request(id) => (id, false),
        };
        i2c::write(self.link, octet(id), data, is_checked, out)
    }

    /// Return the arrival of telemetry, or the error if it is damaged. Its length shows whether it
    /// has a checksum.
    pub(super) fn telemetry<'a>(&self, id: u32, data: &'a [u8]) -> Result<Arrival<'a>, Event<'a>> {
        let form = u8::try_from(id).ok().and_then(|id| self.link.telemetry(id));
        let length = match form {
            Some(form) => form.length,
            None => return Err(stray(id, data)),
        };
        let checksum = self.link.checksum.as_ref();
        let may_have = checksum.filter(|form| form.telemetry_buses.of(self.bus));
        let frame = if may_have.map_or(false, |form| data.len() == length + form.bytes) {
            let frame = i2c::reply(self.link, octet(id), data, true);
            frame.map_err(|_| Event::Checksum { id })?
        } else if data.len() != length {
            return Err(Event::Length { id: Some(id) });
        } else if self.checks_telemetry {
            return Err(Event::Unchecked { id });
        } else {
            data
        };
        Ok(Arrival::of_telemetry(id, frame))
    }
}

/// Return the arrival of a packet without a message. `head` is its id as a byte.
pub(super) const fn packet<'a>(
    packet: usize,
    id: u32,
    head: &'a [u8],
    data: &'a [u8],
) -> Arrival<'a> {
    Arrival {
        id,
        packet: Some(packet),
        head,
        data,
        values: &Values::NONE,
        is_response: true,
    }
}

/// Return the event of a message that no request can have.
pub(super) const fn stray(id: u32, data: &[u8]) -> Event<'_> {
    let (id, packet) = (Some(id), Some(OTHER));
    Event::Stray { id, packet, data }
}
