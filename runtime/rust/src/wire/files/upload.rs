//! File upload.

use super::super::bits::{copy, count, head, index, part, part_mut, pieces};
use super::super::crc::Crc;
use super::super::link::{CrcForm, Files, HoleMapForm, Link, Role, UploadForm};
use super::super::links::MAP_BYTES;
use super::super::Error;
use super::hole_map::HoleMap;
use super::poll::Poll;
use super::procedure::{allowed, Answer, Core, End, Run};

#[derive(Clone, Debug)]
enum State {
    Begin,
    Initiate,
    Erasing(Poll),
    Block,
    Packet(usize),
    Map(usize),
    Checksum,
    Finalize,
    Committing(Poll),
}

/// Upload of a file block by block.
#[derive(Clone, Debug)]
pub struct Upload<'a> {
    core: Core,
    link: &'static Link,
    files: &'static Files,
    form: &'static UploadForm,
    map: &'static HoleMapForm,
    crc: &'static CrcForm,
    destination: u8,
    data: &'a [u8],
    block: usize,
    state: State,
    sent: usize,
    rounds: u32,
    holes: [u8; MAP_BYTES], // the node's hole map
    first: bool,            // all packets are missing
}

impl<'a> Upload<'a> {
    /// Create an upload of data to a destination.
    ///
    /// # Errors
    ///
    /// [`Error::Unsupported`] if the node has no uploads, [`Error::Range`] if the destination is
    /// not supported, [`Error::TooLong`] if the data are larger than the destination.
    pub fn new(link: &'static Link, destination: u8, data: &'a [u8]) -> Result<Self, Error> {
        let files = link.files.as_ref().ok_or(Error::Unsupported)?;
        let form = files.upload.as_ref().ok_or(Error::Unsupported)?;
        let map = files.hole_map.as_ref().ok_or(Error::Unsupported)?;
        let crc = link.crc16.as_ref().ok_or(Error::Unsupported)?;
        allowed(form.destinations, destination, "destination")?;
        match form.destination_bytes {
            Some(most) if data.len() > most => {
                let actual = data.len();
                return Err(Error::TooLong { most, actual });
            }
            _ => {}
        }
        Ok(Self {
            core: Core::new(link),
            link,
            files,
            form,
            map,
            crc,
            destination,
            data,
            block: files.block_bytes,
            state: State::Begin,
            sent: 0,
            rounds: 0,
            holes: [0; MAP_BYTES],
            first: true,
        })
    }

    /// Use smaller blocks, of this number of bytes.
    #[must_use]
    pub fn with_block(mut self, bytes: u32) -> Self {
        self.block = index(bytes).min(self.block).max(1);
        self
    }

    /// Return the number of bytes committed, and the total number of bytes.
    #[must_use]
    pub const fn progress(&self) -> (usize, usize) {
        (self.sent, self.data.len())
    }

    /// Bytes of this block.
    fn length(&self) -> usize {
        self.data.len().saturating_sub(self.sent).min(self.block)
    }

    /// Packets of this block.
    fn packets(&self) -> usize {
        pieces(self.length(), self.files.packet_bytes)
    }

    fn next_block(&mut self) {
        if self.sent >= self.data.len() {
            return self.core.end(End::Done);
        }
        self.rounds = 0;
        self.begin();
    }

    fn begin(&mut self) {
        self.core.send(&self.form.begin, true, &[]);
        self.state = State::Block;
        self.first = true;
    }

    /// Begins a round with the first packet that is missing.
    fn round(&mut self, first: usize) {
        if self.rounds == self.form.rounds {
            return self.core.end(End::Rounds);
        }
        self.rounds += 1;
        self.send_packet(first);
    }

    /// The first packet from a position on that the node has not.
    fn missing(&self, from: usize) -> Option<usize> {
        let packets = self.packets();
        if self.first {
            return (from < packets).then_some(from);
        }
        let map =
            HoleMap::from_bytes(self.link, packets, head(&self.holes, self.map.bytes)).ok()?;
        let first = self.files.first_packet;
        let mut missing = map
            .missing()
            .map(|number| index(number.wrapping_sub(first)));
        missing.find(|position| *position >= from)
    }

    /// Sends the next packet from a position on, or asks which ones arrived.
    fn send_next(&mut self, from: usize) {
        match self.missing(from) {
            Some(position) => self.send_packet(position),
            None => self.ask_map(0),
        }
    }

    fn send_packet(&mut self, position: usize) {
        let number = self.files.first_packet.wrapping_add(count(position));
        let step = &self.form.packet;
        self.core.send(step, false, &[(Role::Number, number)]);
        if let Some(span) = step.payload {
            let size = self.files.packet_bytes;
            let block = part(self.data, self.sent, self.length());
            let packet = block.get(position.wrapping_mul(size)..).unwrap_or(&[]);
            let place = self.core.payload(span.at, span.bytes);
            place.fill(self.files.fill);
            copy(place, head(packet, size));
        }
        self.state = State::Packet(position);
    }

    /// Requests a piece of the hole map.
    fn ask_map(&mut self, piece: usize) {
        let maps = pieces(self.packets(), self.map.message_bytes.saturating_mul(8));
        match self.map.messages.get(piece) {
            Some(message) if piece < maps => {
                self.core.ask(message.get_id);
                self.state = State::Map(piece);
            }
            _ => {
                self.first = false;
                if let Some(position) = self.missing(0) {
                    self.round(position);
                } else {
                    self.core.ask(self.form.checksum.id);
                    self.state = State::Checksum;
                }
            }
        }
    }

    fn take_map(&mut self, piece: usize, frame: &[u8]) {
        if let Some(message) = self.map.messages.get(piece) {
            let size = self.map.message_bytes;
            let place = part_mut(&mut self.holes, piece.wrapping_mul(size), size);
            copy(place, part(frame, message.piece.at, message.piece.bytes));
        }
        self.ask_map(piece + 1);
    }

    fn expected(&self) -> u32 {
        let block = part(self.data, self.sent, self.length());
        let mut crc = Crc::new(self.crc);
        crc.feed(block);
        if self.form.checksum_covers_fill {
            let whole = self.packets().wrapping_mul(self.files.packet_bytes);
            for _ in block.len()..whole {
                crc.feed(&[self.files.fill]);
            }
        }
        crc.result()
    }

    fn checksum(&mut self, frame: &[u8]) {
        let found = self.form.checksum.get(Role::Checksum, frame);
        if found != Some(self.expected()) {
            return self.again();
        }
        let values = [
            (Role::Destination, self.destination.into()),
            (Role::Offset, count(self.sent)),
            (Role::Length, count(self.length())),
        ];
        self.core.send(&self.form.finalize, true, &values);
        self.state = State::Finalize;
    }

    fn again(&mut self) {
        if self.rounds == self.form.rounds {
            self.core.end(End::Checksum);
        } else {
            self.begin();
        }
    }

    fn committed(&mut self, frame: &[u8]) {
        if self.form.finalized.get(Role::Error, frame).unwrap_or(0) == 0 {
            self.sent += self.length();
            self.next_block();
        } else {
            self.again();
        }
    }

    fn poll(&mut self, erasing: bool) {
        let form = self.form;
        let (step, timeout) = if erasing {
            (&form.initiated, form.erase_timeout_ms)
        } else {
            (&form.finalized, form.finalize_timeout_ms)
        };
        let wanted = (Role::Busy, false);
        let poll = Poll::begin(&mut self.core, step, wanted, form.poll_interval_ms, timeout);
        self.state = if erasing {
            State::Erasing(poll)
        } else {
            State::Committing(poll)
        };
    }
}

impl Run for Upload<'_> {
    fn core(&self) -> &Core {
        &self.core
    }

    fn core_mut(&mut self) -> &mut Core {
        &mut self.core
    }

    fn resume(&mut self, answer: Option<Answer<'_>>) {
        match self.state.clone() {
            State::Begin => {
                let values = [
                    (Role::Destination, self.destination.into()),
                    (Role::BlockSize, self.form.block_size),
                ];
                self.core.send(&self.form.initiate, true, &values);
                self.state = State::Initiate;
            }
            State::Erasing(poll) => {
                if poll.resume(&mut self.core, answer).is_some() {
                    self.next_block();
                }
            }
            State::Committing(poll) => {
                if let Some(frame) = poll.resume(&mut self.core, answer) {
                    self.committed(frame);
                }
            }
            state => {
                if let Some(frame) = self.core.frame(answer) {
                    match state {
                        State::Initiate => self.poll(true),
                        State::Block => self.round(0),
                        State::Packet(position) => self.send_next(position + 1),
                        State::Map(piece) => self.take_map(piece, frame),
                        State::Checksum => self.checksum(frame),
                        _ => self.poll(false),
                    }
                }
            }
        }
    }
}
