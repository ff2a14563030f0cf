//! Logs, times and the index file.

/// The mask of a log. Frames stand in slots of one size, in the order of rising bits.
#[derive(Clone, Copy, Debug)]
pub struct LogMask {
    /// Length of the mask.
    pub size: usize,
    /// Whether bit 0 is the most significant bit of a byte.
    pub msb0: bool,
    /// Length of each frame in a log.
    pub slot_bytes: usize,
    /// Value of the bytes after a short frame.
    pub fill: u8,
    /// The bits that have a frame, rising.
    pub bits: &'static [LogBit],
}

/// A bit of the log mask and the frame that it selects.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LogBit {
    /// The bit.
    pub bit: u16,
    /// The telemetry id.
    pub id: u8,
    /// Bytes of the frame, at most those of a slot.
    pub length: usize,
    /// What the ICD calls the frame.
    pub name: &'static str,
}

/// The file form of a log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LogFile {
    /// Offset of the mask in the header.
    pub mask_at: usize,
    /// Length of the header.
    pub header_bytes: usize,
    /// Offset and length of the Unix time in an entry.
    pub seconds: Span,
    /// Offset and length of the milliseconds in an entry.
    pub milliseconds: Span,
    /// Offset of the selected frames in an entry.
    pub frames_at: usize,
    /// Type of a log file.
    pub file_type: Option<u8>,
}

/// The unsolicited form of a log. Places count from the id.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LogMessage {
    /// Id of the message.
    pub id: u8,
    /// Offset of the mask.
    pub mask_at: usize,
    /// Offset of the selected frames.
    pub frames_at: usize,
}

/// Some bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Span {
    /// The first.
    pub at: usize,
    /// How many.
    pub bytes: usize,
}

/// Date and time packed into bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TimeForm {
    /// The year.
    pub year: TimePart,
    /// The month.
    pub month: TimePart,
    /// The day of the month.
    pub day: TimePart,
    /// The hour.
    pub hour: TimePart,
    /// The minute.
    pub minute: TimePart,
    /// The second.
    pub second: TimePart,
}

/// A part of a packed time: its bits, times the factor, plus the offset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TimePart {
    /// How many bits stand below it.
    pub at: u32,
    /// How many bits it has.
    pub bits: u32,
    /// Its resolution.
    pub factor: u32,
    /// What 0 stands for.
    pub offset: u32,
}

/// Entries of the index file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct IndexForm {
    /// Length of an entry.
    pub entry_bytes: usize,
    /// Type of the index file.
    pub file_type: Option<u8>,
    /// Type of the file.
    pub kind: Span,
    /// Counter of the file.
    pub counter: Span,
    /// Checksum of the file.
    pub checksum: Span,
    /// Size of the file.
    pub size: Span,
    /// When it was created, packed.
    pub time: Span,
    /// Meta-data.
    pub meta: Span,
}
