"""Faults of DBC files that cantools refuses the whole file for: what they spoil is left out, and the rest is read."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

from icdgen.definitions.model import Definitions

NOT_UNDERSTOOD = "IMP075"
REPAIRED = "IMP076"
MOST = 50  # faults of one file

_EXTENDED = 0x80000000
_WITH_ID = re.compile(
    r'^(\s*(?:BO_|BO_TX_BU_|VAL_|SIG_VALTYPE_|SIG_GROUP_|SG_MUL_VAL_|CM_\s+(?:BO_|SG_)|BA_\s+"[^"\n]*"\s+(?:BO_|SG_))\s+)(\d+)\b',
    re.MULTILINE,
)
_MESSAGE = re.compile(r"\s*BO_\s+(\d+)\s+(\w+)")
_NO_MESSAGE = 0xC0000000  # stands for signals that are in no message
_SYNTAX = re.compile(r"Invalid syntax at line (\d+), column (\d+)")
_UNUSED = re.compile(r'^\s*(VAL_|SIG_VALTYPE_) (\d+) (\w+)"?$', re.MULTILINE)
_STATEMENT = re.compile(r"\s*[A-Z][A-Z_]*_\b")


def mended(text: str, load: Callable[[str], Any], to: Definitions) -> Any:
    """What ``load`` makes of the text without its faults. Raises what it raises for one that is none of those known."""
    text = _without_impossible(_widened(text, to), to)
    for _ in range(MOST):
        try:
            return load(text)
        except Exception as error:  # of its own for some, of its parser for others
            said = str(error)
            repaired = _without_line(text, said, to) or _without_unused(text, said, to)
            if repaired is None:
                raise
            text = repaired
    return load(text)


def _widened(text: str, to: Definitions) -> str:
    """Ids that a standard frame cannot have become those of extended frames, which have a bit more in front."""
    told = set()

    def widen(found: re.Match[str]) -> str:
        id = int(found[2])
        if not 0x7FF < id < 1 << 29:
            return found[0]
        if id not in told and found[1].strip() == "BO_":
            told.add(id)
            line = text.count("\n", 0, found.start(2)) + 1
            message = f"the id {id:#x} has more than the 11 bits of a standard frame"
            help = "it is held as that of an extended frame, whose ids have bit 31 set in a DBC"
            to.warn(REPAIRED, message, help, line=line)
        return f"{found[1]}{id | _EXTENDED}"

    return _WITH_ID.sub(widen, text)


def _without_impossible(text: str, to: Definitions) -> str:
    """The text without messages whose ids no frame has; what else is said of them has no signal then."""
    lines = text.split("\n")
    for number, line in enumerate(lines):
        found = _MESSAGE.match(line)
        if found is None or int(found[1]) == _NO_MESSAGE or int(found[1]) & ~_EXTENDED < 1 << 29:
            continue
        to.total += 1
        to.left_out(found[2], f"its id is {int(found[1]):#x}, which no frame has", number + 1)
        lines[number : _end(lines, number)] = [""] * (_end(lines, number) - number)
    return "\n".join(lines)


def _end(lines: list[str], number: int) -> int:
    """The line behind a message, or another statement."""
    end = number + 1
    while lines[number].lstrip().startswith("BO_ ") and end < len(lines) and lines[end].lstrip().startswith("SG_"):
        end += 1
    return end


def _without_line(text: str, said: str, to: Definitions) -> str | None:
    """The text without the line that is not understood, of a message with its signals."""
    found = _SYNTAX.search(said)
    if found is None:
        return None
    lines = text.split("\n")
    number, column = int(found[1]) - 1, int(found[2])
    if number >= len(lines):
        return None
    if column == 1 + len(lines[number]) - len(lines[number].lstrip()) and _STATEMENT.match(lines[number]):
        before = next((at for at in range(number - 1, -1, -1) if lines[at].strip()), None)
        if before is None:
            return None
        number = before  # it did not end
    end = _end(lines, number)
    shown = lines[number].strip()
    shown = shown if len(shown) <= 80 else shown[:77] + "..."
    more = f", nor are the {end - number - 1} signals below it" if end - number > 1 else ""
    what = f"`{shown}` is not understood{more}"
    to.warn(NOT_UNDERSTOOD, what, "it is left out: correct the line", "error", number + 1)
    lines[number:end] = [""] * (end - number)
    return "\n".join(lines)


def _without_unused(text: str, said: str, to: Definitions) -> str | None:
    """The text without what is said of signals that there are not."""
    for keyword, id, name in _UNUSED.findall(said):
        statement = rf'^[ \t]*{keyword}\s+{id}\s+{re.escape(name)}\s[^";]*(?:"[^"]*"[^";]*)*;'
        found = re.search(statement, text, re.MULTILINE)
        if found is None:
            return None
        line = text.count("\n", 0, found.start()) + 1
        message = f"`{keyword}` names `{name}` of message {id}, which has no such signal"
        to.warn(REPAIRED, message, "it is left out", line=line)
        text = text[: found.start()] + "\n" * found[0].count("\n") + text[found.end() :]
    return text if _UNUSED.search(said) else None
