"""The functions that give the messages which a composite message repeats."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from icdgen.backends.c.names import stem
from icdgen.backends.c.statement import call
from icdgen.backends.c.text import comment
from icdgen.describe import MessageDescription
from icdgen.describe.comments import part_comment
from icdgen.describe.parts import Copied, parts_of


class Part(NamedTuple):
    """A function that gives a part; ``copies`` are its statements, once for each time that the message is repeated."""

    name: str
    type: str
    about: str
    copies: tuple[tuple[str, ...], ...]


def parts(message: MessageDescription) -> list[Part]:
    """Those of a composite message."""
    found = []
    for one in parts_of(message):
        said = [part_comment(one.message.model, one.begins)]
        if len(one.begins) > 1:
            said.append(
                f"ICD_ERROR_RANGE, and `part` as it was, if there is no such part: they are 0 to {len(one.begins) - 1}."
            )
        copies = tuple(
            tuple(line for copied in one.copies(message, begin) for line in _statements(copied)) for begin in one.begins
        )
        found.append(Part(part_name(one.message), f"{stem(one.message)}_t", comment(said), copies))
    return found


def part_name(part: MessageDescription) -> str:
    """How the name of the function ends."""
    return f"part_{part.name}"


def headers(message: MessageDescription) -> list[str]:
    """The headers of the parts."""
    found = (part.message for part in parts_of(message))
    return [f"{one.name}.h" if one.node is message.node else f"../{one.node.name}/{one.name}.h" for one in found]


def _statements(copied: Copied) -> Iterator[str]:
    member = copied.member
    if copied.is_whole and (member.count or member.model.is_bytes):
        whole = f"part->{member.member}"
        yield call("(void)memcpy", (whole, f"message->{copied.twins[0].member}", f"sizeof {whole}"))
        return
    for one, twin in zip(member.elements or (member,), copied.twins, strict=True):
        target, source = f"part->{one.member}", f"message->{twin.member}"
        is_bytes = one.model.is_bytes
        yield call("(void)memcpy", (target, source, f"sizeof {target}")) if is_bytes else f"{target} = {source};"
