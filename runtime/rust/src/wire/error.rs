//! Why something of the wire layer cannot be done.

use core::fmt;

/// Why something cannot be sent, read or begun.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Error {
    /// The ICD does not describe this part of the protocol.
    Unsupported,
    /// The node has no message of that id.
    UnknownId {
        /// The id.
        id: u32,
    },
    /// Another request is going on, or its output has not been taken.
    Busy,
    /// There are more or fewer bytes than there must be, or a buffer is too small.
    Length {
        /// Bytes that there must be.
        expected: usize,
        /// Bytes that there are.
        actual: usize,
    },
    /// The data do not fit the packets of a message.
    TooLong {
        /// Bytes that fit.
        most: usize,
        /// Bytes that were given.
        actual: usize,
    },
    /// The checksum is wrong.
    Checksum {
        /// That of the data.
        expected: u32,
        /// The one that came.
        actual: u32,
    },
    /// A value does not fit its place, or does not exist.
    Range {
        /// What it is a value of.
        field: &'static str,
        /// What it takes, in words; empty where the field of a message does not say it.
        allowed: &'static str,
    },
}

impl Error {
    /// A value does not fit its place, which is none of a message.
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
