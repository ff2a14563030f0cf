//! I2C transactions whose results are missing.

use super::super::super::link::MOST_AWAITED;

/// A transaction that was taken.
#[derive(Clone, Copy, Debug)]
pub(in crate::wire::client) struct Transaction {
    pub(super) id: u8,
    /// Whether it reads telemetry of this id.
    pub(super) reads: bool,
}

/// The transactions, the oldest first.
#[derive(Clone, Debug)]
pub(in crate::wire::client) struct Taken([Option<Transaction>; MOST_AWAITED]);

impl Taken {
    pub(super) const NONE: Self = Self([None; MOST_AWAITED]);

    /// Add a transaction. Return None if too many results are missing.
    pub(in crate::wire::client) fn push(&mut self, transaction: Transaction) -> Option<()> {
        let free = self.0.iter_mut().find(|entry| entry.is_none())?;
        *free = Some(transaction);
        Some(())
    }

    /// Remove the oldest transaction.
    pub(in crate::wire::client) fn pop(&mut self) -> Option<Transaction> {
        let first = self.0.first_mut()?.take();
        self.0.rotate_left(1);
        first
    }

    pub(in crate::wire::client) fn is_single(&self) -> bool {
        self.0.iter().flatten().count() == 1
    }
}
