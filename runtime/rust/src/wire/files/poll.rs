//! Requesting a frame until a flag is as wanted.

use super::super::bits::reached;
use super::super::link::{Role, Step};
use super::procedure::{Answer, Core, End};

/// Requests the frame of a step again and again.
#[derive(Clone, Debug)]
pub(super) struct Poll {
    step: &'static Step,
    role: Role,
    wanted: u32,
    interval: u32,
    end: u32,
}

impl Poll {
    /// Begins with the first request.
    pub(super) fn begin(
        core: &mut Core,
        step: &'static Step,
        (role, wanted): (Role, u32),
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
        let flag = self.step.get(self.role, frame);
        let failed = self.step.get(Role::Error, frame).unwrap_or(0) != 0;
        if flag == Some(self.wanted) || failed {
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
