//! Errors of the wire layer.

use core::fmt;

/// Error of a function of the wire layer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Error {
    /// The ICD does not describe this part of the protocol.
    Unsupported,
    /// The node has no message with this id.
    UnknownId {
        /// The id.
        id: u32,
    },
    /// Another request is in progress, or its output has not been taken completely.
    Busy,
    /// Length mismatch: data of the wrong length, or a buffer that is too small.
    Length {
        /// Expected number of bytes.
        expected: usize,
        /// Actual number of bytes.
        actual: usize,
    },
    /// The data do not fit into the packets of a message.
    TooLong {
        /// Largest number of bytes.
        most: usize,
        /// Actual number of bytes.
        actual: usize,
    },
    /// Wrong checksum.
    Checksum {
        /// Checksum computed from the data.
        expected: u32,
        /// Received checksum.
        actual: u32,
    },
    /// Value out of range of its field, or invalid.
    Range {
        /// Name of the field.
        field: &'static str,
        /// Allowed values in words; may be empty.
        allowed: &'static str,
    },
}

impl Error {
    /// Value out of range of a field that does not belong to a message.
    pub(crate) const fn range(field: &'static str) -> Self {
        let allowed = "";
        Self::Range { field, allowed }
    }
}

impl From<crate::Error> for Error {
    fn from(error: crate::Error) -> Self {
        match error {
            crate::Error::Length { expected, actual } => Self::Length { expected, actual },
            crate::Error::Range { field, allowed } => Self::Range { field, allowed },
            crate::Error::UnknownId { id } => Self::UnknownId { id },
        }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unsupported => out.write_str("the ICD does not describe this"),
            Self::UnknownId { id } => write!(out, "there is no message of id {id}"),
            Self::Busy => out.write_str("a request is going on"),
            Self::Length { expected, actual } => {
                write!(out, "{expected} bytes expected, {actual} given")
            }
            Self::TooLong { most, actual } => write!(out, "{actual} bytes, at most {most} fit"),
            Self::Checksum { expected, actual } => {
                write!(
                    out,
                    "the checksum is {actual:#x}, of the data {expected:#x}"
                )
            }
            Self::Range { field, allowed: "" } => write!(out, "the value does not fit `{field}`"),
            Self::Range { field, allowed } => write!(out, "`{field}` takes {allowed}"),
        }
    }
}

#[cfg(feature = "core_error")]
impl core::error::Error for Error {}

#[cfg(all(feature = "std", not(feature = "core_error")))]
impl std::error::Error for Error {}
