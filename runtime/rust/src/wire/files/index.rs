//! Entries of the index file.

use super::super::bits::{copy, number, part, part_mut, put_number};
use super::super::link::{IndexForm, Link, Span};
use super::super::Error;

/// An entry of the index file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct IndexEntry<'a> {
    /// Type of the file.
    pub kind: u32,
    /// Counter of the file.
    pub counter: u32,
    /// Checksum of the file.
    pub checksum: u32,
    /// Size of the file in bytes.
    pub size: u32,
    /// When it was created, packed: see [`DosTime`](crate::wire::DosTime).
    pub time: u32,
    /// Meta-data.
    pub meta: &'a [u8],
}

/// Iterator over the entries of an index file.
///
/// ```
/// use icdgen_runtime::wire::files::IndexEntries;
/// use icdgen_runtime::wire::{Error, Link};
///
/// fn count(link: &'static Link, index_file: &[u8]) -> Result<usize, Error> {
///     Ok(IndexEntries::new(link, index_file)?.count())
/// }
/// ```
#[derive(Clone, Debug)]
pub struct IndexEntries<'a> {
    form: &'static IndexForm,
    little: bool,
    rest: &'a [u8],
}

impl<'a> IndexEntries<'a> {
    /// Create the iterator for the content of an index file.
    ///
    /// # Errors
    ///
    /// [`Error::Unsupported`] if the ICD does not describe this part of the protocol.
    pub fn new(link: &'static Link, bytes: &'a [u8]) -> Result<Self, Error> {
        Ok(Self {
            form: link.index.as_ref().ok_or(Error::Unsupported)?,
            little: link.little,
            rest: bytes,
        })
    }

    /// Return the number of bytes of a truncated last entry.
    #[must_use]
    pub fn truncated(&self) -> usize {
        let truncated = self.rest.len().checked_rem(self.form.entry_bytes);
        truncated.unwrap_or(0)
    }
}

impl<'a> Iterator for IndexEntries<'a> {
    type Item = IndexEntry<'a>;

    fn next(&mut self) -> Option<IndexEntry<'a>> {
        let form = self.form;
        let entry = self.rest.get(..form.entry_bytes.max(1))?;
        self.rest = self.rest.get(form.entry_bytes.max(1)..)?;
        let read = |span: Span| {
            let value = number(part(entry, span.at, span.bytes), self.little);
            u32::try_from(value).unwrap_or(u32::MAX)
        };
        Some(IndexEntry {
            kind: read(form.kind),
            counter: read(form.counter),
            checksum: read(form.checksum),
            size: read(form.size),
            time: read(form.time),
            meta: part(entry, form.meta.at, form.meta.bytes),
        })
    }
}

impl IndexEntry<'_> {
    /// Encode the entry to the beginning of `out` and return the number of bytes.
    ///
    /// # Errors
    ///
    /// [`Error::Range`] if a value does not fit, [`Error::Length`] if the meta-data have another length or
    /// `out` is too small, [`Error::Unsupported`] if the ICD does not describe index files.
    pub fn encode(&self, link: &Link, out: &mut [u8]) -> Result<usize, Error> {
        let form = link.index.as_ref().ok_or(Error::Unsupported)?;
        let (expected, actual) = (form.entry_bytes, out.len());
        let error = Error::Length { expected, actual };
        let out = out.get_mut(..expected).ok_or(error)?;
        out.fill(0);
        for (field, span, value) in [
            ("type", form.kind, self.kind),
            ("counter", form.counter, self.counter),
            ("checksum", form.checksum, self.checksum),
            ("size", form.size, self.size),
            ("time", form.time, self.time),
        ] {
            let place = part_mut(out, span.at, span.bytes);
            if !put_number(place, value.into(), link.little) {
                return Err(Error::range(field));
            }
        }
        let (expected, actual) = (form.meta.bytes, self.meta.len());
        if expected != actual {
            return Err(Error::Length { expected, actual });
        }
        copy(part_mut(out, form.meta.at, expected), self.meta);
        Ok(form.entry_bytes)
    }
}
