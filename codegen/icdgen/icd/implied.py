"""The count that only the length of a frame tells, as a field."""

from __future__ import annotations

from icdgen.icd.model import Field


def implied_count(end: Field, length: int) -> Field:
    """How many elements the open ``end`` of a message has, an array that stands as one, bytes or text.

    It is for frames whose longest has so many bytes, and no field that says it.
    """
    most, what = (end.count, "Count") if end.count else (end.bits // 8, "Size")
    return Field(
        name=f"{end.name} {what}",
        at=8 * length,
        bits=8 if most < 256 else 16,
        type="uint",
        identifier=f"{end.identifier} {what}" if end.identifier else None,
        implied=True,
        source=end.source,
    )
