//! CAN: messages and packets.

mod joiner;
mod splitter;
mod transaction;

use super::link::{Can, CanPart, CanTypes};

pub use self::joiner::{Event, Joiner};
pub use self::splitter::Splitter;
pub use super::client::can::Line;

/// Most bytes of a CAN frame.
pub const PACKET_BYTES: usize = 8;

/// What a message is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kind {
    /// A telecommand.
    Telecommand,
    /// Its acknowledge.
    Acknowledge,
    /// It is refused.
    Refusal,
    /// A request of telemetry.
    Request,
    /// The telemetry frame; empty for a telecommand.
    Reply,
    /// The request is refused.
    RequestRefusal,
}

impl Kind {
    const ALL: [Self; 6] = [
        Self::Telecommand,
        Self::Acknowledge,
        Self::Refusal,
        Self::Request,
        Self::Reply,
        Self::RequestRefusal,
    ];

    const fn has_data(self) -> bool {
        matches!(self, Self::Telecommand | Self::Reply)
    }
}

/// A message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Message<'a> {
    /// Role of the field.
    pub kind: Kind,
    /// The id of the telecommand or telemetry.
    pub id: u32,
    /// The sender's address.
    pub source: u32,
    /// The receiver's address.
    pub destination: u32,
    /// Its data.
    pub data: &'a [u8],
}

/// A CAN frame with a 29-bit identifier.
///
/// ```
/// use icdgen_runtime::wire::can::Packet;
///
/// let packet = Packet::new(0x0101_0701, &[90]).unwrap();
/// assert_eq!(packet.data(), [90]);
/// assert!(Packet::new(1, &[0; 9]).is_none());
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Packet {
    /// The identifier.
    pub id: u32,
    data: [u8; PACKET_BYTES],
    length: usize,
}

impl Packet {
    /// A packet; None if there are too many bytes.
    #[must_use]
    pub fn new(id: u32, data: &[u8]) -> Option<Self> {
        let mut packet = Self {
            id,
            length: data.len(),
            ..Self::default()
        };
        packet.data.get_mut(..data.len())?;
        super::bits::copy(&mut packet.data, data);
        Some(packet)
    }

    /// The data.
    #[must_use]
    pub fn data(&self) -> &[u8] {
        super::bits::head(&self.data, self.length)
    }
}

impl CanTypes {
    const fn of(&self, kind: Kind) -> Option<u32> {
        match kind {
            Kind::Telecommand => self.telecommand,
            Kind::Acknowledge => self.acknowledge,
            Kind::Refusal => self.refusal,
            Kind::Request => self.request,
            Kind::Reply => self.reply,
            Kind::RequestRefusal => self.request_refusal,
        }
    }

    fn kind(&self, number: u32) -> Option<Kind> {
        let mut kinds = Kind::ALL.iter().copied();
        kinds.find(|kind| self.of(*kind) == Some(number))
    }
}

impl CanPart {
    const fn mask(self) -> u32 {
        u32::MAX.wrapping_shr(32_u32.wrapping_sub(self.bits))
    }

    const fn get(self, id: u32) -> u32 {
        id.wrapping_shr(self.shift) & self.mask()
    }

    fn put(self, value: u32) -> Option<u32> {
        (value <= self.mask()).then(|| value.wrapping_shl(self.shift))
    }
}

impl Can {
    fn identifier(&self, kind: u32, message: &Message<'_>) -> Option<u32> {
        Some(
            self.kind.put(kind)?
                | self.id.put(message.id)?
                | self.source.put(message.source)?
                | self.destination.put(message.destination)?,
        )
    }

    fn room(&self, kind: Kind) -> usize {
        if kind.has_data() {
            self.data_bytes.min(PACKET_BYTES)
        } else {
            0
        }
    }
}
