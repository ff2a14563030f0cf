//! A sample, so that the runtime is a crate of its own: the links of the nodes, and what the procedures
//! need for any of them, are generated.

/// Bytes of the longest telecommand of a procedure.
pub(crate) const STEP_BYTES: usize = 8;
/// Bytes of the longest entry of a list.
pub(crate) const ENTRY_BYTES: usize = 8;
