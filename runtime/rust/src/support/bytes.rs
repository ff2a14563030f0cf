//! Access to bytes.

use super::Error;

// Macros, so that every index is a constant at any level of optimisation.

/// Bytes from a place on: `take!(bytes[at; count])`.
macro_rules! take {
    ($bytes:ident[$at:literal; 2]) => {
        [$bytes[$at], $bytes[$at + 1]]
    };
    ($bytes:ident[$at:literal; 4]) => {
        [
            $bytes[$at],
            $bytes[$at + 1],
            $bytes[$at + 2],
            $bytes[$at + 3],
        ]
    };
    ($bytes:ident[$at:literal; 8]) => {
        [
            $bytes[$at],
            $bytes[$at + 1],
            $bytes[$at + 2],
            $bytes[$at + 3],
            $bytes[$at + 4],
            $bytes[$at + 5],
            $bytes[$at + 6],
            $bytes[$at + 7],
        ]
    };
}
pub(crate) use take;

/// Puts bytes at a place: `put!(value => bytes[at; count])`.
macro_rules! put {
    ($value:expr => $bytes:ident[$at:literal; 1]) => {
        let value = $value;
        $bytes[$at] = value[0];
    };
    ($value:expr => $bytes:ident[$at:literal; 2]) => {
        let value = $value;
        $bytes[$at] = value[0];
        $bytes[$at + 1] = value[1];
    };
    ($value:expr => $bytes:ident[$at:literal; 4]) => {
        let value = $value;
        $bytes[$at] = value[0];
        $bytes[$at + 1] = value[1];
        $bytes[$at + 2] = value[2];
        $bytes[$at + 3] = value[3];
    };
    ($value:expr => $bytes:ident[$at:literal; 8]) => {
        let value = $value;
        $bytes[$at] = value[0];
        $bytes[$at + 1] = value[1];
        $bytes[$at + 2] = value[2];
        $bytes[$at + 3] = value[3];
        $bytes[$at + 4] = value[4];
        $bytes[$at + 5] = value[5];
        $bytes[$at + 6] = value[6];
        $bytes[$at + 7] = value[7];
    };
}
pub(crate) use put;

/// The `N` bytes from `at` on.
#[inline(always)]
pub(crate) fn array<const N: usize>(bytes: &[u8], at: usize) -> [u8; N] {
    match bytes.get(at..at + N).map(TryInto::try_into) {
        Some(Ok(taken)) => taken,
        _ => [0; N],
    }
}

/// Copies `value` to the bytes from `at` on; says whether there are enough.
#[inline(always)]
pub(crate) fn put_array<const N: usize>(bytes: &mut [u8], at: usize, value: &[u8; N]) -> bool {
    match bytes.get_mut(at..at + N).map(<&mut [u8; N]>::try_from) {
        Some(Ok(target)) => {
            *target = *value;
            true
        }
        _ => false,
    }
}

/// `N` values, each made by `value` of `SIZE` bytes, from `at` on.
#[inline(always)]
pub(crate) fn words<T: Copy + Default, const SIZE: usize, const N: usize>(
    bytes: &[u8],
    at: usize,
    value: impl Fn([u8; SIZE]) -> T,
) -> [T; N] {
    let mut values = [T::default(); N];
    for (index, target) in values.iter_mut().enumerate() {
        *target = value(array(bytes, at + index * SIZE));
    }
    values
}

/// The same, for what is long: elements that are not in the frame, or are all zeros, are read once.
#[inline(always)]
pub(crate) fn each<T: Copy, const SIZE: usize, const N: usize>(
    bytes: &[u8],
    at: usize,
    value: impl Fn(&[u8; SIZE]) -> T,
) -> [T; N] {
    let mut values = [value(&[0; SIZE]); N];
    for (index, target) in values.iter_mut().enumerate() {
        let element = array(bytes, at + index * SIZE);
        if element != [0; SIZE] {
            *target = value(&element);
        }
    }
    values
}

/// `N` values, of which `value` makes `MANY` at once of `SIZE` bytes, from `at` on.
#[inline(always)]
pub(crate) fn rounds<T: Copy + Default, const SIZE: usize, const MANY: usize, const N: usize>(
    bytes: &[u8],
    at: usize,
    value: impl Fn(&[u8; SIZE]) -> [T; MANY],
) -> [T; N] {
    let mut values = [T::default(); N];
    for (index, part) in values.chunks_exact_mut(MANY).enumerate() {
        let made = value(&array(bytes, at + index * SIZE));
        for (target, one) in part.iter_mut().zip(made.iter()) {
            *target = *one;
        }
    }
    values
}

/// `N` rows of `SIZE` bytes, from `at` on.
#[inline(always)]
pub(crate) fn arrays<const SIZE: usize, const N: usize>(
    bytes: &[u8],
    at: usize,
) -> [[u8; SIZE]; N] {
    let mut rows = [[0; SIZE]; N];
    for (index, row) in rows.iter_mut().enumerate() {
        *row = array(bytes, at + index * SIZE);
    }
    rows
}

/// Puts values, of each the `SIZE` bytes that `word` makes of it, from `at` on.
#[inline(always)]
pub(crate) fn put_words<T: Copy, const SIZE: usize, const N: usize>(
    bytes: &mut [u8],
    at: usize,
    values: &[T; N],
    word: impl Fn(T) -> [u8; SIZE],
) {
    for (index, value) in values.iter().enumerate() {
        put_array(bytes, at + index * SIZE, &word(*value));
    }
}

/// The same, for what is long.
#[inline(always)]
pub(crate) fn put_each<T, const SIZE: usize, const N: usize>(
    bytes: &mut [u8],
    at: usize,
    values: &[T; N],
    octets: impl Fn(&T) -> [u8; SIZE],
) {
    for (index, value) in values.iter().enumerate() {
        put_array(bytes, at + index * SIZE, &octets(value));
    }
}

/// Puts values, of `MANY` of which `octets` makes `SIZE` bytes, from `at` on.
#[inline(always)]
pub(crate) fn put_rounds<T: Copy, const SIZE: usize, const MANY: usize, const N: usize>(
    bytes: &mut [u8],
    at: usize,
    values: &[T; N],
    octets: impl Fn(&[T; MANY]) -> [u8; SIZE],
) {
    for (index, part) in values.chunks_exact(MANY).enumerate() {
        if let Ok(part) = part.try_into() {
            put_array(bytes, at + index * SIZE, &octets(part));
        }
    }
}

/// One of the elements of an array.
#[inline]
pub(crate) fn element_of<T: Copy>(elements: &[T], element: usize) -> Option<T> {
    elements.get(element).copied()
}

/// Sets one of the elements of an array.
#[inline]
pub(crate) fn put_element<T>(
    field: &'static str,
    elements: &mut [T],
    element: usize,
    value: T,
) -> Result<(), Error> {
    match elements.get_mut(element) {
        Some(target) => {
            *target = value;
            Ok(())
        }
        None => Err(Error::range(field, "an index of its elements")),
    }
}

/// Copies `bytes` to the beginning of `buffer` and says how many they are.
#[inline]
pub(crate) fn write_to<const N: usize>(buffer: &mut [u8], bytes: &[u8; N]) -> Result<usize, Error> {
    if put_array(buffer, 0, bytes) {
        Ok(N)
    } else {
        Error::length(N, buffer.len())
    }
}

/// The eight bits of a byte, least significant first: looked up where memory is plenty, which is faster.
#[inline(always)]
pub(crate) fn flags(byte: u8) -> [bool; 8] {
    #[cfg(target_pointer_width = "64")]
    return FLAGS[usize::from(byte)];
    #[cfg(not(target_pointer_width = "64"))]
    return bits(byte);
}

#[cfg(target_pointer_width = "64")]
static FLAGS: [[bool; 8]; 256] = flag_table();

#[cfg(target_pointer_width = "64")]
const fn flag_table() -> [[bool; 8]; 256] {
    let mut table = [[false; 8]; 256];
    let mut byte = 0_u8;
    loop {
        table[byte as usize] = bits(byte);
        if byte == u8::MAX {
            return table;
        }
        byte += 1;
    }
}

const fn bits(byte: u8) -> [bool; 8] {
    [
        byte & 0x01 != 0,
        byte & 0x02 != 0,
        byte & 0x04 != 0,
        byte & 0x08 != 0,
        byte & 0x10 != 0,
        byte & 0x20 != 0,
        byte & 0x40 != 0,
        byte & 0x80 != 0,
    ]
}
