//! Deletion of files and formatting of the medium.

use super::super::link::{ErasureForm, Link, Role};
use super::super::Error;
use super::poll::Poll;
use super::procedure::{Answer, Core, End, Run};

#[derive(Clone, Debug)]
enum State {
    Begin,
    Request,
    Poll(Poll),
}

#[derive(Clone, Debug)]
struct Erasure {
    core: Core,
    form: &'static ErasureForm,
    state: State,
    values: [(Role, u32); 3],
    polls: bool,
}

impl Erasure {
    const fn new(
        link: &Link,
        form: &'static ErasureForm,
        values: [(Role, u32); 3],
        polls: bool,
    ) -> Self {
        Self {
            core: Core::new(link),
            form,
            state: State::Begin,
            values,
            polls,
        }
    }

    fn resume(&mut self, answer: Option<Answer<'_>>) {
        let (core, form) = (&mut self.core, self.form);
        match &self.state {
            State::Begin => {
                core.send(&form.request, true, &self.values);
                self.state = State::Request;
            }
            State::Request => match core.frame(answer) {
                Some(_) if self.polls => {
                    let (interval, timeout) = (form.poll_interval_ms, form.timeout_ms);
                    let wanted = (Role::Busy, false);
                    let poll = Poll::begin(core, &form.progress, wanted, interval, timeout);
                    self.state = State::Poll(poll);
                }
                Some(_) => core.end(End::Done),
                None => {}
            },
            State::Poll(poll) => {
                if poll.resume(core, answer).is_some() {
                    core.end(End::Done);
                }
            }
        }
    }
}

/// Deletion of one file or all files.
#[derive(Clone, Debug)]
pub struct Erase(Erasure);

impl Erase {
    /// Create the deletion of one file.
    ///
    /// # Errors
    ///
    /// [`Error::Unsupported`] if the ICD does not describe this part of the protocol.
    pub fn file(link: &'static Link, kind: u8, counter: u8) -> Result<Self, Error> {
        Self::new(link, kind, counter, false)
    }

    /// Create the deletion of all files. It ends when the node is no longer busy.
    ///
    /// # Errors
    ///
    /// [`Error::Unsupported`] if the ICD does not describe this part of the protocol.
    pub fn all(link: &'static Link) -> Result<Self, Error> {
        Self::new(link, 0, 0, true)
    }

    /// Create the deletion of one file, or of all files if `all` is true. Deleting all files ends
    /// when the node is no longer busy.
    ///
    /// # Errors
    ///
    /// [`Error::Unsupported`] if the ICD does not describe this part of the protocol.
    pub fn new(link: &'static Link, kind: u8, counter: u8, all: bool) -> Result<Self, Error> {
        let files = link.files.as_ref().ok_or(Error::Unsupported)?;
        let form = files.erase.as_ref().ok_or(Error::Unsupported)?;
        let values = [
            (Role::Type, kind.into()),
            (Role::Counter, counter.into()),
            (Role::All, all.into()),
        ];
        Ok(Self(Erasure::new(link, form, values, all)))
    }
}

/// Formats the medium.
#[derive(Clone, Debug)]
pub struct Format(Erasure);

impl Format {
    /// Formats the medium.
    ///
    /// # Errors
    ///
    /// [`Error::Unsupported`] if the ICD does not describe this part of the protocol.
    pub fn new(link: &'static Link) -> Result<Self, Error> {
        let files = link.files.as_ref().ok_or(Error::Unsupported)?;
        let form = files.format.as_ref().ok_or(Error::Unsupported)?;
        let nothing = (Role::All, 0);
        Ok(Self(Erasure::new(link, form, [nothing; 3], true)))
    }
}

impl Run for Erase {
    fn core(&self) -> &Core {
        &self.0.core
    }

    fn core_mut(&mut self) -> &mut Core {
        &mut self.0.core
    }

    fn resume(&mut self, answer: Option<Answer<'_>>) {
        self.0.resume(answer);
    }
}

impl Run for Format {
    fn core(&self) -> &Core {
        &self.0.core
    }

    fn core_mut(&mut self) -> &mut Core {
        &mut self.0.core
    }

    fn resume(&mut self, answer: Option<Answer<'_>>) {
        self.0.resume(answer);
    }
}
