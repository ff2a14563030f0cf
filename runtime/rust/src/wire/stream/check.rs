//! Checksum of messages with header and trailer.

use crate::wire::checksum::Check;
use crate::wire::link::{CheckForm, PacketForm, StreamRow};

/// The checksum of a message in three pieces.
pub(super) fn whole(
    packet: &PacketForm,
    form: &CheckForm,
    row: Option<&StreamRow>,
    pieces: [&[u8]; 3],
) -> u32 {
    let [header, data, trailer] = pieces;
    let header = header.get(..packet.header_bytes).unwrap_or(header);
    let mut check = Check::new(&form.algorithm, form.table);
    check.feed(header.get(form.covered_from..).unwrap_or(&[]));
    check.feed(data);
    check.feed(trailer.get(..form.covered_trailer).unwrap_or(&[]));
    if let (true, Some(row)) = (form.is_seeded, row) {
        check.feed(&[row.seed]);
    }
    check.result()
}
