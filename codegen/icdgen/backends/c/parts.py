"""Functions that return the messages contained in a composite message."""

from __future__ import annotations

from collections.abc import Iterator

from icdgen.backends.c.names import part_name
from icdgen.backends.c.statement import call
from icdgen.backends.c.symbols import C_NAMES
from icdgen.backends.c.text import comment
from icdgen.describe import MessageDescription
from icdgen.describe.comments import part_comment
from icdgen.describe.contained import (
    ContainedDescription,
    CopiedMember,
    contained_messages,
)


def parts(message: MessageDescription) -> list[dict[str, object]]:
    """Return the functions of a composite message.

    ``copies`` are the statements for each place of the contained message.
    """
    return [_part(message, contained) for contained in contained_messages(message)]


def _part(message: MessageDescription, part: ContainedDescription) -> dict[str, object]:
    paragraphs, positions = [
        part_comment(part.message.model, part.positions)
    ], part.positions
    if len(positions) > 1:
        paragraphs.append(
            f"ICD_ERROR_RANGE, and `part` as it was, if there is no such part: they are 0 to {len(positions) - 1}."
        )
    copies = [
        [line for copied in part.copies(message, begin) for line in _statements(copied)]
        for begin in positions
    ]
    name, type = part_name(part.message), C_NAMES.symbol(part.message, "t")
    return {"name": name, "type": type, "about": comment(paragraphs), "copies": copies}


def headers(message: MessageDescription) -> list[str]:
    """Return the headers of the contained messages."""
    headers = []
    for contained in contained_messages(message):
        header = f"{contained.message.name}.h"
        is_same_node = contained.message.node is message.node
        headers.append(
            header if is_same_node else f"../{contained.message.node.name}/{header}"
        )
    return headers


def _statements(copied: CopiedMember) -> Iterator[str]:
    member = copied.member
    if copied.is_whole and (member.count or member.model.is_bytes):
        target = f"part->{member.member}"
        yield call(
            "(void)memcpy",
            (target, f"message->{copied.sources[0].member}", f"sizeof {target}"),
        )
        return
    for element, twin in zip(member.elements, copied.sources, strict=True):
        target, source = f"part->{element.member}", f"message->{twin.member}"
        is_bytes = element.model.is_bytes
        yield (
            call("(void)memcpy", (target, source, f"sizeof {target}"))
            if is_bytes
            else f"{target} = {source};"
        )
