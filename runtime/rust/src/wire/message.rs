//! What messages a client takes: those of its node, which is a type for it.

use super::link::Link;
use crate::{Error, Telecommand, Telemetry};
use core::marker::PhantomData;
use core::ops::Deref;

/// Telemetry of node `T`, its own or that of a node that it includes. The generated code says what is.
pub trait TelemetryOf<T>: Telemetry {
    /// Reads a frame of its id, which may be that of several messages.
    ///
    /// # Errors
    ///
    /// Those of [`Message::from_bytes`](crate::Message::from_bytes); [`Error::UnknownId`] if it is another
    /// message.
    fn read(bytes: &[u8]) -> Result<Self, Error> {
        Self::from_bytes(bytes)
    }
}

/// A telecommand of node `T`, its own or that of a node that it includes. The generated code says what is.
pub trait TelecommandOf<T>: Telecommand {}

/// The link of node `T`: the `LINK` of its module. It is used as a [`Link`], and tells a client whose
/// messages it takes.
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

    /// The same node with other facts of its protocol, such as times.
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

/// What a client can be made for: the `LINK` of a node, or any [`Link`], whose client takes requests by
/// their ids alone.
pub trait Linked: 'static {
    /// The node; `()` if it is not known at compile time.
    type Node;

    /// The facts of its protocol.
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

/// The id as it is sent; ids of a client's messages have no more than a byte.
#[inline]
pub(super) const fn octet(id: u32) -> u8 {
    let [first, ..] = id.to_le_bytes();
    first
}
