//! File transfer.

use super::{PerBus, Span, Step};

/// File transfer.
#[derive(Clone, Copy, Debug)]
pub struct Files {
    /// Bytes of the file in a packet.
    pub packet_bytes: usize,
    /// Bytes of a packet's number.
    pub counter_bytes: usize,
    /// Number of the first packet.
    pub first_packet: u32,
    /// What fills the last packet.
    pub fill: u8,
    /// Most packets of a block.
    pub block_packets: usize,
    /// Most bytes of a block.
    pub block_bytes: usize,
    /// What heads a download packet on each bus.
    pub packet_ids: PerBus<Option<u8>>,
    /// A bit for each packet of a block.
    pub hole_map: Option<HoleMapForm>,
    /// The list of files.
    pub list: Option<ListForm>,
    /// Download.
    pub download: Option<DownloadForm>,
    /// Upload.
    pub upload: Option<UploadForm>,
    /// Erasing.
    pub erase: Option<ErasureForm>,
    /// Formatting.
    pub format: Option<ErasureForm>,
}

/// A bit for each packet of a block.
#[derive(Clone, Copy, Debug)]
pub struct HoleMapForm {
    /// Bytes of the map.
    pub bytes: usize,
    /// Bytes of the map in a message.
    pub message_bytes: usize,
    /// Whether bit 0 is the most significant one of a byte.
    pub msb0: bool,
    /// What the bit of a packet is that was received.
    pub received: bool,
    /// What the bits beyond the end of a block are.
    pub beyond_end: bool,
    /// The messages that carry it.
    pub messages: &'static [MapMessage],
}

/// A message that carries a piece of the hole map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MapMessage {
    /// The id that sets it.
    pub set_id: u8,
    /// The id that gets it.
    pub get_id: u8,
    /// Bytes of the message.
    pub length: usize,
    /// Where the piece stands.
    pub piece: Span,
}

/// The list of files.
#[derive(Clone, Copy, Debug)]
pub struct ListForm {
    /// To the first file.
    pub reset: Step,
    /// To the next file.
    pub advance: Step,
    /// What the file is.
    pub information: Step,
    /// How long to wait between two polls.
    pub poll_interval_ms: u32,
    /// How long to poll.
    pub timeout_ms: u32,
}

/// Download.
#[derive(Clone, Copy, Debug)]
pub struct DownloadForm {
    /// Loads a block.
    pub load: Step,
    /// Tells that it is loaded.
    pub ready: Step,
    /// Sends its packets.
    pub burst: Step,
    /// What `burst` is given.
    pub message_length: u32,
    /// Whether the checksum covers what fills the last packet.
    pub checksum_covers_fill: bool,
    /// The counter of the index file.
    pub index_counter: u8,
    /// How long to wait between two polls.
    pub poll_interval_ms: u32,
    /// How long a block may take to be loaded.
    pub ready_timeout_ms: u32,
    /// After so long without a packet a burst is over.
    pub silence_ms: u32,
    /// Most rounds for a block.
    pub rounds: u32,
}

/// Upload.
#[derive(Clone, Copy, Debug)]
pub struct UploadForm {
    /// Erases the destination.
    pub initiate: Step,
    /// Tells that it is erased.
    pub initiated: Step,
    /// Begins a block.
    pub begin: Step,
    /// A packet.
    pub packet: Step,
    /// Tells the checksum of the block.
    pub checksum: Step,
    /// Commits the block.
    pub finalize: Step,
    /// Tells that it is committed.
    pub finalized: Step,
    /// What `initiate` is given.
    pub block_size: u32,
    /// Whether the checksum covers what fills the last packet.
    pub checksum_covers_fill: bool,
    /// How long to wait between two polls.
    pub poll_interval_ms: u32,
    /// How long erasing may take.
    pub erase_timeout_ms: u32,
    /// How long committing may take.
    pub finalize_timeout_ms: u32,
    /// Most rounds for a block.
    pub rounds: u32,
    /// Bytes that a destination holds, if the ICD says so.
    pub destination_bytes: Option<usize>,
    /// The destinations that are supported; none: all.
    pub destinations: &'static [u8],
}

/// What a telecommand starts for a stored program, and a frame tells the end of.
#[derive(Clone, Copy, Debug)]
pub struct OperationForm {
    /// Begins it.
    pub request: Step,
    /// Tells that it is over.
    pub progress: Step,
    /// How long to wait between two polls.
    pub poll_interval_ms: u32,
    /// How long it may take.
    pub timeout_ms: u32,
    /// The programs that it may be asked for; none: all.
    pub programs: &'static [u8],
}

/// Erasing, of files or of the whole medium.
#[derive(Clone, Copy, Debug)]
pub struct ErasureForm {
    /// Begins it.
    pub request: Step,
    /// Tells that it is over.
    pub progress: Step,
    /// How long to wait between two polls.
    pub poll_interval_ms: u32,
    /// How long it may take.
    pub timeout_ms: u32,
}
