"""A node -> what templates say of it beside the description."""

from __future__ import annotations

from icdgen.backends.rust.text import doc, integer, prose
from icdgen.describe import NodeDescription
from icdgen.describe.comments import sentence
from icdgen.describe.storage import holding
from icdgen.icd.model import Node


def summary(node: Node) -> str:
    """A node as the crate's front page lists it."""
    item = f"[`{node.name}`], {prose(sentence(node.title))} {prose(sentence(node.summary))}".rstrip()
    return doc([item], mark="//!  ").replace("//!  ", "//! -", 1)


def about(node: NodeDescription) -> str:
    """What its module begins with: title, source, and whose messages it speaks, too."""
    one, spoken = node.model, dict.fromkeys(message.node.name for message in node.spoken)
    printed = ", ".join(f"{key} {value}" for key, value in one.document)
    included = ", ".join(f"[`{name}`](crate::{name})" for name in spoken if name != node.name)
    paragraphs = [
        f"{prose(sentence(one.title))} {prose(sentence(one.summary))}".rstrip(),
        prose(sentence(f"Source: {printed}")) if printed else "",
        f"It also speaks the messages of {included}." if included else "",
    ]
    return doc(paragraphs, mark="//!")


def typed(value: int) -> str:
    """Type and literal of a number: ``u8 = 10``."""
    return f"u{holding(value.bit_length())} = {integer(value)}"
