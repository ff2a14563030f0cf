//! File transfer.

use super::{PerBus, Span, Step};

/// File transfer.
#[derive(Clone, Copy, Debug)]
pub struct Files {
    /// Bytes of the file in a packet.
    pub packet_bytes: usize,
    /// Bytes of the packet counter before them.
    pub counter_bytes: usize,
    /// Number of the first packet of a block.
    pub first_packet: u32,
    /// Value of the bytes of the last packet beyond the end of the file.
    pub fill: u8,
    /// Maximum number of packets of a block.
    pub block_packets: usize,
    /// Maximum number of bytes of a block.
    pub block_bytes: usize,
    /// Id of a download packet on each bus.
    pub packet_ids: PerBus<Option<u8>>,
    /// Hole map: one bit for each packet of a block.
    pub hole_map: Option<HoleMapForm>,
    /// Listing of files.
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

/// Hole map: one bit for each packet of a block.
#[derive(Clone, Copy, Debug)]
pub struct HoleMapForm {
    /// Length of the map.
    pub bytes: usize,
    /// Bytes of the map in each message.
    pub message_bytes: usize,
    /// Whether bit 0 is the most significant bit of a byte.
    pub msb0: bool,
    /// Value of the bit of a received packet.
    pub received: bool,
    /// Value of the bits of packets beyond the end of the block.
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

/// Listing of files.
#[derive(Clone, Copy, Debug)]
pub struct ListForm {
    /// Returns to the first file.
    pub reset: Step,
    /// Advances to the next file.
    pub advance: Step,
    /// Describes a file.
    pub information: Step,
    /// Time between two polls of the busy flag.
    pub poll_interval_ms: u32,
    /// Longest time that the busy flag is set.
    pub timeout_ms: u32,
    /// Maximum number of files in the list.
    pub max_entries: u32,
}

/// Download.
#[derive(Clone, Copy, Debug)]
pub struct DownloadForm {
    /// Loads a block.
    pub load: Step,
    /// Reports that the block is loaded.
    pub ready: Step,
    /// Starts the transfer of the block.
    pub burst: Step,
    /// Value of the length in the burst telecommand.
    pub message_length: u32,
    /// Whether the checksum of a block covers the padding of its last packet.
    pub checksum_covers_fill: bool,
    /// Counter of the index file, in addition to its type.
    pub index_counter: u8,
    /// Time between two polls of the ready flag.
    pub poll_interval_ms: u32,
    /// Longest time to load a block.
    pub ready_timeout_ms: u32,
    /// Time without a new packet after which a burst has ended.
    pub silence_ms: u32,
    /// Maximum number of bursts for one block.
    pub rounds: u32,
    /// Maximum number of bytes of a file.
    pub max_bytes: u32,
}

/// Upload.
#[derive(Clone, Copy, Debug)]
pub struct UploadForm {
    /// Erases the destination.
    pub initiate: Step,
    /// Reports that the destination is erased.
    pub initiated: Step,
    /// Begins a block.
    pub begin: Step,
    /// Contains a packet.
    pub packet: Step,
    /// Reports the checksum of the received block.
    pub checksum: Step,
    /// Commits a block.
    pub finalize: Step,
    /// Reports that the block is committed.
    pub finalized: Step,
    /// Value of the block size in `initiate`.
    pub block_size: u32,
    /// Whether the checksum of a block covers the padding of its last packet.
    pub checksum_covers_fill: bool,
    /// Time between two polls of a busy flag.
    pub poll_interval_ms: u32,
    /// Longest time to erase the destination.
    pub erase_timeout_ms: u32,
    /// Longest time to commit a block.
    pub finalize_timeout_ms: u32,
    /// Maximum number of rounds of packets for one block.
    pub rounds: u32,
    /// Size of a destination in bytes, the maximum size of a file.
    pub destination_bytes: Option<usize>,
    /// Supported destinations; empty if all are supported.
    pub destinations: &'static [u8],
}

/// An operation on a stored program: a telecommand starts it, and a frame reports its end.
#[derive(Clone, Copy, Debug)]
pub struct OperationForm {
    /// Starts the operation.
    pub request: Step,
    /// Reports that it has ended.
    pub progress: Step,
    /// Time between two polls of that frame.
    pub poll_interval_ms: u32,
    /// Longest duration.
    pub timeout_ms: u32,
    /// Supported programs; empty if all are supported.
    pub programs: &'static [u8],
}

/// Erasing, of files or of the whole medium.
#[derive(Clone, Copy, Debug)]
pub struct ErasureForm {
    /// Starts the procedure.
    pub request: Step,
    /// Reports that it has ended.
    pub progress: Step,
    /// Time between two polls of the busy flag.
    pub poll_interval_ms: u32,
    /// Longest duration.
    pub timeout_ms: u32,
}
