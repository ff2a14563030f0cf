//! Checksums of all kinds.

use super::link::{CheckKind, ChecksumAlgorithm, Link};
use super::{Crc, Error, Table};

/// A checksum that is fed piece by piece.
pub(crate) struct Check<'a> {
    algorithm: &'a ChecksumAlgorithm,
    crc: Crc<'a>,
    first: u32,
    second: u32,
}

impl<'a> Check<'a> {
    /// `table`: lookup table of a CRC.
    pub(crate) fn new(algorithm: &'a ChecksumAlgorithm, table: Option<&'a Table>) -> Self {
        let init = algorithm.crc.init;
        let is_pair = matches!(algorithm.kind, CheckKind::Fletcher | CheckKind::Fletcher255);
        Self {
            algorithm,
            crc: Crc::with(&algorithm.crc, table),
            first: if is_pair { init & 0xff } else { init },
            second: init >> 8,
        }
    }

    pub(crate) fn feed(&mut self, bytes: &[u8]) {
        let modulus = match self.algorithm.kind {
            CheckKind::Crc => return self.crc.feed(bytes),
            CheckKind::Fletcher255 => 255,
            _ => 256,
        };
        for byte in bytes.iter().map(|byte| u32::from(*byte)) {
            match self.algorithm.kind {
                CheckKind::Sum => self.first = self.first.wrapping_add(byte),
                CheckKind::Xor => self.first ^= byte,
                _ => {
                    self.first = self.first.wrapping_add(byte) % modulus;
                    self.second = self.second.wrapping_add(self.first) % modulus;
                }
            }
        }
    }

    pub(crate) fn result(&self) -> u32 {
        let crc = &self.algorithm.crc;
        match self.algorithm.kind {
            CheckKind::Crc => self.crc.result(),
            CheckKind::Sum | CheckKind::Xor => {
                (self.first & u32::MAX.wrapping_shr(crc.unused_bits())) ^ crc.xor_out
            }
            _ => ((self.second << 8) | self.first) ^ crc.xor_out,
        }
    }
}

/// Compute the checksum with this name in the ICD.
///
/// `bytes` end with the seed of the message if the checksum has `seeds`.
///
/// # Errors
///
/// [`Error::Unsupported`] if the ICD has no such checksum.
pub fn checksum(link: &Link, name: &str, bytes: &[u8]) -> Result<u32, Error> {
    let found = link.checksums.iter().find(|(known, _)| *known == name);
    let (_, algorithm) = found.ok_or(Error::Unsupported)?;
    let mut check = Check::new(algorithm, None);
    check.feed(bytes);
    Ok(check.result())
}
