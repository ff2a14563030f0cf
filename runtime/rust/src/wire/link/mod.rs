//! The facts of a node's protocol. A part that the ICD does not describe is None.
//!
//! Times are milliseconds, sizes bytes.

mod can;
mod logs;
mod places;
mod stream;

pub use self::can::{Can, CanPart, CanTypes, Extended};
pub use self::logs::{IndexForm, LogBit, LogFile, LogMask, LogMessage, Span, TimeForm, TimePart};
pub use self::places::{Identification, Piece, Place};
pub use self::stream::{
    BusExchanges, CheckForm, CheckKind, ChecksumAlgorithm, Content, Delimiter, Echo, Escaping,
    Exchange, FieldRole, NumberPlace, PacketField, PacketForm, Poll, RequestForm, Response,
    ResponseKind, Stream, StreamRow, Verdict,
};

pub(crate) use self::places::get;

/// Everything that differs between the nodes. Each node's is the constant `LINK` of its module.
#[derive(Clone, Copy, Debug)]
pub struct Link {
    /// Name of the node in the ICD.
    pub node: &'static str,
    /// Type that the node reports.
    pub node_type: Option<u32>,
    /// Version of the interface in the ICD.
    pub interface_version: Option<u32>,
    /// Size in bytes of the longest message in either direction, with id and checksum.
    pub longest: usize,
    /// Size in bytes of the longest message in either direction, without id and checksum.
    pub longest_data: usize,
    /// Whether the least significant byte of a number comes first.
    pub little: bool,
    /// Ids of telemetry.
    pub telemetry_ids: Ids,
    /// The telecommands.
    pub telecommands: &'static [Form],
    /// The telemetry.
    pub telemetry: &'static [Form],
    /// Default timeouts and retries of a client.
    pub client: Settings,
    /// Codes of refusals on UART and I2C that the enumeration of the codes has.
    pub reasons: &'static [u32],
    /// How messages are delimited on the UART.
    pub framing: Option<Framing>,
    /// Length of the acknowledge on the UART.
    pub acknowledge_bytes: Option<usize>,
    /// The address on the I2C bus, of 7 bits.
    pub i2c_address: Option<u8>,
    /// Whether a read may follow its write on the I2C bus without a stop.
    pub i2c_repeated_start: bool,
    /// CAN.
    pub can: Option<Can>,
    /// All checksums, by their names in the ICD.
    pub checksums: &'static [(&'static str, ChecksumAlgorithm)],
    /// The optional checksum of messages.
    pub checksum: Option<Checksum>,
    /// The mask of a telemetry log.
    pub mask: Option<LogMask>,
    /// The file form of a log.
    pub log_file: Option<LogFile>,
    /// The unsolicited form of a log.
    pub log_message: Option<LogMessage>,
    /// Date and time packed into bits.
    pub time: Option<TimeForm>,
    /// Entries of the index file.
    pub index: Option<IndexForm>,
    /// UART: telemetry that the node sends unasked, by the id at the beginning of the message.
    pub unsolicited: &'static [(u8, u8)],
    /// Responses on each bus.
    pub exchanges: PerBus<Option<BusExchanges>>,
    /// The frame that identifies the node.
    pub identification: Option<Identification>,
    /// Time in milliseconds that the bootloader waits before it starts the program.
    pub boot_ms: Option<u32>,
    /// Framing. If present, ids have up to 32 bits and the other parts are empty.
    pub stream: Option<Stream>,
}

impl Link {
    /// Return the telecommand with this id.
    #[must_use]
    pub fn telecommand(&self, id: u8) -> Option<&'static Form> {
        self.telecommands.iter().find(|form| form.id == id)
    }

    /// Return the telemetry with this id.
    #[must_use]
    pub fn telemetry(&self, id: u8) -> Option<&'static Form> {
        self.telemetry.iter().find(|form| form.id == id)
    }
}

/// A bus.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Bus {
    /// UART.
    Uart,
    /// I2C, as the master.
    I2c,
    /// CAN.
    Can,
}

/// A value for each bus.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PerBus<T> {
    /// On the UART.
    pub uart: T,
    /// On I2C.
    pub i2c: T,
    /// On CAN.
    pub can: T,
}

impl<T: Copy> PerBus<T> {
    /// Return the value for a bus.
    pub const fn of(&self, bus: Bus) -> T {
        match bus {
            Bus::Uart => self.uart,
            Bus::I2c => self.i2c,
            Bus::Can => self.can,
        }
    }
}

/// Ids from the first to the last.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ids {
    /// The first.
    pub first: u8,
    /// The last.
    pub last: u8,
}

impl Ids {
    /// Whether the id is one of them.
    #[must_use]
    pub const fn contains(&self, id: u8) -> bool {
        self.first <= id && id <= self.last
    }
}

/// A message with its id and length.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Form {
    /// Its id.
    pub id: u8,
    /// Bytes of its data.
    pub length: usize,
    /// Whether a telecommand is acknowledged.
    pub acknowledged: bool,
    /// Whether it may be sent again if the node may already have received it.
    pub repeatable: bool,
}

/// Largest number of requests whose responses are awaited or may still arrive late.
pub(in crate::wire) const MOST_AWAITED: usize = 8;

/// Timeouts (in milliseconds) and retries of a client.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Settings {
    /// Time-out of a reply.
    pub reply_timeout_ms: u32,
    /// Number of retries of a request.
    pub retries: u8,
    /// Time between two polls for an acknowledge.
    pub poll_interval_ms: u32,
    /// Longest processing time of a telecommand.
    pub poll_timeout_ms: u32,
    /// Time after a time-out in which a response can still come.
    pub late_ms: u32,
    /// Pause before a request is sent to a busy device again.
    pub busy_pause_ms: u32,
    /// Shortest time between two transmissions.
    pub gap_ms: u32,
    /// Number of requests that the device handles at a time.
    pub in_flight: u8,
    /// Longest time by which reports of progress extend a time-out.
    pub progress_for_ms: u32,
}

/// How messages are delimited on the UART. The escape byte comes before each of the other three.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Framing {
    /// The escape byte.
    pub escape: u8,
    /// Follows the escape byte at the beginning of a message.
    pub start: u8,
    /// Follows the escape byte at the end of a message.
    pub end: u8,
    /// Follows the escape byte if the escape byte itself is data.
    pub escaped: u8,
    /// Whether the id is escaped like the data.
    pub escapes_id: bool,
    /// Whether an escape byte and an unknown byte are skipped; otherwise it is an error.
    pub ignores_other: bool,
}

/// Parameters of a CRC of up to 32 bits in the notation of the usual catalogues.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CrcForm {
    /// Bits of the checksum.
    pub width: u32,
    /// Generator polynomial, most significant bit first, without the leading term.
    pub polynomial: u32,
    /// Initial value of the register.
    pub init: u32,
    /// Whether each byte enters least significant bit first.
    pub reflect_in: bool,
    /// Whether the bits of the register are reversed at the end.
    pub reflect_out: bool,
    /// Final XOR value: combined with the register at the end.
    pub xor_out: u32,
    /// Checksum of no bytes, if it is not the result of the algorithm.
    pub empty: Option<u32>,
}

impl CrcForm {
    pub(crate) const fn unused_bits(&self) -> u32 {
        32_u32.wrapping_sub(self.width)
    }

    pub(crate) const fn aligned_polynomial(&self) -> u32 {
        self.polynomial.wrapping_shl(self.unused_bits())
    }
}

/// The optional checksum of telecommands and frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Checksum {
    /// Whether the checksum covers the id byte.
    pub covers_id: bool,
    /// Buses on which telecommands may have a checksum.
    pub telecommand_buses: PerBus<bool>,
    /// Buses on which telemetry may have a checksum.
    pub telemetry_buses: PerBus<bool>,
    /// Buses on which telecommands must have a checksum.
    pub telecommand_always: PerBus<bool>,
    /// Buses on which telemetry always has a checksum.
    pub telemetry_always: PerBus<bool>,
    /// Length of the checksum.
    pub bytes: usize,
    /// How it is computed.
    pub algorithm: ChecksumAlgorithm,
}
