"""Documentation of nodes, and the tests that dispatch frames to messages of the same
id.

The templates ``lib.rs.j2`` and ``node.rs.j2`` call these functions.
"""

from __future__ import annotations

from collections.abc import Iterable

from icdgen.backends.lines import STEP
from icdgen.backends.rust.text import WIDTH, doc, integer, mask, prose
from icdgen.describe import NodeDescription
from icdgen.describe.comments import sentence
from icdgen.describe.lengths import LengthTest
from icdgen.describe.nodes import MessageOfId
from icdgen.describe.storage import storage_bits
from icdgen.icd.model import Node


def summary(node: Node) -> str:
    """Return the entry of a node on the front page of the crate."""
    # The text is wrapped as continuation lines of a list item. Then the first line gets
    # its dash.
    item = f"[`{node.name}`], {prose(sentence(node.title))} {prose(sentence(node.summary))}".rstrip()
    return doc([item], mark="//!  ").replace("//!  ", "//! -", 1)


def about(node: NodeDescription) -> str:
    """Return the documentation of the module of a node: title, source and included
    nodes.
    """
    model = node.model
    owners = dict.fromkeys(message.node.name for message in node.all_messages)
    printed = ", ".join(f"{key} {value}" for key, value in model.document)
    included = ", ".join(
        f"[`{name}`](crate::{name})" for name in owners if name != node.name
    )
    paragraphs = [
        f"{prose(sentence(model.title))} {prose(sentence(model.summary))}".rstrip(),
        prose(sentence(f"Source: {printed}")) if printed else "",
        f"It also speaks the messages of {included}." if included else "",
    ]
    return doc(paragraphs, mark="//!")


def typed(value: int) -> str:
    """Return type and literal of a number: ``u8 = 10``."""
    return f"u{storage_bits(value.bit_length())} = {integer(value)}"


def guarded(candidate: MessageOfId, path: str) -> str:
    """Return the pattern of a match arm: the id, with tests of the length and of the
    constant bytes of the message.
    """
    terms = _frame_length_tests(candidate.length_tests, f"{path}::LENGTH")
    for constant in candidate.constant_bytes:
        byte = f"bytes[{constant.byte}]"
        # Indexing would panic here: a guard runs before the length of the frame is
        # certain.
        if candidate.can_lack(constant):
            byte = f"bytes.get({constant.byte}).map_or(0, |byte| *byte)"
        masked = byte if constant.mask == 0xFF else f"{byte} & {mask(constant.mask)}"
        terms.append(f"{masked} == {mask(constant.value)}")
    id = f"{STEP * 3}{path}::{candidate.id_name.upper()}"
    line = f"{id} if {' && '.join(terms)}"
    rows = f"\n{STEP * 5}&& ".join(terms)
    return line if len(line) <= WIDTH - len(" => {") else f"{id}\n{STEP * 4}if {rows}"


def _frame_length_tests(length_tests: Iterable[LengthTest], longest: str) -> list[str]:
    """Return the tests of the length of a frame.

    ``longest`` is the constant of the longest.
    """
    tests = {test.kind: test for test in length_tests}
    if "equal" in tests:
        return [f"bytes.len() == {longest}"]
    least, multiple = tests.get("at least"), tests.get("multiple")
    terms = [
        (
            f"({least.value}..={longest}).contains(&bytes.len())"
            if least
            else f"bytes.len() <= {longest}"
        )
    ]
    if multiple:
        counted = (
            # The difference cannot underflow, because `&&` tests the shortest length
            # before it.
            f"(bytes.len() - {multiple.without})" if multiple.without else "bytes.len()"
        )
        terms.append(f"{counted} % {multiple.value} == 0")
    return terms
