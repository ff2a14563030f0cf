//! Types that restrict a client to the messages of its node.

use super::link::Link;
use crate::{Error, Telecommand, Telemetry};
use core::marker::PhantomData;
use core::ops::Deref;

/// Telemetry of node `T` or of a node that it includes. Implemented by the generated code.
pub trait TelemetryOf<T>: Telemetry {
    /// Decode a frame with the id of this message. Several messages may have the same id.
    ///
    /// # Errors
    ///
    /// See [`Message::from_bytes`](crate::Message::from_bytes); also [`Error::UnknownId`] if it is
    /// another message.
    fn read(bytes: &[u8]) -> Result<Self, Error> {
        Self::from_bytes(bytes)
    }
}

/// Telecommand of node `T` or of a node that it includes. Implemented by the generated code.
pub trait TelecommandOf<T>: Telecommand {}

/// Node whose refusals have reasons of one enumeration.
/// Implemented by the generated code for the type `Node` of the module of the node.
pub trait Refusals {
    /// The enumeration.
    type Reason;

    /// Return the reason of a code, which may be one without a name.
    fn reason(code: u32) -> Self::Reason;
}

/// The link of node `T`: the `LINK` of its module. It dereferences to [`Link`]; its type restricts
/// a client to the messages of the node.
#[derive(Clone, Copy, Debug)]
pub struct NodeLink<T> {
    link: Link,
    node: PhantomData<fn() -> T>,
}

impl<T> NodeLink<T> {
    #[allow(clippy::large_types_passed_by_value)] // of constants, at compile time
    pub(crate) const fn new(link: Link) -> Self {
        let node = PhantomData;
        Self { link, node }
    }

    /// Create a link for the same node with a different description of its protocol, for example
    /// other timeouts.
    #[must_use]
    pub fn changed(&self, change: impl FnOnce(&mut Link)) -> Self {
        let mut link = self.link;
        change(&mut link);
        Self::new(link)
    }
}

impl<T> Deref for NodeLink<T> {
    type Target = Link;

    #[inline]
    fn deref(&self) -> &Link {
        &self.link
    }
}

/// Links for which a client can be created: the `LINK` of a node, or any [`Link`], whose client
/// only accepts requests by id.
pub trait Linked: 'static {
    /// Type of the node; `()` if it is not known at compile time.
    type Node;

    /// Description of the protocol.
    fn link(&'static self) -> &'static Link;
}

impl Linked for Link {
    type Node = ();

    #[inline]
    fn link(&'static self) -> &'static Link {
        self
    }
}

impl<T: 'static> Linked for NodeLink<T> {
    type Node = T;

    #[inline]
    fn link(&'static self) -> &'static Link {
        &self.link
    }
}

/// Convert an id to the byte that is sent.
#[inline]
pub(super) const fn octet(id: u32) -> u8 {
    let [first, ..] = id.to_le_bytes();
    first
}
