"""The tree that the formatter works on: values as they were spelled, and the comments that belong to each."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass(frozen=True, slots=True)
class Text:
    """A scalar. ``value`` is what the loader reads, ``spelling`` how the file has it (of interest for numbers)."""

    value: object
    spelling: str


NOTHING = Text(None, "")  # the value of a key that has none yet, the key of an item


@dataclass(slots=True)
class Child:
    """An entry of a mapping or, with `NOTHING` for a key, an item of a sequence. Among comments "" is a blank line."""

    key: Text
    value: Text | Branch = NOTHING
    before: list[str] = field(default_factory=list)  # comments on lines of their own above it
    trailing: list[str] = field(default_factory=list)  # comments behind it on its line


@dataclass(slots=True)
class Branch:
    """A mapping or a sequence."""

    mapping: bool
    flow: bool  # written with braces or brackets
    column: int  # where its entries begin, if not flow; counts from 0
    children: list[Child] = field(default_factory=list)
    tail: list[str] = field(default_factory=list)  # comments after the last child
    header: list[str] = field(default_factory=list)  # of the root only: comments about the whole file

    def commented(self) -> bool:
        """Whether a comment stands anywhere inside."""
        return bool(self.comments())

    def comments(self) -> list[str]:
        """All comments inside, in order."""
        found: list[str] = []
        for child in self.children:
            found += child.before
            if isinstance(child.value, Branch):
                found += child.value.comments()
            found += child.trailing
        return [comment for comment in (*found, *self.tail) if comment]
