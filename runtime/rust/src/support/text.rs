//! Text in a fixed number of bytes: ASCII, filled with NUL.

use super::Error;

/// What stands before the first NUL; None if it is not ASCII.
pub(crate) fn text(bytes: &[u8]) -> Option<&str> {
    let said = bytes.split(|byte| *byte == 0).next()?;
    core::str::from_utf8(said)
        .ok()
        .filter(|said| said.is_ascii())
}

/// The bytes of a text, the rest NUL, if `field` can hold it.
pub(crate) fn text_array<const N: usize>(
    field: &'static str,
    text: &str,
) -> Result<[u8; N], Error> {
    let mut bytes = [0; N];
    match bytes.get_mut(..text.len()) {
        Some(target) if text.bytes().all(|byte| (1..0x80).contains(&byte)) => {
            target.copy_from_slice(text.as_bytes());
            Ok(bytes)
        }
        _ => Err(Error::range(field, "ASCII without NUL, no longer than it")),
    }
}
