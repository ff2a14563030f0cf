//! Operations on the programs that a node stores.

use super::super::link::{Link, OperationForm, Role};
use super::super::Error;
use super::poll::Poll;
use super::procedure::{allowed, Answer, Core, End, Run};

#[derive(Clone, Debug)]
enum State {
    Begin,
    Request,
    Poll(Poll),
}

#[derive(Clone, Debug)]
struct Operation {
    core: Core,
    form: &'static OperationForm,
    state: State,
    program: u8,
    size: Option<u32>,
    checksum: Option<u32>,
}

impl Operation {
    fn new(
        link: &'static Link,
        form: Option<&'static OperationForm>,
        program: u8,
    ) -> Result<Self, Error> {
        let form = form.ok_or(Error::Unsupported)?;
        allowed(form.programs, program, "program")?;
        Ok(Self {
            core: Core::new(link),
            form,
            state: State::Begin,
            program,
            size: None,
            checksum: None,
        })
    }

    fn poll(&mut self) {
        let form = self.form;
        let tells_ready = form.progress.get(Role::Ready, &[]).is_some();
        let wanted = if tells_ready {
            (Role::Ready, true)
        } else {
            (Role::Busy, false)
        };
        let (interval, timeout) = (form.poll_interval_ms, form.timeout_ms);
        let poll = Poll::begin(&mut self.core, &form.progress, wanted, interval, timeout);
        self.state = State::Poll(poll.about(self.program.into()));
    }

    fn ended(&mut self, frame: &[u8]) {
        let step = &self.form.progress;
        if step.get(Role::Error, frame).unwrap_or(0) == 0 {
            self.size = step.get(Role::Size, frame);
            self.checksum = step.get(Role::Checksum, frame);
            self.core.end(End::Done);
        } else {
            self.core.end(End::Error);
        }
    }

    fn resume(&mut self, answer: Option<Answer<'_>>) {
        match &self.state {
            State::Begin => {
                let values = [(Role::Program, self.program.into())];
                self.core.send(&self.form.request, true, &values);
                self.state = State::Request;
            }
            State::Request => {
                if self.core.frame(answer).is_some() {
                    self.poll();
                }
            }
            State::Poll(poll) => {
                if let Some(frame) = poll.resume(&mut self.core, answer) {
                    self.ended(frame);
                }
            }
        }
    }
}

/// Copying of a stored program to the memory from which it runs.
#[derive(Clone, Debug)]
pub struct ProgramCopy(Operation);

impl ProgramCopy {
    /// Create the procedure for this program.
    ///
    /// # Errors
    ///
    /// [`Error::Unsupported`] if the node has no such operation, [`Error::Range`] if the program is
    /// not supported.
    pub fn new(link: &'static Link, program: u8) -> Result<Self, Error> {
        Operation::new(link, link.program_copy.as_ref(), program).map(Self)
    }
}

/// Reading of size and checksum of a stored program.
#[derive(Clone, Debug)]
pub struct ProgramInformation(Operation);

impl ProgramInformation {
    /// Create the procedure for this program.
    ///
    /// # Errors
    ///
    /// [`Error::Unsupported`] if the node has no such operation, [`Error::Range`] if the program is
    /// not supported.
    pub fn new(link: &'static Link, program: u8) -> Result<Self, Error> {
        Operation::new(link, link.program_information.as_ref(), program).map(Self)
    }

    /// Return the size of the program in bytes; None before the end, or if the ICD has no such
    /// field.
    #[must_use]
    pub const fn size(&self) -> Option<u32> {
        self.0.size
    }

    /// Return the checksum of the program; None before the end, or if the ICD has no such field.
    #[must_use]
    pub const fn checksum(&self) -> Option<u32> {
        self.0.checksum
    }
}

impl Run for ProgramCopy {
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

impl Run for ProgramInformation {
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
