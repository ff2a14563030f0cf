"""What all outputs know of the open end of a message."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from icdgen.describe.description import FieldDescription, StructDescription


class TailDescription(NamedTuple):
    """The open end of a message: see `icdgen.icd.model.Tail`."""

    part: FieldDescription  # the array as one, or the bytes or text
    counter: FieldDescription  # how many elements there are; implied, or a field of the frame
    least: int  # bytes of a frame without any element
    step: int  # bytes of an element
    most: int  # elements
    element: (
        StructDescription | None
    )  # what an element is made of, where that is a struct, in the orders that hold here

    @property
    def is_bound(self) -> bool:
        """Whether the integer that holds the count holds larger ones than there can be."""
        return self.counter.storage.max > self.most
