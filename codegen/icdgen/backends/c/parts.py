"""The functions that give the messages which a composite message repeats."""

from __future__ import annotations

from collections.abc import Iterator

from icdgen.backends.c.names import stem
from icdgen.backends.c.statement import call
from icdgen.backends.c.text import comment
from icdgen.describe import MessageDescription
from icdgen.describe.comments import part_comment
from icdgen.describe.contained import ContainedDescription, CopiedMember, contained_messages


def parts(message: MessageDescription) -> list[dict[str, object]]:
    """Those of a composite message; ``copies`` are the statements of each, once for each time that it is repeated."""
    return [_part(message, one) for one in contained_messages(message)]


def _part(message: MessageDescription, part: ContainedDescription) -> dict[str, object]:
    said, positions = [part_comment(part.message.model, part.positions)], part.positions
    if len(positions) > 1:
        said.append(
            f"ICD_ERROR_RANGE, and `part` as it was, if there is no such part: they are 0 to {len(positions) - 1}."
        )
    copies = [[line for copied in part.copies(message, begin) for line in _statements(copied)] for begin in positions]
    name, type = part_name(part.message), f"{stem(part.message)}_t"
    return {"name": name, "type": type, "about": comment(said), "copies": copies}


def part_name(part: MessageDescription) -> str:
    """How the name of the function ends."""
    return f"part_{part.name}"


def headers(message: MessageDescription) -> list[str]:
    """The headers of the parts."""
    found = (part.message for part in contained_messages(message))
    return [f"{one.name}.h" if one.node is message.node else f"../{one.node.name}/{one.name}.h" for one in found]


def _statements(copied: CopiedMember) -> Iterator[str]:
    member = copied.member
    if copied.is_whole and (member.count or member.model.is_bytes):
        whole = f"part->{member.member}"
        yield call("(void)memcpy", (whole, f"message->{copied.sources[0].member}", f"sizeof {whole}"))
        return
    for one, twin in zip(member.elements, copied.sources, strict=True):
        target, source = f"part->{one.member}", f"message->{twin.member}"
        is_bytes = one.model.is_bytes
        yield call("(void)memcpy", (target, source, f"sizeof {target}")) if is_bytes else f"{target} = {source};"
