//! Messages whose frames differ in length. Each frame is a prefix of the longest one.

use super::Error;

/// Encoded frame of up to `N` bytes.
#[derive(Clone, Copy, Debug)]
pub struct Frame<const N: usize> {
    longest: [u8; N],
    size: usize,
}

impl<const N: usize> Frame<N> {
    /// The first bytes of the longest frame.
    pub(crate) fn new(longest: [u8; N], size: usize) -> Self {
        Self { longest, size }
    }

    /// Puts a part of the longest frame behind what is there: so many bytes from `begin` on.
    pub(crate) fn add(&mut self, longest: &[u8; N], begin: usize, bytes: usize) {
        let part = longest.get(begin..begin + bytes).unwrap_or_default();
        let target = self.longest.get_mut(self.size..).unwrap_or_default();
        copy(target, part);
        self.size += bytes;
    }

    /// Appends elements of `step` bytes from `begin` on, without the bytes of arrays in them that are not in the frame.
    ///
    /// `inner` has these arrays: where each begins in an element, its bytes in the frame, and those in the longest element.
    pub(crate) fn add_elements(
        &mut self,
        longest: &[u8; N],
        begin: usize,
        step: usize,
        count: usize,
        inner: &[(usize, usize, usize)],
    ) {
        for element in 0..count {
            for (first, size) in runs(step, inner) {
                self.add(longest, begin + element * step + first, size);
            }
        }
    }
}

impl<const N: usize> AsRef<[u8]> for Frame<N> {
    #[inline]
    fn as_ref(&self) -> &[u8] {
        present(&self.longest, self.size)
    }
}

impl<const N: usize> core::ops::Deref for Frame<N> {
    type Target = [u8];

    #[inline]
    fn deref(&self) -> &[u8] {
        self.as_ref()
    }
}

impl<const N: usize, const M: usize> PartialEq<[u8; M]> for Frame<N> {
    fn eq(&self, other: &[u8; M]) -> bool {
        self.as_ref() == other.as_slice()
    }
}

impl<const N: usize> PartialEq for Frame<N> {
    fn eq(&self, other: &Self) -> bool {
        self.as_ref() == other.as_ref()
    }
}

impl<const N: usize> Eq for Frame<N> {}

/// The longest frame, the rest of it 0, and how many elements of `step` bytes there are behind the first `least` bytes.
pub(crate) fn longest<const N: usize>(
    bytes: &[u8],
    least: usize,
    step: usize,
) -> Result<([u8; N], usize), Error> {
    let (actual, mut longest) = (bytes.len(), [0; N]);
    let rest = match actual.checked_sub(least) {
        Some(rest) => rest,
        None => return Error::length(least, actual),
    };
    match longest.get_mut(..actual) {
        Some(_) if rest % step != 0 => Error::length(actual - rest % step, actual),
        Some(target) => {
            copy(target, bytes);
            Ok((longest, rest / step))
        }
        None => Error::length(N, actual),
    }
}

/// The longest frame with the first `fixed` bytes of one, of which the shortest has `least`.
pub(crate) fn beginning<const N: usize>(
    bytes: &[u8],
    fixed: usize,
    least: usize,
) -> Result<[u8; N], Error> {
    let mut longest = [0; N];
    match bytes.get(..fixed) {
        Some(first) if bytes.len() >= least => {
            copy(&mut longest, first);
            Ok(longest)
        }
        _ => Error::length(least, bytes.len()),
    }
}

/// Bytes of an open part in front of the end, if the count is one of `low` to `high`, `fewest` elements where it is `low`.
pub(crate) fn told(
    count: impl TryInto<usize>,
    low: usize,
    high: usize,
    fewest: usize,
    step: usize,
) -> Option<usize> {
    let count = count.try_into().ok()?;
    if (low..=high).contains(&count) {
        Some((count - low + fewest) * step)
    } else {
        None
    }
}

/// Puts the parts of a frame where they begin in the longest one: those in `inner` with the bytes that they have, the open end,
/// of which every frame has `fewest` bytes, and the last `behind` bytes. The bytes of a frame that has no more, and how many
/// elements there are then.
#[allow(clippy::too_many_arguments)] // all of them are constants of a message
pub(crate) fn spread<const N: usize>(
    longest: &mut [u8; N],
    bytes: &[u8],
    fixed: usize,
    inner: &[(usize, Option<usize>)],
    end: usize,
    fewest: usize,
    step: usize,
    behind: usize,
) -> Result<(usize, usize), Error> {
    let (actual, mut before) = (bytes.len(), fixed);
    for (_, size) in inner {
        match size {
            Some(size) => before += size,
            // A length that it does not have: its count is none that there can be.
            None => return Error::length(if actual == N { fixed } else { N }, actual),
        }
    }
    let (least, most) = (before + fewest + behind, before + (N - end));
    let rest = match actual.checked_sub(least) {
        Some(rest) => rest,
        None => return Error::length(least, actual),
    };
    if actual > most {
        return Error::length(most, actual);
    }
    if rest % step != 0 {
        return Error::length(actual - rest % step, actual);
    }
    let parts = inner
        .iter()
        .map(|(begin, size)| (*begin, size.unwrap_or_default()));
    let mut from = fixed;
    let last = [(end, actual - before - behind), (N - behind, behind)];
    for (begin, size) in parts.chain(last) {
        let part = bytes.get(from..from + size).unwrap_or_default();
        copy(longest.get_mut(begin..).unwrap_or_default(), part);
        from += size;
    }
    Ok((least, rest / step))
}

/// Runs of bytes of an element that are in a frame: where each begins in the longest element, and its size.
fn runs(step: usize, inner: &[(usize, usize, usize)]) -> impl Iterator<Item = (usize, usize)> + '_ {
    let begins = inner.iter().map(|(begin, _, most)| begin + most);
    let ends = inner.iter().map(|(begin, size, _)| begin + size);
    core::iter::once(0)
        .chain(begins)
        .zip(ends.chain(core::iter::once(step)))
        .map(|(begin, end)| (begin, end.saturating_sub(begin)))
}

/// Numbers and sizes of the parts of a frame of `actual` bytes, if the frame can have them all.
pub(crate) fn valid<const K: usize>(
    parts: [Option<usize>; K],
    fixed: usize,
    longest: usize,
    actual: usize,
) -> Result<[usize; K], Error> {
    let mut sizes = [0; K];
    for (target, part) in sizes.iter_mut().zip(parts) {
        *target = match part {
            Some(size) => size,
            // A length that it does not have: its count is none that there can be.
            None => return Error::length(if actual == longest { fixed } else { longest }, actual),
        };
    }
    Ok(sizes)
}

/// Puts elements of a frame where they begin in the longest one, which has `step` bytes for each from `begin` on.
///
/// They are in the frame behind `from` bytes. `inner` has the arrays in an element: see `Frame::add_elements`.
pub(crate) fn spread_elements<const N: usize>(
    longest: &mut [u8; N],
    bytes: &[u8],
    from: &mut usize,
    begin: usize,
    step: usize,
    count: usize,
    inner: &[(usize, usize, usize)],
) {
    for element in 0..count {
        for (first, size) in runs(step, inner) {
            let part = bytes.get(*from..*from + size).unwrap_or_default();
            let place = begin + element * step + first;
            copy(longest.get_mut(place..).unwrap_or_default(), part);
            *from += size;
        }
    }
}

/// Whether a frame has the length that its counters give.
pub(crate) fn exact(expected: usize, actual: usize) -> Result<(), Error> {
    if actual == expected {
        Ok(())
    } else {
        Error::length(expected, actual)
    }
}

/// Whether a frame says of itself how many elements it has: `told`, which is `low` in a frame of `least` bytes, and one more for
/// each `step` bytes.
pub(crate) fn counted(
    told: impl TryInto<usize>,
    low: usize,
    least: usize,
    step: usize,
    actual: usize,
) -> Result<(), Error> {
    let told = told.try_into().unwrap_or(usize::MAX);
    let expected = least.saturating_add(told.saturating_mul(step));
    match expected.saturating_sub(low * step) {
        expected if expected == actual => Ok(()),
        expected => Error::length(expected, actual),
    }
}

/// How many elements there are beside those of every frame, if the count is one of `low` to `high`.
pub(crate) fn elements(
    field: &'static str,
    count: impl TryInto<usize>,
    low: usize,
    high: usize,
) -> Result<usize, Error> {
    match count.try_into() {
        Ok(count) if (low..=high).contains(&count) => Ok(count - low),
        _ => Err(Error::range(
            field,
            "a number of elements that a frame can have",
        )),
    }
}

/// How many elements there are, `fewest` where the count is `low`.
pub(crate) fn number(count: impl TryInto<usize>, low: usize, fewest: usize) -> usize {
    let count = count.try_into().unwrap_or(usize::MAX);
    count.saturating_sub(low).saturating_add(fewest)
}

/// So many elements that are there, and others that are not.
pub(crate) fn first<T: Copy, const N: usize>(count: usize, present: T, absent: T) -> [T; N] {
    let mut elements = [absent; N];
    for element in elements.iter_mut().take(count) {
        *element = present;
    }
    elements
}

/// The elements that are in the frame.
#[inline]
pub(crate) fn present<T>(elements: &[T], count: impl TryInto<usize>) -> &[T] {
    let count = count.try_into().unwrap_or(usize::MAX);
    elements.get(..count).unwrap_or(elements)
}

/// Copies a frame to the beginning of `buffer` and says how many bytes it has.
pub(crate) fn write_frame(buffer: &mut [u8], frame: &[u8]) -> Result<usize, Error> {
    let capacity = buffer.len();
    match buffer.get_mut(..frame.len()) {
        Some(target) => {
            copy(target, frame);
            Ok(frame.len())
        }
        None => Error::length(frame.len(), capacity),
    }
}

/// Copies bytes to as many others; `copy_from_slice` leaves a panic where a compiler does not see that they are as many.
fn copy(target: &mut [u8], bytes: &[u8]) {
    for (to, from) in target.iter_mut().zip(bytes) {
        *to = *from;
    }
}
