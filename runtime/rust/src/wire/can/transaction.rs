//! A message of several packets, as far as it has come.

use super::super::bits::{copy, part, part_mut};
use super::super::link::Extended;

/// Most packets of a message: a byte counts them.
const PACKETS: usize = 256;

/// What tells one message from another: type, id, source, destination.
pub(super) type Key = (u32, u32, u32, u32);

/// A message of several packets.
#[derive(Clone, Debug)]
pub(super) struct Transaction<const N: usize> {
    pub(super) key: Key,
    pub(super) count: usize,          // of all packets
    pub(super) length: Option<usize>, // of the data, where the ICD knows it
    pub(super) last: u32,             // when the last packet came
    pub(super) run: usize,            // packets 0 to run - 1 came last, one after the other
    pub(super) done: Option<usize>,   // the packet that completed it
    pub(super) began: u32,            // the lower, the older
    there: [bool; PACKETS],
    data: [u8; N],
}

impl<const N: usize> Transaction<N> {
    pub(super) const fn new(key: Key) -> Self {
        Self {
            key,
            count: 0,
            length: None,
            last: 0,
            run: 0,
            done: None,
            began: 0,
            there: [false; PACKETS],
            data: [0; N],
        }
    }

    /// Whether the buffer has room for so many packets.
    pub(super) fn fits(count: usize, form: &Extended) -> bool {
        count <= PACKETS && count.saturating_mul(form.data_bytes) <= N
    }

    pub(super) fn has(&self, number: usize) -> bool {
        self.there.get(number).copied().unwrap_or(false)
    }

    pub(super) fn missing(&self) -> usize {
        self.there
            .iter()
            .take(self.count)
            .filter(|there| !**there)
            .count()
    }

    pub(super) fn piece(&self, number: usize, form: &Extended) -> &[u8] {
        part(
            &self.data,
            number.wrapping_mul(form.data_bytes),
            form.data_bytes,
        )
    }

    pub(super) fn put(&mut self, number: usize, piece: &[u8], form: &Extended) {
        let at = number.wrapping_mul(form.data_bytes);
        copy(part_mut(&mut self.data, at, form.data_bytes), piece);
        if let Some(there) = self.there.get_mut(number) {
            *there = true;
        }
    }

    /// Forgets all packets but the first ones.
    pub(super) fn keep(&mut self, first: usize) {
        for there in self.there.iter_mut().skip(first) {
            *there = false;
        }
    }

    /// Notes that a packet came, be it a repeated one.
    pub(super) fn came(&mut self, number: usize, now: u32) {
        self.last = now;
        if number == self.run {
            self.run += 1;
        } else if number + 1 != self.run {
            self.run = usize::from(number == 0);
        }
    }

    /// The data, when all packets are there.
    pub(super) fn joined(&self, form: &Extended) -> &[u8] {
        let whole = self.count.wrapping_mul(form.data_bytes);
        part(
            &self.data,
            0,
            self.length.map_or(whole, |length| length.min(whole)),
        )
    }
}
