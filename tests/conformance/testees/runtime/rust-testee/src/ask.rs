//! Reading the keys of a request.

use crate::json::{unhex, Json};
use crate::subject::Refusal;

pub const BYTE: u32 = 255;

/// An integer in bounds; one that is missing has the default, if there is one.
pub fn number(
    request: &Json,
    key: &str,
    least: u32,
    most: u32,
    default: Option<u32>,
) -> Result<u32, Refusal> {
    let value = match request.get(key) {
        None => return default.ok_or(Refusal::Request),
        Some(Json::Integer(value)) => u32::try_from(*value).map_err(|_| Refusal::Request)?,
        Some(_) => return Err(Refusal::Request),
    };
    if (least..=most).contains(&value) {
        Ok(value)
    } else {
        Err(Refusal::Request)
    }
}

/// Any number of 32 bits.
pub fn any(request: &Json, key: &str) -> Result<u32, Refusal> {
    number(request, key, 0, u32::MAX, None)
}

/// A number of 8 bits.
pub fn byte(request: &Json, key: &str) -> Result<u8, Refusal> {
    let value = number(request, key, 0, BYTE, None)?;
    u8::try_from(value).map_err(|_| Refusal::Request)
}

pub fn text<'a>(request: &'a Json, key: &str) -> Result<&'a str, Refusal> {
    match request.get(key) {
        Some(Json::Text(text)) => Ok(text),
        _ => Err(Refusal::Request),
    }
}

pub fn bytes_of(value: &Json) -> Result<Vec<u8>, Refusal> {
    match value {
        Json::Text(text) => unhex(text).ok_or(Refusal::Request),
        _ => Err(Refusal::Request),
    }
}

pub fn octets(request: &Json, key: &str) -> Result<Vec<u8>, Refusal> {
    bytes_of(request.get(key).ok_or(Refusal::Request)?)
}

/// A truth value, false if it is missing.
pub fn flag(request: &Json, key: &str) -> Result<bool, Refusal> {
    match request.get(key) {
        None => Ok(false),
        Some(Json::Bool(value)) => Ok(*value),
        Some(_) => Err(Refusal::Request),
    }
}

pub fn rows<'a>(request: &'a Json, key: &str) -> Result<&'a [Json], Refusal> {
    match request.get(key) {
        Some(Json::List(rows)) => Ok(rows),
        _ => Err(Refusal::Request),
    }
}

/// A list of objects.
pub fn mappings<'a>(request: &'a Json, key: &str) -> Result<&'a [Json], Refusal> {
    let rows = rows(request, key)?;
    if rows.iter().all(|row| matches!(row, Json::Map(_))) {
        Ok(rows)
    } else {
        Err(Refusal::Request)
    }
}

/// A list of hex strings.
pub fn hex_rows(request: &Json, key: &str) -> Result<Vec<Vec<u8>>, Refusal> {
    rows(request, key)?.iter().map(bytes_of).collect()
}
