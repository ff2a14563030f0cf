//! Checksum of messages with header and trailer.

use crate::wire::link::{CheckForm, CheckKind, PacketForm, StreamRow};
use crate::wire::Crc;

/// A checksum that is fed piece by piece.
struct Check<'a> {
    form: &'a CheckForm,
    crc: Crc<'a>,
    first: u32,
    second: u32,
}

impl<'a> Check<'a> {
    fn new(form: &'a CheckForm) -> Self {
        let init = form.crc.init;
        let is_pair = matches!(form.kind, CheckKind::Fletcher | CheckKind::Fletcher255);
        Self {
            form,
            crc: Crc::with(&form.crc, form.table),
            first: if is_pair { init & 0xff } else { init },
            second: init >> 8,
        }
    }

    fn feed(&mut self, bytes: &[u8]) {
        let modulus = match self.form.kind {
            CheckKind::Crc => return self.crc.feed(bytes),
            CheckKind::Fletcher255 => 255,
            _ => 256,
        };
        for byte in bytes.iter().map(|byte| u32::from(*byte)) {
            match self.form.kind {
                CheckKind::Sum => self.first = self.first.wrapping_add(byte),
                CheckKind::Xor => self.first ^= byte,
                _ => {
                    self.first = self.first.wrapping_add(byte) % modulus;
                    self.second = self.second.wrapping_add(self.first) % modulus;
                }
            }
        }
    }

    fn result(&self) -> u32 {
        let crc = &self.form.crc;
        match self.form.kind {
            CheckKind::Crc => self.crc.result(),
            CheckKind::Sum | CheckKind::Xor => {
                (self.first & u32::MAX.wrapping_shr(crc.unused_bits())) ^ crc.xor_out
            }
            _ => ((self.second << 8) | self.first) ^ crc.xor_out,
        }
    }
}

/// The checksum of a message in three pieces.
pub(super) fn whole(
    packet: &PacketForm,
    form: &CheckForm,
    row: Option<&StreamRow>,
    pieces: [&[u8]; 3],
) -> u32 {
    let [header, data, trailer] = pieces;
    let header = header.get(..packet.header_bytes).unwrap_or(header);
    let mut check = Check::new(form);
    check.feed(header.get(form.covered_from..).unwrap_or(&[]));
    check.feed(data);
    check.feed(trailer.get(..form.covered_trailer).unwrap_or(&[]));
    if let (true, Some(row)) = (form.is_seeded, row) {
        check.feed(&[row.seed]);
    }
    check.result()
}
