//! Tables of procedures. The generated code has one of each procedure of a node.
//!
//! Times are milliseconds, sizes bytes. After a step follows the next one, or the one at index `to`.

use crate::wire::link::{ChecksumAlgorithm, NumberPlace, PerBus};

/// Number of registers.
pub(super) const MOST_REGISTERS: usize = 24;
/// Value of an optional input that is not given.
pub(super) const UNKNOWN: u32 = u32::MAX;

/// A procedure of a node.
#[derive(Clone, Copy, Debug)]
pub struct Form {
    /// Name in the ICD.
    pub name: &'static str,
    /// Inputs that are numbers. They have the registers after those of block and packet.
    pub inputs: &'static [Input],
    /// Largest number of bytes to send; 0 if the procedure sends none.
    pub most_bytes: usize,
    /// Numbers that the procedure reports: names and registers.
    pub outputs: &'static [(&'static str, u8)],
    /// Telemetry that [`Step::Collect`] adds to the entries: its id.
    pub entry: Option<u32>,
    /// Largest number of entries.
    pub most_entries: u32,
    /// Blocks of the bytes that are sent or received.
    pub blocks: Option<Blocks>,
    /// Longest duration.
    pub time_ms: u32,
    /// Largest number of requests.
    pub requests: u32,
    /// Number of retries of a request whose acknowledge is damaged.
    pub retries: u8,
    /// The steps. The procedure ends with success after the last one.
    pub steps: &'static [Step],
}

/// An input that is a number.
#[derive(Clone, Copy, Debug)]
pub struct Input {
    /// Name in the ICD.
    pub name: &'static str,
    /// Largest number.
    pub most: u32,
    /// The supported numbers; empty: all.
    pub values: &'static [u32],
    /// The allowed numbers in words.
    pub allowed: &'static str,
    /// Whether it may be left out.
    pub is_optional: bool,
}

/// A number that a step uses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Value {
    /// A constant.
    Constant(u32),
    /// The content of a register.
    Register(u8),
}

/// A field of a telecommand that gets a value.
#[derive(Clone, Copy, Debug)]
pub struct Put {
    /// Place of the field.
    pub place: NumberPlace,
    /// The value.
    pub value: Value,
}

/// A field of telemetry that is kept in a register.
#[derive(Clone, Copy, Debug)]
pub struct Take {
    /// Place of the field.
    pub place: NumberPlace,
    /// The register.
    pub register: u8,
}

/// Test of whether a register has a value.
#[derive(Clone, Copy, Debug)]
pub struct Test {
    /// The register.
    pub register: u8,
    /// The value.
    pub value: Value,
}

/// A step of a procedure.
#[derive(Clone, Copy, Debug)]
pub enum Step {
    /// Send a telecommand.
    Send {
        /// Its id.
        id: u32,
        /// Its data, before `puts`.
        data: &'static [u8],
        /// Fields that get values.
        puts: &'static [Put],
        /// Where the bytes of the packet stand.
        packet_at: Option<usize>,
        /// Whether it may be sent again after a time-out.
        repeats: bool,
        /// Whether a time-out counts as done.
        ignores_timeout: bool,
    },
    /// Request telemetry.
    Get {
        /// Its id.
        id: u32,
        /// Fields that are kept.
        takes: &'static [Take],
    },
    /// Request telemetry until all tests hold.
    Poll {
        /// Its id.
        id: u32,
        /// Fields that are kept.
        takes: &'static [Take],
        /// The tests.
        until: &'static [Test],
        /// The procedure fails if one of these holds.
        fails: &'static [Test],
        /// Time between two requests.
        interval_ms: u32,
        /// Longest time until the tests hold.
        timeout_ms: u32,
    },
    /// Begin the next block; without one, continue at `to`.
    NextBlock {
        /// Index of a step.
        to: usize,
    },
    /// Set the length of the block.
    SetLength(Value),
    /// Begin a round for the missing packets; without one, continue at `to`.
    NextRound {
        /// Index of a step.
        to: usize,
    },
    /// Select the next missing packet of the round; without one, continue at `to`.
    NextPacket {
        /// Index of a step.
        to: usize,
    },
    /// The selected packet is no longer missing.
    PacketDone,
    /// Send the map of received packets.
    SendMap,
    /// Request the map of received packets.
    GetMap,
    /// Receive packets until all are there, or none is new for some time.
    Receive {
        /// Id of the telemetry that contains a packet.
        id: u32,
        /// Place of the packet number.
        number: &'static NumberPlace,
        /// First byte of the content.
        data_at: usize,
        /// The time without a new packet.
        silence_ms: u32,
        /// Buses on which packets are requested one by one.
        requested_on: PerBus<bool>,
    },
    /// Compare a checksum with a value.
    VerifyChecksum {
        /// How it is computed.
        algorithm: &'static ChecksumAlgorithm,
        /// Whether it covers the block; otherwise it covers all bytes that are sent.
        of_block: bool,
        /// Whether it covers the fill of the last packet.
        covers_fill: bool,
        /// The value.
        value: Value,
        /// If it differs, transfer the block again; otherwise the procedure fails.
        again: bool,
    },
    /// Check that a test holds.
    Verify {
        /// The test.
        test: Test,
        /// If it does not hold, transfer the block again; otherwise the procedure fails.
        again: bool,
    },
    /// Add the telemetry to the entries unless it equals the last one.
    Collect,
    /// End with success if all bytes of the telemetry are 0.
    EndIfZeros,
    /// Continue at `to` unless a test holds.
    SkipUnless {
        /// The test.
        test: Test,
        /// Index of a step.
        to: usize,
    },
    /// Continue at `to`.
    Jump {
        /// Index of a step.
        to: usize,
    },
}

/// Blocks of the bytes that a procedure sends or receives, and their packets.
#[derive(Clone, Copy, Debug)]
pub struct Blocks {
    /// Whether the bytes are sent.
    pub sends: bool,
    /// Register with the number of received bytes; None: until a block is shorter than requested.
    pub total: Option<u8>,
    /// Largest number of bytes of a block.
    pub size: u32,
    /// Index of the first step of each block, where it begins again.
    pub begin: usize,
    /// Number of bytes of a packet.
    pub packet_bytes: usize,
    /// Number of the first packet of a block.
    pub first_packet: u32,
    /// Value of the bytes after the end of the block.
    pub fill: u8,
    /// Largest number of rounds of a block.
    pub rounds: u32,
    /// Largest number of bytes in all.
    pub most: u32,
    /// Map of the received packets.
    pub map: Option<PacketMap>,
}

/// Map of the received packets of a block, with one bit for each packet.
#[derive(Clone, Copy, Debug)]
pub struct PacketMap {
    /// The messages that contain the map: telecommand id and telemetry id of each.
    pub messages: &'static [(u32, u32)],
    /// Number of bytes of each message.
    pub length: usize,
    /// First byte of the map in each message.
    pub at: usize,
    /// Number of bytes of the map in each message.
    pub bytes: usize,
    /// Whether bit 0 is the most significant bit of a byte.
    pub msb0: bool,
    /// Bit of a received packet.
    pub received: bool,
    /// Bit of a packet beyond the end of the block.
    pub beyond_end: bool,
}
