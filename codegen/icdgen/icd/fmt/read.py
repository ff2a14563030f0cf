"""Reader of YAML text with comments, for the formatter.

`read_commented` returns the tree of `icdgen.icd.fmt.commented`. PyYAML's events omit
comments, so the reader searches the text between events.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from icdgen.icd import source
from icdgen.icd.fmt.commented import NOTHING, Branch, Child, ScalarText
from icdgen.icd.located import Map, Seq
from icdgen.icd.source import Event

SCHEMA_LINE = "# yaml-language-server:"
# YAML 1.1, which PyYAML implements, has more line breaks than CR and LF.
_BREAK = re.compile("\r\n|[\n\r\x85\u2028\u2029]")
_BLOCK = ("|", ">")
# A `#` within a plain scalar is text. Unlike YAML, PyYAML accepts a comment directly
# after an indicator of a flow collection, without a space.
_BEFORE_COMMENT = " \t\ufeff,[]{}\n\r\x85\u2028\u2029"


def read_commented(text: str, values: Map) -> Branch:
    """Return the tree of a text.

    ``values`` is the result of `source.parse` for the same text.
    """
    return _CommentReader(text, values).read_tree()


def comments(text: str) -> list[str]:
    """Return all comments of a text that `source.parse` accepts.

    It does not use the tree, so that `icdgen fmt` can check that the tree has lost no
    comment.
    """
    from yaml import events

    result: list[str] = []
    reached = 0
    parser = source.event_parser(text, "")
    while True:
        event = parser.get_event()
        kind, start = type(event), event.start_mark.index
        result += [text[at:end] for at, end in _comments_in(text, reached, start)]
        reached = max(reached, start)
        if kind is events.ScalarEvent:
            result += _header_comment(text, event) if event.style in _BLOCK else []
            reached = max(reached, event.end_mark.index)
        elif kind is events.StreamEndEvent:
            return [comment.rstrip() for comment in result]


class _CommentReader:
    """Builds the tree in one pass over the events, and assigns the comments before each
    event to the tree.
    """

    def __init__(self, text: str, values: Map) -> None:
        self.text = text
        self.values = _scalars(values)
        self.root = Branch(True, False, 0)
        self.stack: list[Branch] = []
        self.pending: list[str] = []  # comments for the next element
        self.reached = 0  # the text before this index is processed
        self.last: Child | None = None  # the element or key that ends at ``last_end``
        self.last_end = 0
        self.comment_end = 0

    def read_tree(self) -> Branch:
        """Return the tree."""
        from yaml import events

        steps = {
            events.ScalarEvent: self.scalar,
            events.MappingStartEvent: self.open,
            events.SequenceStartEvent: self.open,
            events.MappingEndEvent: self.close,
            events.SequenceEndEvent: self.close,
        }
        parser = source.event_parser(self.text, "")
        while True:
            event = parser.get_event()
            kind = type(event)
            start = event.start_mark.index
            if "#" in self.text[self.reached : start]:
                self.gap(
                    event, kind in (events.MappingEndEvent, events.SequenceEndEvent)
                )
            self.reached = max(self.reached, start)
            if kind in steps:
                steps[kind](event)
            elif kind is events.StreamEndEvent:
                self.root.tail += self.pending
                return self.root

    # Elements

    def scalar(self, event: Event) -> None:
        """Add a key, a value or an item."""
        top = self.stack[-1]
        key = top.mapping and (
            not top.children or top.children[-1].value is not NOTHING
        )
        value = event.value if key else next(self.values)
        if key and not event.style:
            value = None  # the writer interprets an unquoted key from its spelling
        text = ScalarText(value, event.value)
        if key:
            child = Child(text)
            self.begin(child)
        else:
            child = self.attach(text)
        end = event.end_mark.index
        # The end mark of a block scalar is at the start of the next line; use the end
        # of the line before.
        if event.style in _BLOCK:
            child.trailing += _header_comment(self.text, event)
            breaks = _BREAK.finditer(self.text, event.start_mark.index, end)
            end = max((match.start() for match in breaks), default=end)
        self.reached = max(self.reached, end)
        self.last, self.last_end = child, end

    def open(self, event: Event) -> None:
        """Begin a mapping or sequence."""
        from yaml.events import MappingStartEvent

        branch = Branch(
            isinstance(event, MappingStartEvent),
            bool(event.flow_style),
            event.start_mark.column,
        )
        if not self.stack:
            self.root = branch
        else:
            self.attach(branch)
        self.stack.append(branch)
        self.reached = max(self.reached, event.end_mark.index)
        if branch.flow:
            self.last, self.last_end = None, event.end_mark.index

    def close(self, event: Event) -> None:
        """End a mapping or sequence."""
        branch = self.stack.pop()
        if not branch.flow:
            return
        branch.tail += self.take()
        self.reached = max(self.reached, event.end_mark.index)
        self.last = self.stack[-1].children[-1] if self.stack else None
        self.last_end = event.end_mark.index

    def attach(self, value: ScalarText | Branch) -> Child:
        """Add a value to the innermost branch: to its last key, or as an item.

        Return the entry or item.
        """
        top = self.stack[-1]
        if top.mapping:
            child = top.children[-1]
            child.value = value
            if isinstance(value, ScalarText) or value.flow:
                child.before += self.take()
        else:
            child = Child(NOTHING, value)
            self.begin(child)
        return child

    def begin(self, child: Child) -> None:
        """Add an entry or item to the innermost branch, with the pending comments."""
        top = self.stack[-1]
        child.before = self.take()
        if top is self.root and not top.children:
            self.split_header(child)
        top.children.append(child)

    def take(self) -> list[str]:
        """Return the pending comments, and clear them."""
        taken, self.pending = self.pending, []
        return taken

    def split_header(self, first: Child) -> None:
        """Move comments about the file to the header: those before the last blank line,
        and the schema line.
        """
        lines = first.before
        if lines and self.breaks(self.comment_end, self.reached) > 1:
            lines.append("")
        cut = len(lines) - lines[::-1].index("") if "" in lines else 0
        schema = [line for line in lines if line.startswith(SCHEMA_LINE)]
        header = [line for line in lines[:cut] if not line.startswith(SCHEMA_LINE)]
        first.before = [
            line for line in lines[cut:] if not line.startswith(SCHEMA_LINE)
        ]
        self.root.header = schema + _paragraphs(header)

    # Comments

    def gap(self, event: Event, closing: bool) -> None:
        """Assign the comments between ``reached`` and an event to elements of the tree."""
        closing = closing and not self.stack[-1].flow
        previous_end = self.reached
        # Column of the container that the previous comment was assigned to.
        limit = None
        earlier: list[str] | None = None
        for start, end in _comments_in(self.text, self.reached, event.start_mark.index):
            breaks = self.breaks(previous_end, start)
            target = self.pending
            # A comment on the line of an element belongs to that element.
            if (
                breaks == 0
                and previous_end == self.reached
                and self.last is not None
                and not self.breaks(self.last_end, start)
            ):
                target = self.last.trailing
            # After the last entry of a container, the column decides whether a comment
            # belongs to the container or follows it.
            elif breaks and closing and not self.pending:
                column = start - _line_start(self.text, previous_end, start)
                holder = self.holder(
                    column if limit is None else min(column, limit),
                    event.start_mark.column,
                )
                if holder is not None:
                    target, limit = holder.tail, holder.column
            # Preserve one blank line between two comments of the same element.
            if breaks > 1 and target is earlier:
                target.append("")
            target.append(self.text[start:end].rstrip())
            earlier, previous_end = target, end
        self.comment_end = previous_end

    def breaks(self, start: int, end: int) -> int:
        """Return the number of line breaks in a range of the text."""
        return sum(1 for _ in _BREAK.finditer(self.text, start, end))

    def holder(self, column: int, following: int) -> Branch | None:
        """Return the innermost container that ends before the next element and contains
        a comment in this column.
        """
        for branch in reversed(self.stack):
            if branch.column <= following:
                return None
            if branch.column <= column:
                return branch
        return None


def _comments_in(text: str, at: int, end: int) -> Iterator[tuple[int, int]]:
    """Yield start and end of each comment in a range of the text without scalars."""
    while (at := text.find("#", at, end)) >= 0:
        if at and text[at - 1] not in _BEFORE_COMMENT:
            at += 1
            continue
        stop = _line_end(text, at)
        yield at, stop
        at = stop


def _header_comment(text: str, event: Event) -> list[str]:
    """Return a list with the comment after the ``|`` or ``>`` of a block scalar; an
    empty list without a comment.
    """
    at = event.start_mark.index
    header = text[at : _line_end(text, at)]
    return [header[header.index("#") :].rstrip()] if "#" in header else []


def _line_start(text: str, at: int, end: int) -> int:
    """Return the start of the line of ``end``, or ``at`` if the line begins before it."""
    return max((match.end() for match in _BREAK.finditer(text, at, end)), default=at)


def _line_end(text: str, at: int) -> int:
    """Return the end of the line of ``at``, without the line break."""
    match = _BREAK.search(text, at)
    return match.start() if match else len(text)


def _paragraphs(lines: list[str]) -> list[str]:
    """Return lines without blank lines at the start and the end, and with at most one
    blank line in a row.
    """
    result: list[str] = []
    for line in lines:
        if line or (result and result[-1]):
            result.append(line)
    return result[:-1] if result and not result[-1] else result


def _scalars(value: object) -> Iterator[object]:
    """Yield the scalar values of a tree in the order of the file."""
    if isinstance(value, Map):
        for item in value.values():
            yield from _scalars(item)
    elif isinstance(value, Seq):
        for item in value:
            yield from _scalars(item)
    else:
        yield value
