//! What a client must know of the type of a message.

/// A message that can be requested: telemetry, and configuration that is read back.
pub trait Telemetry: Sized {
    /// The node whose ICD has it.
    const NODE: &'static str;
    /// The id that requests it.
    const TELEMETRY_ID: u8;

    /// Decodes a frame.
    ///
    /// # Errors
    ///
    /// [`crate::Error::Length`] if it has another length.
    fn from_frame(bytes: &[u8]) -> Result<Self, crate::Error>;
}

/// A message that can be sent: a telecommand, and configuration that is set.
pub trait Telecommand {
    /// The node whose ICD has it.
    const NODE: &'static str;
    /// The id that sends it.
    const TELECOMMAND_ID: u8;

    /// Encodes the message to the beginning of `buffer` and says how many bytes it has.
    ///
    /// # Errors
    ///
    /// [`crate::Error::Length`] if the buffer is too short, [`crate::Error::Range`] if a value does not
    /// fit.
    fn write_frame(&self, buffer: &mut [u8]) -> Result<usize, crate::Error>;
}
