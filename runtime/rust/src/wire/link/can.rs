//! CAN.

/// CAN: parts of the identifier, and types by kind of message.
#[derive(Clone, Copy, Debug)]
pub struct Can {
    /// Address of the node.
    pub node_address: u8,
    /// Maximum number of data bytes of one packet; CAN 2.0 allows 8.
    pub data_bytes: usize,
    /// Where the message type stands.
    pub kind: CanPart,
    /// Where the id of the message stands.
    pub id: CanPart,
    /// Where the sender's address stands.
    pub source: CanPart,
    /// Where the receiver's address stands.
    pub destination: CanPart,
    /// Message types of single packets.
    pub types: CanTypes,
    /// Messages of several packets.
    pub extended: Option<Extended>,
}

/// A part of the CAN identifier.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CanPart {
    /// How many bits it has.
    pub bits: u32,
    /// How many bits stand below it.
    pub shift: u32,
}

/// Message types by kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CanTypes {
    /// A telecommand.
    pub telecommand: Option<u32>,
    /// Its acknowledge.
    pub acknowledge: Option<u32>,
    /// It is refused.
    pub refusal: Option<u32>,
    /// A request of telemetry.
    pub request: Option<u32>,
    /// The telemetry frame; empty for a telecommand.
    pub reply: Option<u32>,
    /// The request is refused.
    pub request_refusal: Option<u32>,
}

/// CAN messages of several packets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Extended {
    /// Data bytes of a packet.
    pub data_bytes: usize,
    /// Index of the byte with the number of packets that follow.
    pub left_at: usize,
    /// Value of that byte in the last packet.
    pub left_in_last: u8,
    /// Maximum number of packets of a message.
    pub packets: u32,
    /// Maximum number of bytes of a message.
    pub bytes: usize,
    /// Value of unused bytes of the last packet.
    pub fill: u8,
    /// Longest time between two packets of a message.
    pub packet_timeout_ms: u32,
    /// The message types.
    pub types: CanTypes,
}
