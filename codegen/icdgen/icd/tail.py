"""What is open in the messages of a model: a part of which a frame need not have all."""

from __future__ import annotations

from icdgen.frozen import dataclass


@dataclass(frozen=True, slots=True)
class Tail:
    """An open part of a message, whose frames differ in length: an array, bytes or text, of which there is not always all.

    Elements that are not in a frame are 0 in what it is decoded to.
    """

    name: str  # of the array, or of the field of bytes or text
    counter: str  # the field that says how many elements there are: one of the frame, or an implied one
    step: int  # bytes of an element
    most: int  # elements
    plus: int = 0  # there are so many more elements than the counter says
    begin: int = 0  # of one with another behind it: the byte at which it begins in the longest frame

    @property
    def fewest(self) -> int:
        """Elements that every frame has."""
        return max(0, self.plus)

    @property
    def low(self) -> int:
        """The smallest value of the counter."""
        return max(0, -self.plus)

    @property
    def high(self) -> int:
        """The largest value of the counter."""
        return self.most - self.plus
