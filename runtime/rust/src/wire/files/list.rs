//! Listing of files.

use super::super::bits::{copy, head};
use super::super::link::{Link, ListForm, Role};
use super::super::links::STEP_BYTES;
use super::super::Error;
use super::poll::Poll;
use super::procedure::{Answer, Core, End, Run};

/// A file of the node.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Entry {
    /// Type of the file.
    pub kind: u32,
    /// Counter of the file.
    pub counter: u32,
    /// Size of the file in bytes.
    pub size: u32,
    /// When it was created, packed: see [`DosTime`](crate::wire::DosTime).
    pub time: u32,
    /// Checksum of the file.
    pub checksum: u32,
}

#[derive(Clone, Debug)]
enum State {
    Begin,
    Reset,
    Poll(Poll),
    Advance,
}

/// Listing of the files of the node.
///
/// ```
/// use icdgen_runtime::wire::files::{Entry, List};
/// use icdgen_runtime::wire::{Error, Link};
///
/// fn listing<'a>(link: &'static Link, seen: &'a mut Vec<Entry>) -> Result<List<impl FnMut(Entry) + 'a>, Error> {
///     List::new(link, move |entry| seen.push(entry))
/// }
/// ```
#[derive(Clone, Debug)]
pub struct List<F> {
    core: Core,
    form: &'static ListForm,
    retries: u32,
    state: State,
    last: Option<[u8; STEP_BYTES]>,
    again: u32,
    count: u32, // files passed to `on_entry`
    on_entry: F,
}

impl<F: FnMut(Entry)> List<F> {
    /// Create a listing that calls `on_entry` for each file.
    ///
    /// # Errors
    ///
    /// [`Error::Unsupported`] if the ICD does not describe this part of the protocol.
    pub fn new(link: &'static Link, on_entry: F) -> Result<Self, Error> {
        let files = link.files.as_ref().ok_or(Error::Unsupported)?;
        Ok(Self {
            core: Core::new(link),
            form: files.list.as_ref().ok_or(Error::Unsupported)?,
            retries: link.client.retries.into(),
            state: State::Begin,
            last: None,
            again: 0,
            count: 0,
            on_entry,
        })
    }

    fn poll(&mut self) {
        let form = self.form;
        let wanted = (Role::Busy, false);
        let (interval, timeout) = (form.poll_interval_ms, form.timeout_ms);
        let poll = Poll::begin(&mut self.core, &form.information, wanted, interval, timeout);
        self.state = State::Poll(poll);
    }

    fn information(&mut self, frame: &[u8]) {
        if frame.iter().all(|byte| *byte == 0) {
            return self.core.end(End::Done);
        }
        let known = self.last.as_ref().map(|last| head(last, frame.len()));
        if known != Some(frame) {
            if self.count == self.form.max_entries {
                return self.core.end(End::Limit);
            }
            self.count += 1;
            let read = |role| self.form.information.get(role, frame).unwrap_or(0);
            (self.on_entry)(Entry {
                kind: read(Role::Type),
                counter: read(Role::Counter),
                size: read(Role::Size),
                time: read(Role::Time),
                checksum: read(Role::Checksum),
            });
            self.again = 0;
        } else if self.again > self.retries {
            return self.core.end(End::Timeout);
        }
        let mut last = [0; STEP_BYTES];
        copy(&mut last, frame);
        self.last = Some(last);
        self.again += 1;
        // Sent once: if only its acknowledge was lost, the next frame tells that it arrived.
        self.core.send(&self.form.advance, false, &[]);
        self.state = State::Advance;
    }
}

impl<F: FnMut(Entry)> Run for List<F> {
    fn core(&self) -> &Core {
        &self.core
    }

    fn core_mut(&mut self) -> &mut Core {
        &mut self.core
    }

    fn resume(&mut self, answer: Option<Answer<'_>>) {
        match &self.state {
            State::Begin => {
                self.core.send(&self.form.reset, true, &[]);
                self.state = State::Reset;
            }
            State::Reset => {
                if self.core.frame(answer).is_some() {
                    self.poll();
                }
            }
            State::Poll(poll) => {
                if let Some(frame) = poll.resume(&mut self.core, answer) {
                    self.information(frame);
                }
            }
            State::Advance => match answer {
                Some(Answer::Refused) => self.core.end(End::Refused),
                _ => self.poll(),
            },
        }
    }
}
