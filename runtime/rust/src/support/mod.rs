//! Common part of all messages: errors, enumerations, access to bytes, scales.

#![allow(dead_code, unused_imports, unused_macros)] // not every interface needs all of it

use core::fmt;
use core::hash::Hash;

#[cfg(feature = "serde")]
pub(crate) mod array;
mod bytes;
mod curve;
mod derived;
mod field;
mod message;
#[cfg(feature = "serde")]
pub(crate) mod octets;
mod scale;
mod tail;
mod text;
mod wide;

pub(crate) use self::bytes::{
    array, arrays, each, element_of, flags, put, put_array, put_each, put_element, put_rounds,
    put_words, rounds, take, words, write_to,
};
pub(crate) use self::curve::Curve;
pub(crate) use self::derived::{power, quiet, whole};
pub use self::field::{is_special, Field};
pub(crate) use self::field::{Row, Value};
pub(crate) use self::message::{enumeration, message, shown, structure};
pub use self::message::{Message, Telecommand, Telemetry};
pub(crate) use self::scale::{there, Scale};
pub use self::tail::Frame;
pub(crate) use self::tail::{
    beginning, counted, elements, exact, first, longest, number, present, spread, spread_elements,
    told, valid, write_frame,
};
pub(crate) use self::text::{text, text_array};
pub(crate) use self::wide::{Big, Wide};

/// Error of decoding a frame, or of encoding a message or value.
///
/// ```
/// use icdgen_runtime::Error;
///
/// let error = Error::Range {
///     field: "Flow",
///     allowed: "0 to 6553.5 m/s",
/// };
/// assert_eq!(error.to_string(), "`Flow` takes 0 to 6553.5 m/s");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Error {
    /// Length mismatch: a frame of the wrong length, or a buffer that is too small.
    Length {
        /// Length of the message in bytes.
        expected: usize,
        /// Actual number of bytes.
        actual: usize,
    },
    /// Value out of range of its field, or not finite.
    Range {
        /// Name of the field in the ICD.
        field: &'static str,
        /// Allowed values in words.
        allowed: &'static str,
    },
    /// The ICD has no message with this id in this direction.
    UnknownId {
        /// The id.
        id: u32,
    },
}

impl Error {
    pub(crate) const fn range(field: &'static str, allowed: &'static str) -> Self {
        Self::Range { field, allowed }
    }

    /// Not inlined, so that decoders stay small.
    #[cold]
    #[inline(never)]
    pub(crate) fn length<T>(expected: usize, actual: usize) -> Result<T, Self> {
        Err(Self::Length { expected, actual })
    }
}

impl fmt::Display for Error {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Length { expected, actual } => {
                write!(out, "{expected} bytes expected, {actual} given")
            }
            Self::Range { field, allowed } => write!(out, "`{field}` takes {allowed}"),
            Self::UnknownId { id } => write!(out, "there is no message of id {id}"),
        }
    }
}

#[cfg(feature = "core_error")]
impl core::error::Error for Error {}

#[cfg(all(feature = "std", not(feature = "core_error")))]
impl std::error::Error for Error {}

/// An enumeration that can be converted from any number and back.
///
/// ```
/// use icdgen_runtime::Enumeration;
///
/// /// Returns whether the ICD has a name for a number.
/// fn is_known<E: Enumeration>(raw: E::Raw) -> bool {
///     E::from(raw).name().is_some()
/// }
/// ```
pub trait Enumeration:
    Copy + fmt::Debug + fmt::Display + From<Self::Raw> + Into<Self::Raw>
{
    /// Integer type of the raw values.
    type Raw: Copy + Default + Eq + Hash + fmt::Display;

    /// Return the name of the value in the ICD; None if it has no name.
    fn name(self) -> Option<&'static str>;
}

/// Raw value of an enumeration. Numbers without a name are kept unchanged.
///
/// ```
/// use icdgen_runtime::{Coded, Enumeration};
///
/// fn told<E: Enumeration>(mode: Coded<E>) -> String {
///     match mode.known() {
///         Some(known) => format!("{known}"),
///         None => format!("no mode that the ICD knows: {}", mode.raw()),
///     }
/// }
/// ```
#[derive(Clone, Copy, Default, PartialEq, Eq, Hash)]
pub struct Coded<E: Enumeration>(E::Raw);

impl<E: Enumeration> Coded<E> {
    /// Create from the raw value.
    #[inline]
    pub const fn from_raw(raw: E::Raw) -> Self {
        Self(raw)
    }

    /// Return the raw value.
    #[inline]
    pub const fn raw(self) -> E::Raw {
        self.0
    }

    /// Return the value as enumeration, for `match`.
    #[inline]
    #[must_use]
    pub fn get(self) -> E {
        E::from(self.0)
    }

    /// Return the name of the value in the ICD; None if it has no name.
    #[must_use]
    pub fn name(self) -> Option<&'static str> {
        self.get().name()
    }

    /// Return the value as enumeration; None if it has no name.
    #[must_use]
    pub fn known(self) -> Option<E> {
        self.name().map(|_| self.get())
    }
}

impl<E: Enumeration> From<E> for Coded<E> {
    #[inline]
    fn from(value: E) -> Self {
        Self(value.into())
    }
}

impl<E: Enumeration> PartialEq<E> for Coded<E> {
    #[inline]
    fn eq(&self, other: &E) -> bool {
        self.0 == (*other).into()
    }
}

impl<E: Enumeration> fmt::Display for Coded<E> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(&self.get(), out)
    }
}

impl<E: Enumeration> fmt::Debug for Coded<E> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(&self.get(), out)
    }
}

#[cfg(feature = "defmt")]
impl<E: Enumeration + defmt::Format> defmt::Format for Coded<E> {
    fn format(&self, out: defmt::Formatter) {
        self.get().format(out);
    }
}

#[cfg(feature = "serde")]
impl<E: Enumeration> serde::Serialize for Coded<E>
where
    E::Raw: serde::Serialize,
{
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.0.serialize(serializer)
    }
}

#[cfg(feature = "serde")]
impl<'de, E: Enumeration> serde::Deserialize<'de> for Coded<E>
where
    E::Raw: serde::Deserialize<'de>,
{
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        E::Raw::deserialize(deserializer).map(Self)
    }
}
