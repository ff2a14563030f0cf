"""Functions that return the messages contained in a composite message.

The statements copy members of the composite into the struct of the contained message;
see `icdgen.describe.contained`.
"""

from __future__ import annotations

from collections.abc import Iterator

from icdgen.backends.c.statement import call
from icdgen.backends.c.text import comment
from icdgen.describe import MessageDescription
from icdgen.describe.comments import part_comment
from icdgen.describe.contained import ContainedDescription, CopiedMember


def part_about(part: ContainedDescription) -> str:
    """Return the comment of the function that returns a contained message."""
    paragraphs = [part_comment(part.message.model, part.positions)]
    if len(part.positions) > 1:
        paragraphs.append(
            f"ICD_ERROR_RANGE, and `part` as it was, if there is no such part: they are 0 to {len(part.positions) - 1}."
        )
    return comment(paragraphs)


def part_statements(
    message: MessageDescription, part: ContainedDescription, begin: int
) -> list[str]:
    """Return the statements that copy a contained message at bit ``begin``."""
    copies = part.copies(message, begin)
    return [line for copied in copies for line in _copy_statements(copied)]


def _copy_statements(copied: CopiedMember) -> Iterator[str]:
    member = copied.member
    # Arrays cannot be assigned in C (C99 6.5.16).
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
