//! A client over an I2C bus that has the trait of `embedded-hal`. Feature `embedded-hal`.

use super::{head, Client, NodeEvent};
use embedded_hal::i2c::I2c;

impl<T, const N: usize> Client<T, N> {
    /// I2C: process timeouts and perform the pending transactions. A read follows its write with a
    /// repeated start, or after a stop if the ICD requires it. A failed transaction is passed to
    /// the client, which tries again.
    ///
    /// # Errors
    ///
    /// Bus error of the last failed transaction.
    pub fn poll_i2c<B: I2c>(
        &mut self,
        now: u32,
        bus: &mut B,
        mut on_event: impl FnMut(NodeEvent<'_, T>),
    ) -> Result<(), B::Error> {
        self.tick(now, &mut on_event);
        let link = self.machine.link;
        let address = link.i2c_address.unwrap_or(0);
        let mut result = Ok(());
        let mut input = [0; N];
        while let Some(transaction) = self.output_transaction() {
            let size = transaction.read;
            let made = match input.get_mut(..size) {
                Some(read) if size > 0 && link.i2c_repeated_start => {
                    bus.write_read(address, transaction.write, read)
                }
                Some(read) if size > 0 => bus
                    .write(address, transaction.write)
                    .and_then(|()| bus.read(address, read)),
                _ => bus.write(address, transaction.write),
            };
            let bytes = made.is_ok().then(|| head(&input, size));
            self.transferred(now, bytes, &mut on_event);
            if made.is_err() {
                result = made;
            }
        }
        result
    }
}
