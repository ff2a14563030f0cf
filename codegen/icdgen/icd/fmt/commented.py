"""Tree of the formatter: values with their spelling and the comments that belong to
them.
"""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass(frozen=True, slots=True)
class ScalarText:
    """A scalar."""

    value: object  # as the loader reads it
    spelling: str  # in the file; the formatter preserves it for numbers


# Value of a key before it is read; key of an item of a sequence.
NOTHING = ScalarText(None, "")


@dataclass(slots=True)
class Child:
    """An entry of a mapping or, with the key `NOTHING`, an item of a sequence.

    In lists of comments, "" is a blank line.
    """

    key: ScalarText
    value: ScalarText | Branch = NOTHING
    before: list[str] = field(default_factory=list)  # comments on the lines above
    trailing: list[str] = field(default_factory=list)  # comments at the end of its line


@dataclass(slots=True)
class Branch:
    """A mapping or a sequence."""

    mapping: bool
    flow: bool  # written with braces or brackets
    column: int  # of its entries in block style, from 0
    children: list[Child] = field(default_factory=list)
    tail: list[str] = field(default_factory=list)  # comments after the last child
    # Of the root only: comments about the file.
    header: list[str] = field(default_factory=list)

    def commented(self) -> bool:
        """Return whether there is a comment in it, at any depth."""
        return bool(self.comments())

    def comments(self) -> list[str]:
        """Return all comments in it, at any depth, in order."""
        comments: list[str] = []
        for child in self.children:
            comments += child.before
            if isinstance(child.value, Branch):
                comments += child.value.comments()
            comments += child.trailing
        return [comment for comment in (*comments, *self.tail) if comment]
