//! Identification of the node.

use super::link::{get, Link};
use super::Error;

/// Identity of a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Identity {
    /// Type of the node.
    pub node_type: u32,
    /// Version of its interface.
    pub interface_version: u32,
    /// Whether both equal the values of the ICD, if it has them.
    pub matches: bool,
}

/// Decode an identification frame. Call this first and check `matches` before you use other
/// messages of the node.
///
/// # Errors
///
/// [`Error::Length`] if the frame has another length, [`Error::Unsupported`] if the ICD has none.
///
/// ```
/// use icdgen_runtime::wire::{identify, Error, Link};
///
/// /// Returns whether the node that sent the frame is the node of this link.
/// fn is_ours(link: &Link, frame: &[u8]) -> Result<bool, Error> {
///     Ok(identify(link, frame)?.matches)
/// }
/// ```
pub fn identify(link: &Link, frame: &[u8]) -> Result<Identity, Error> {
    let form = link.identification.as_ref().ok_or(Error::Unsupported)?;
    let (expected, actual) = (form.length, frame.len());
    if expected != actual {
        return Err(Error::Length { expected, actual });
    }
    let node_type = get(form.node_type, frame);
    let interface_version = get(form.interface_version, frame);
    Ok(Identity {
        node_type,
        interface_version,
        matches: link.node_type.map_or(true, |known| known == node_type)
            && link
                .interface_version
                .map_or(true, |known| known == interface_version),
    })
}
