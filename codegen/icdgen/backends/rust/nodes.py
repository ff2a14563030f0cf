"""A node -> what templates say of it beside the description."""

from __future__ import annotations

from icdgen.backends.rust.text import code, doc, integer, prose
from icdgen.describe import NodeDescription
from icdgen.describe.comments import sentence
from icdgen.describe.storage import holding
from icdgen.icd.model import Node


def summary(node: Node) -> str:
    """A node as the crate's front page lists it."""
    item = f"[`{node.name}`], {prose(sentence(node.title))} {prose(sentence(node.summary))}".rstrip()
    return doc([item], mark="//!  ").replace("//!  ", "//! -", 1)


def about(node: NodeDescription, example: list[str]) -> str:
    """What its module begins with: title, source, whose messages it speaks, too, and an example."""
    one, spoken = node.model, dict.fromkeys(message.node.name for message in node.spoken)
    printed = ", ".join(f"{key} {value}" for key, value in one.document)
    included = ", ".join(f"[`{name}`](crate::{name})" for name in spoken if name != node.name)
    paragraphs = [
        f"{prose(sentence(one.title))} {prose(sentence(one.summary))}".rstrip(),
        prose(sentence(f"Source: {printed}")) if printed else "",
        f"It also speaks the messages of {included}." if included else "",
    ]
    text = doc(paragraphs, mark="//!")
    return f"{text}\n{code(example, mark='//!')}" if example else text


def typed(value: int) -> str:
    """Type and literal of a number: ``u8 = 10``."""
    return f"u{holding(value.bit_length())} = {integer(value)}"
