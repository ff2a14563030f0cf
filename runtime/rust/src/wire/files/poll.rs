//! Requesting a frame until a flag is as wanted.

use super::super::bits::reached;
use super::super::link::{Role, Step};
use super::procedure::{Answer, Core, End};

/// Requests the frame of a step again and again.
#[derive(Clone, Debug)]
pub(super) struct Poll {
    step: &'static Step,
    role: Role,
    wanted: bool,
    interval: u32,
    end: u32,
    program: Option<u32>, // of which the frame must be, if it says of which one it is
}

impl Poll {
    /// Begins with the first request.
    pub(super) fn begin(
        core: &mut Core,
        step: &'static Step,
        (role, wanted): (Role, bool),
        interval: u32,
        timeout: u32,
    ) -> Self {
        core.ask(step.id);
        Self {
            step,
            role,
            wanted,
            interval,
            end: core.now.wrapping_add(timeout),
            program: None,
        }
    }

    /// The same for a frame about a program.
    pub(super) const fn about(mut self, program: u32) -> Self {
        self.program = Some(program);
        self
    }

    /// Whether the frame is about what was asked for.
    fn is_meant(&self, frame: &[u8]) -> bool {
        match (self.program, self.step.get(Role::Program, frame)) {
            (Some(asked), Some(told)) => asked == told,
            _ => true,
        }
    }

    /// The frame, when the flag is as wanted or tells an error; none while polling goes on, or when it has
    /// ended in vain.
    pub(super) fn resume<'a>(
        &self,
        core: &mut Core,
        answer: Option<Answer<'a>>,
    ) -> Option<&'a [u8]> {
        if answer.is_none() {
            core.ask(self.step.id);
            return None;
        }
        let frame = core.frame(answer)?;
        let flag = self.step.get(self.role, frame).map(|flag| flag != 0);
        let failed = self.step.get(Role::Error, frame).unwrap_or(0) != 0;
        if (flag == Some(self.wanted) && self.is_meant(frame)) || failed {
            return Some(frame);
        }
        if reached(core.now, self.end) {
            core.end(End::Timeout);
        } else {
            core.wait(core.now.wrapping_add(self.interval));
        }
        None
    }
}
