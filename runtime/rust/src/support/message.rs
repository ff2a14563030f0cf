//! Common traits of all messages, for generic code.

use super::{Error, Field};
use core::fmt::{Debug, Display};

/// A message of an ICD.
///
/// ```
/// use icdgen_runtime::{Error, Message};
///
/// /// Decodes consecutive frames of one message.
/// fn all<M: Message>(bytes: &[u8]) -> Result<Vec<M>, Error> {
///     bytes.chunks(M::LENGTH).map(M::from_bytes).collect()
/// }
/// ```
pub trait Message: Copy + Debug + Display + Sized {
    /// Name in the ICD.
    const NAME: &'static str;
    /// Length of a frame in bytes, without the id; of the longest frame, if frames differ in
    /// length.
    const LENGTH: usize;
    /// Fields in the order of the ICD.
    const FIELDS: &'static [Field];
    /// Type of an encoded frame.
    type Bytes: AsRef<[u8]> + Copy;

    /// Decode a frame of exactly [`Self::LENGTH`] bytes, unless frames differ in length.
    ///
    /// # Errors
    ///
    /// [`Error::Length`] if the frame has the wrong length.
    fn from_bytes(bytes: &[u8]) -> Result<Self, Error>;

    /// Encode the message; reserved bits are 0.
    ///
    /// # Errors
    ///
    /// [`Error::Range`] if a value does not fit into its field.
    fn to_bytes(&self) -> Result<Self::Bytes, Error>;
}

/// A message that can be requested: telemetry, and configuration that is read back.
///
/// ```
/// use icdgen_runtime::Telemetry;
///
/// fn told<M: Telemetry>(message: &M) -> String {
///     format!("{} {message}", M::TELEMETRY_ID)
/// }
/// ```
pub trait Telemetry: Message {
    /// Id of the telemetry. It always has 32 bits here; the constants of the type have the size of
    /// the ids of the node.
    const TELEMETRY_ID: u32;
}

/// A message that can be sent: a telecommand, and configuration that is set.
///
/// ```
/// use icdgen_runtime::{Error, Telecommand};
///
/// /// The id and the data.
/// fn sent<M: Telecommand>(command: &M) -> Result<(u32, Vec<u8>), Error> {
///     Ok((M::TELECOMMAND_ID, command.to_bytes()?.as_ref().to_vec()))
/// }
/// ```
pub trait Telecommand: Message {
    /// Id of the telecommand. It always has 32 bits here; the constants of the type have the size
    /// of the ids of the node.
    const TELECOMMAND_ID: u32;
}

/// What each message has beside its own: a row for each field, with the member that holds it.
macro_rules! message {
    ($type:ident { $($rows:tt)* }) => {
        $crate::support::message!($type as [u8; <$type>::LENGTH] { $($rows)* });
    };
    ($type:ident as $bytes:ty {
        $($member:ident $(as $elements:ident)?: ($($place:tt)*) $(.$what:ident($($how:tt)*))*,)*
    }) => {
        impl $crate::Message for $type {
            const NAME: &'static str = <$type>::NAME;
            const LENGTH: usize = <$type>::LENGTH;
            #[allow(clippy::large_stack_arrays)] // a constant is on no stack
            const FIELDS: &'static [$crate::Field] = &[$(
                $crate::Field::new($($place)*)$(.$what($($how)*))*
            ),*];
            type Bytes = $bytes;

            #[inline]
            fn from_bytes(bytes: &[u8]) -> ::core::result::Result<Self, $crate::Error> {
                <$type>::from_bytes(bytes)
            }

            #[inline]
            fn to_bytes(&self) -> ::core::result::Result<Self::Bytes, $crate::Error> {
                <$type>::to_bytes(self)
            }
        }

        impl ::core::convert::TryFrom<&[u8]> for $type {
            type Error = $crate::Error;

            #[inline]
            fn try_from(bytes: &[u8]) -> ::core::result::Result<Self, $crate::Error> {
                <$type>::from_bytes(bytes)
            }
        }

        /// Show the name and the values of the fields, physical values with their units.
        impl ::core::fmt::Display for $type {
            fn fmt(&self, out: &mut ::core::fmt::Formatter<'_>) -> ::core::fmt::Result {
                #[allow(unused_mut, unused_variables)]
                let mut row = $crate::support::Row::begin::<Self>(out)?;
                $(row.show(out, $crate::support::shown!(self, $member $(, $elements)?))?;)*
                Ok(())
            }
        }
    };
}
pub(crate) use message;

/// What each struct has beside its own.
macro_rules! structure {
    ($type:ident {
        $($member:ident: ($($place:tt)*) $(.$what:ident($($how:tt)*))*,)*
    }) => {
        impl $type {
            /// Its fields, in the order of the ICD; their places are those in the struct.
            #[allow(clippy::large_stack_arrays)] // a constant is on no stack
            pub const FIELDS: &'static [$crate::Field] = &[$(
                $crate::Field::new($($place)*)$(.$what($($how)*))*
            ),*];

            fn rows(
                &self,
                out: &mut ::core::fmt::Formatter<'_>,
                mark: &'static str,
            ) -> ::core::fmt::Result {
                let mut row = $crate::support::Row::of(Self::FIELDS, mark);
                $(row.show(out, &self.$member)?;)*
                Ok(())
            }
        }

        /// Show the name and the values of the fields, physical values with their units.
        impl ::core::fmt::Display for $type {
            fn fmt(&self, out: &mut ::core::fmt::Formatter<'_>) -> ::core::fmt::Result {
                out.write_str(Self::NAME)?;
                self.rows(out, ": ")
            }
        }

        impl $crate::support::Value for $type {
            fn show(
                &self,
                out: &mut ::core::fmt::Formatter<'_>,
                _: &$crate::Field,
            ) -> ::core::fmt::Result {
                self.rows(out, "{")?;
                out.write_str("}")
            }
        }
    };
}
pub(crate) use structure;

/// What is shown of a member: of the end of a message the elements that are there.
macro_rules! shown {
    ($message:ident, $member:ident) => {
        &$message.$member
    };
    ($message:ident, $member:ident, $elements:ident) => {
        $message.$elements()
    };
}
pub(crate) use shown;

/// What each enumeration has beside its values.
macro_rules! enumeration {
    ($type:ident: $raw:ident) => {
        impl $crate::Enumeration for $type {
            type Raw = $raw;

            fn name(self) -> ::core::option::Option<&'static str> {
                Self::name(self)
            }
        }

        impl ::core::convert::From<$type> for $raw {
            #[inline]
            fn from(value: $type) -> Self {
                value.raw()
            }
        }

        /// Show the name of the value in the ICD; its number if it has no name.
        impl ::core::fmt::Display for $type {
            fn fmt(&self, out: &mut ::core::fmt::Formatter<'_>) -> ::core::fmt::Result {
                match Self::name(*self) {
                    ::core::option::Option::Some(name) => out.write_str(name),
                    ::core::option::Option::None => write!(out, "{}", self.raw()),
                }
            }
        }
    };
}
pub(crate) use enumeration;
