//! Numbers and bytes, without panics.

/// The number that the bytes are.
pub(crate) fn number(bytes: &[u8], little: bool) -> u64 {
    let fold = |value: u64, byte: &u8| (value << 8) | u64::from(*byte);
    if little {
        bytes.iter().rev().fold(0, fold)
    } else {
        bytes.iter().fold(0, fold)
    }
}

/// Makes the bytes the number; says whether it fits.
pub(crate) fn put_number(out: &mut [u8], value: u64, little: bool) -> bool {
    let mut rest = value;
    let mut put = |byte: &mut u8| {
        *byte = low(rest);
        rest >>= 8;
    };
    if little {
        out.iter_mut().for_each(&mut put);
    } else {
        out.iter_mut().rev().for_each(&mut put);
    }
    rest == 0
}

/// The lowest byte.
pub(crate) fn low(value: u64) -> u8 {
    let [byte, ..] = value.to_le_bytes();
    byte
}

/// As many bytes as both have.
pub(crate) fn copy(to: &mut [u8], from: &[u8]) {
    for (to, from) in to.iter_mut().zip(from) {
        *to = *from;
    }
}

/// `size` bytes from `at` on; none if there are not so many.
pub(crate) fn part(bytes: &[u8], at: usize, size: usize) -> &[u8] {
    let rest = bytes.get(at..).unwrap_or(&[]);
    rest.get(..size).unwrap_or(&[])
}

/// `size` bytes from `at` on; none if there are not so many.
pub(crate) fn part_mut(bytes: &mut [u8], at: usize, size: usize) -> &mut [u8] {
    let rest = bytes.get_mut(at..).unwrap_or(&mut []);
    rest.get_mut(..size).unwrap_or(&mut [])
}

/// The first `size` bytes, or all if there are fewer.
pub(crate) fn head(bytes: &[u8], size: usize) -> &[u8] {
    bytes.get(..size).unwrap_or(bytes)
}

/// A size as an index.
pub(crate) fn index(value: u32) -> usize {
    usize::try_from(value).unwrap_or(usize::MAX)
}

/// A size as a number.
pub(crate) fn count(value: usize) -> u32 {
    u32::try_from(value).unwrap_or(u32::MAX)
}

/// How many pieces of a size there are.
pub(crate) fn pieces(whole: usize, size: usize) -> usize {
    let full = whole.checked_div(size).unwrap_or(0);
    full + usize::from(full.wrapping_mul(size) < whole)
}

/// Whether the time has come, for times that wrap.
pub(crate) fn reached(now: u32, until: u32) -> bool {
    now.wrapping_sub(until) < 1 << 31
}
