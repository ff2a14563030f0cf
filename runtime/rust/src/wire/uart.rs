//! UART: framing of messages in a stream of bytes. Messages start with their id.

use super::link::{Form, Framing, Link};
use super::Error;

pub use super::client::uart::Line;

/// Return the size of the framed message in bytes.
///
/// ```
/// use icdgen_runtime::wire::link::Framing;
/// use icdgen_runtime::wire::uart;
///
/// let framing = Framing {
///     escape: 0x1f,
///     start: 0x7f,
///     end: 0xff,
///     escaped: 0x1f,
///     escapes_id: false,
///     ignores_other: false,
/// };
/// assert_eq!(uart::encoded_length(&framing, &[13, 0x00, 0x1f]), 2 + 1 + 1 + 2 + 2);
/// ```
#[must_use]
pub fn encoded_length(framing: &Framing, message: &[u8]) -> usize {
    let escapes = message.iter().enumerate().filter(|(position, byte)| {
        **byte == framing.escape && (*position > 0 || framing.escapes_id)
    });
    message.len() + escapes.count() + 4
}

/// Frame a message and return the number of bytes written to `out`.
///
/// # Errors
///
/// [`Error::Length`] if the message is empty or `out` is too small, [`Error::Unsupported`] if the
/// ICD describes no framing.
///
/// ```
/// use icdgen_runtime::wire::{uart, Error, Link};
///
/// fn sent(link: &Link, message: &[u8], port: &mut Vec<u8>) -> Result<(), Error> {
///     let mut line = [0; 64];
///     let size = uart::encode(link, message, &mut line)?;
///     port.extend_from_slice(&line[..size]);
///     Ok(())
/// }
/// ```
pub fn encode(link: &Link, message: &[u8], out: &mut [u8]) -> Result<usize, Error> {
    let framing = link.framing.as_ref().ok_or(Error::Unsupported)?;
    if message.is_empty() {
        return Err(Error::Length {
            expected: 1,
            actual: 0,
        });
    }
    let expected = encoded_length(framing, message);
    let actual = out.len();
    let mut encoder = Encoder::new(framing);
    let count = encoder.next(message, out);
    if count == expected {
        Ok(count)
    } else {
        Err(Error::Length { expected, actual })
    }
}

/// Writes a message piece by piece.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Encoder<'a> {
    framing: &'a Framing,
    position: usize, // of the next byte; one more than those of the message: all is written
    begun: bool,
}

impl<'a> Encoder<'a> {
    pub(crate) fn new(framing: &'a Framing) -> Self {
        Self {
            framing,
            position: 0,
            begun: false,
        }
    }

    /// The next bytes that fit, of which no escape is cut; none when all are written.
    pub(crate) fn next(&mut self, message: &[u8], out: &mut [u8]) -> usize {
        let framing = self.framing;
        let mut count = 0;
        let mut put = |first: u8, second: Option<u8>| {
            let places = out.get_mut(count..).unwrap_or(&mut []);
            match (places, second) {
                ([place, ..], None) => {
                    *place = first;
                    count += 1;
                    true
                }
                ([place, next, ..], Some(second)) => {
                    *place = first;
                    *next = second;
                    count += 2;
                    true
                }
                _ => false,
            }
        };
        if !self.begun {
            if !put(framing.escape, Some(framing.start)) {
                return 0;
            }
            self.begun = true;
        }
        while let Some(&byte) = message.get(self.position) {
            let escaped = byte == framing.escape && (self.position > 0 || framing.escapes_id);
            if !put(byte, escaped.then_some(framing.escaped)) {
                return count;
            }
            self.position += 1;
        }
        if self.position == message.len() && put(framing.escape, Some(framing.end)) {
            self.position += 1;
        }
        count
    }
}

/// An event of the decoder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event<'a> {
    /// A message, id first.
    Message(&'a [u8]),
    /// A message started before the previous one ended, which is dropped.
    UnexpectedStart,
    /// Invalid byte after the escape byte.
    ProtocolError,
    /// A message is longer than the buffer.
    Overrun,
    /// An empty message, without an id.
    Empty,
}

/// Decoder that finds the messages in a stream. `N` is the size of its buffer in bytes.
///
/// ```
/// use icdgen_runtime::wire::{uart, Error, Link};
///
/// /// The messages in what a line recorder kept, each with its id in front.
/// fn messages(link: &'static Link, recorded: &[u8]) -> Result<Vec<Vec<u8>>, Error> {
///     let mut found = Vec::new();
///     let mut decoder = uart::Decoder::<512>::new(link)?;
///     decoder.feed(recorded, |event| {
///         if let uart::Event::Message(message) = event {
///             found.push(message.to_vec());
///         }
///     });
///     Ok(found)
/// }
/// ```
#[derive(Clone, Debug)]
pub struct Decoder<const N: usize> {
    framing: &'static Framing,
    limit: usize,
    buffer: [u8; N],
    length: usize,
    inside: bool,
    escaped: bool,
    run: u64, // bytes of the stream since the last decision
    discarded: u64,
}

impl<const N: usize> Decoder<N> {
    /// Create a decoder for messages of at most `N` bytes.
    ///
    /// # Errors
    ///
    /// [`Error::Unsupported`] if the ICD describes no framing.
    pub fn new(link: &'static Link) -> Result<Self, Error> {
        Self::with_limit(link, N)
    }

    /// Create a decoder for messages of at most `limit` bytes, which must not exceed `N`.
    ///
    /// # Errors
    ///
    /// [`Error::Unsupported`] if the ICD describes no framing.
    pub fn with_limit(link: &'static Link, limit: usize) -> Result<Self, Error> {
        Ok(Self {
            framing: link.framing.as_ref().ok_or(Error::Unsupported)?,
            limit: limit.min(N),
            buffer: [0; N],
            length: 0,
            inside: false,
            escaped: false,
            run: 0,
            discarded: 0,
        })
    }

    /// Return the number of received bytes that are not part of a message.
    #[must_use]
    pub const fn discarded(&self) -> u64 {
        self.discarded
    }

    /// Return the number of received bytes that may still become part of a message.
    #[must_use]
    pub const fn pending(&self) -> u64 {
        self.run
    }

    /// Pass received bytes to the decoder, in pieces of any size.
    pub fn feed(&mut self, bytes: &[u8], mut on_event: impl FnMut(Event<'_>)) {
        for &byte in bytes {
            self.byte(byte, &mut on_event);
        }
    }

    fn byte(&mut self, byte: u8, on_event: &mut dyn FnMut(Event<'_>)) {
        let framing = self.framing;
        self.run = self.run.wrapping_add(1);
        if !self.inside {
            if self.escaped && byte == framing.start {
                self.start();
            } else {
                self.outside(byte == framing.escape);
            }
        } else if self.escaped {
            self.escaped = false;
            if byte == framing.start {
                on_event(Event::UnexpectedStart);
                self.start();
            } else if byte == framing.end {
                self.end(on_event);
            } else if byte == framing.escaped {
                self.data(framing.escape, on_event);
            } else if !framing.ignores_other {
                on_event(Event::ProtocolError);
                self.outside(byte == framing.escape);
            }
        } else if byte == framing.escape && (self.length > 0 || framing.escapes_id) {
            self.escaped = true;
        } else {
            self.data(byte, on_event);
        }
    }

    fn start(&mut self) {
        // All but the two bytes of the start itself.
        self.discarded = self.discarded.wrapping_add(self.run.wrapping_sub(2));
        self.run = 2;
        self.inside = true;
        self.escaped = false;
        self.length = 0;
    }

    /// Drops what was decided to be no message; an escape byte may still begin one.
    fn outside(&mut self, escaped: bool) {
        let kept = u64::from(escaped);
        self.discarded = self.discarded.wrapping_add(self.run.wrapping_sub(kept));
        self.run = kept;
        self.inside = false;
        self.escaped = escaped;
        self.length = 0;
    }

    fn data(&mut self, byte: u8, on_event: &mut dyn FnMut(Event<'_>)) {
        let free = self.length < self.limit;
        match self.buffer.get_mut(self.length) {
            Some(place) if free => {
                *place = byte;
                self.length += 1;
            }
            _ => {
                on_event(Event::Overrun);
                self.outside(false);
            }
        }
    }

    fn end(&mut self, on_event: &mut dyn FnMut(Event<'_>)) {
        match self.buffer.get(..self.length) {
            Some(message) if !message.is_empty() => {
                on_event(Event::Message(message));
                self.run = 0;
            }
            _ => on_event(Event::Empty),
        }
        self.outside(false);
    }
}

/// Kind of a message from the node.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kind {
    /// A telemetry frame.
    Reply,
    /// The acknowledge of a telecommand.
    Acknowledge,
    /// Unsolicited telemetry, such as a packet of a file.
    Packet,
    /// An unsolicited log.
    Log,
    /// Anything else.
    Other,
}

/// Return the kind of a message from the node, determined from its id and length.
#[must_use]
pub fn kind(link: &Link, message: &[u8]) -> Kind {
    let id = match message.first() {
        Some(id) => *id,
        None => return Kind::Other,
    };
    if let (Some(form), Some(layout)) = (&link.log_message, &link.mask) {
        if id == form.id {
            let mask = message.get(form.mask_at..).unwrap_or(&[]);
            let slots = layout
                .selected(super::bits::head(mask, layout.size))
                .count();
            let whole = form.frames_at + slots * layout.slot_bytes;
            return if message.len() == whole {
                Kind::Log
            } else {
                Kind::Other
            };
        }
    }
    if link.telemetry_ids.contains(id) {
        return Kind::Reply;
    }
    if link.acknowledge_bytes == Some(message.len()) {
        return Kind::Acknowledge;
    }
    match unsolicited(link, id) {
        Some(form) if message.len() == 1 + form.length => Kind::Packet,
        _ => Kind::Other,
    }
}

/// The unsolicited telemetry in a message that begins with this id.
pub(crate) fn unsolicited(link: &Link, first: u8) -> Option<&'static Form> {
    let mut rows = link.unsolicited.iter();
    let (_, telemetry) = rows.find(|(id, _)| *id == first)?;
    link.telemetry(*telemetry)
}
