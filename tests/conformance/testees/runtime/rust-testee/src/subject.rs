//! What the protocol needs to know of a message and of its values.

use crate::json::{hex, unhex, Json};
use icd::{Coded, Enumeration, Error};

/// Why a request cannot be answered.
pub enum Refusal {
    Request,
    UnknownNode,
    UnknownId,
    UnknownEnum,
    UnknownField(String),
    MissingField(&'static str),
    /// The field, and what the crate says.
    Range(&'static str),
    Crate(Error),
    /// The answer's `error` and its further keys, finished.
    Answer(String),
    /// The node's sum type decodes the frame otherwise than the message does.
    Dispatcher,
}

impl From<Error> for Refusal {
    fn from(error: Error) -> Self {
        Self::Crate(error)
    }
}

/// What a value says of the member of an enumeration that it is.
pub enum Member {
    NotAnEnumeration,
    Unnamed,
    Named(&'static str),
}

/// A raw value.
pub trait Value {
    /// As JSON.
    fn show(&self) -> String;
    /// Takes the value of a request; None if it is of the wrong type, Some(false) if it does not fit.
    fn take(&mut self, given: &Json) -> Option<bool>;
    /// The member, for an enumeration.
    fn member(&self) -> Member {
        Member::NotAnEnumeration
    }
}

macro_rules! integer {
    ($($type:ty)*) => {$(
        impl Value for $type {
            fn show(&self) -> String {
                self.to_string()
            }

            fn take(&mut self, given: &Json) -> Option<bool> {
                match given {
                    Json::Integer(value) => Some(match <$type>::try_from(*value) {
                        Ok(value) => {
                            *self = value;
                            true
                        }
                        Err(_) => false,
                    }),
                    Json::Huge => Some(false),
                    _ => None,
                }
            }
        }
    )*};
}

integer!(u8 u16 u32 u64 i8 i16 i32 i64);

macro_rules! float {
    ($($type:ty, $bits:ty;)*) => {$(
        impl Value for $type {
            fn show(&self) -> String {
                format!("\"{}\"", hex(&self.to_bits().to_be_bytes()))
            }

            fn take(&mut self, given: &Json) -> Option<bool> {
                let bytes = match given {
                    Json::Text(text) => unhex(text)?,
                    _ => return None,
                };
                let bits = <$bits>::from_be_bytes(bytes.try_into().ok()?);
                *self = <$type>::from_bits(bits);
                Some(true)
            }
        }
    )*};
}

float!(f32, u32; f64, u64;);

impl Value for bool {
    fn show(&self) -> String {
        self.to_string()
    }

    fn take(&mut self, given: &Json) -> Option<bool> {
        *self = match given {
            Json::Bool(value) => *value,
            Json::Integer(0) => false,
            Json::Integer(1) => true,
            Json::Integer(_) | Json::Huge => return Some(false),
            _ => return None,
        };
        Some(true)
    }
}

impl<const N: usize> Value for [u8; N] {
    fn show(&self) -> String {
        format!("\"{}\"", hex(self))
    }

    fn take(&mut self, given: &Json) -> Option<bool> {
        let bytes = match given {
            Json::Text(text) => unhex(text)?,
            _ => return None,
        };
        Some(match bytes.try_into() {
            Ok(bytes) => {
                *self = bytes;
                true
            }
            Err(_) => false,
        })
    }
}

impl<E> Value for Coded<E>
where
    E: Enumeration,
    E::Raw: Value,
{
    fn show(&self) -> String {
        self.raw().show()
    }

    fn take(&mut self, given: &Json) -> Option<bool> {
        let mut raw = self.raw();
        let taken = raw.take(given);
        *self = Self::from_raw(raw);
        taken
    }

    fn member(&self) -> Member {
        self.name().map_or(Member::Unnamed, Member::Named)
    }
}

/// A field of a message.
pub struct Field<M: 'static> {
    pub name: &'static str,
    pub value: fn(&mut M) -> &mut dyn Value,
    pub scale: Option<Scale<M>>,
    pub special: fn() -> Vec<i128>,
    pub limits: fn() -> Vec<(&'static str, f64)>,
}

/// Getter and setter of a physical value.
pub struct Scale<M> {
    pub get: fn(&M) -> f64,
    pub set: fn(&mut M, f64) -> Result<(), Error>,
}

/// A message.
pub trait Subject: Copy + Default + 'static {
    const TITLE: &'static str;
    const BYTES: usize;
    const FIELDS: &'static [Field<Self>];
    fn ids() -> Vec<u32>;
    fn decode(bytes: &[u8]) -> Result<Self, Error>;
    fn encode(&self) -> Result<Vec<u8>, Error>;
}
