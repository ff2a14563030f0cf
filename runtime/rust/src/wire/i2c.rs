//! I2C: the bytes that the master writes and reads.

use super::bits::{copy, number, part, part_mut, put_number};
use super::checksum::Check;
use super::link::{Checksum, Link};
use super::Error;

pub use super::client::i2c::{Line, Transaction};

/// Encode a telecommand (id, data and, if `checked`, the checksum) and return the number of bytes.
/// I2C writes these bytes; the UART frames them.
///
/// # Errors
///
/// [`Error::Length`] if `out` is too small, [`Error::Unsupported`] if the ICD has no checksum.
///
/// ```
/// use icdgen_runtime::wire::{i2c, Error, Link};
///
/// fn written(link: &Link, id: u8, data: &[u8]) -> Result<Vec<u8>, Error> {
///     let mut out = [0; 64];
///     let size = i2c::write(link, id, data, true, &mut out)?;
///     Ok(out[..size].to_vec())
/// }
/// ```
pub fn write(
    link: &Link,
    id: u8,
    data: &[u8],
    checked: bool,
    out: &mut [u8],
) -> Result<usize, Error> {
    let form = form(link, checked)?;
    let size = form.map_or(0, |form| form.bytes);
    let expected = 1 + data.len() + size;
    let actual = out.len();
    if actual < expected {
        return Err(Error::Length { expected, actual });
    }
    copy(out, &[id]);
    copy(part_mut(out, 1, data.len()), data);
    if let Some(form) = form {
        let value = checksum(form, id, data);
        put_number(
            part_mut(out, 1 + data.len(), size),
            value.into(),
            link.little,
        );
    }
    Ok(expected)
}

/// Return the number of bytes to read for a frame.
///
/// # Errors
///
/// [`Error::UnknownId`] if there is no such frame, [`Error::Unsupported`] if the ICD has no checksum.
pub fn read_length(link: &Link, id: u8, checked: bool) -> Result<usize, Error> {
    let message = link
        .telemetry(id)
        .ok_or_else(|| Error::UnknownId { id: id.into() })?;
    Ok(message.length + form(link, checked)?.map_or(0, |form| form.bytes))
}

/// Check the bytes that were read and return the frame at their beginning.
///
/// # Errors
///
/// [`Error::UnknownId`] if there is no such frame, [`Error::Unsupported`] if the ICD has no checksum,
/// [`Error::Length`] or [`Error::Checksum`] if it is not intact.
pub fn reply<'a>(link: &Link, id: u8, bytes: &'a [u8], checked: bool) -> Result<&'a [u8], Error> {
    let expected = read_length(link, id, checked)?;
    let actual = bytes.len();
    if actual != expected {
        return Err(Error::Length { expected, actual });
    }
    let form = match form(link, checked)? {
        Some(form) => form,
        None => return Ok(bytes),
    };
    let length = expected.saturating_sub(form.bytes);
    let frame = part(bytes, 0, length);
    let actual = number(part(bytes, length, form.bytes), link.little);
    let expected = checksum(form, id, frame);
    if actual == u64::from(expected) {
        Ok(frame)
    } else {
        let actual = u32::try_from(actual).unwrap_or(u32::MAX);
        Err(Error::Checksum { expected, actual })
    }
}

fn form(link: &Link, checked: bool) -> Result<Option<&Checksum>, Error> {
    if checked {
        let form = link.checksum.as_ref().ok_or(Error::Unsupported)?;
        Ok(Some(form))
    } else {
        Ok(None)
    }
}

fn checksum(form: &Checksum, id: u8, data: &[u8]) -> u32 {
    let mut check = Check::new(&form.algorithm, None);
    if form.covers_id {
        check.feed(&[id]);
    }
    check.feed(data);
    check.result()
}
