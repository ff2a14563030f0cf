"""Repair of DBC files that cantools rejects completely.

The module removes invalid statements, so that cantools can read the remaining ones. It
also reports statements without a use (`account_for`). `can` has the reader.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Callable, Container, Iterator
from types import SimpleNamespace
from typing import Any

from icdgen.definitions.accounting import Account
from icdgen.definitions.model import Definitions
from icdgen.definitions.wording import line as one_line
from icdgen.frozen import NamedTuple

NOT_UNDERSTOOD = "IMP075"
REPAIRED = "IMP076"
MOST = 50  # faults of one file
_LONGEST_NAME = 400

_EXTENDED = 0x80000000  # bit 31 of an id in a DBC marks an extended frame
_WITH_ID = re.compile(
    r'^(\s*(?:BO_|BO_TX_BU_|VAL_|SIG_VALTYPE_|SIG_GROUP_|SG_MUL_VAL_|CM_\s+(?:BO_|SG_)|BA_\s+"[^"\n]*"\s+(?:BO_|SG_))\s+)(\d+)\b',
    re.MULTILINE,
)
_MESSAGE = re.compile(r"\s*BO_\s+(\d+)\s+(\w+)")
# VECTOR__INDEPENDENT_SIG_MSG: pseudo message for signals without a message
_NO_MESSAGE = 0xC0000000
_SYNTAX = re.compile(r"Invalid syntax at line (\d+), column (\d+)")
_UNUSED = re.compile(r'^\s*(VAL_|SIG_VALTYPE_) (\d+) (\w+)"?$', re.MULTILINE)
_STATEMENT = re.compile(r"\s*[A-Z][A-Z_]*_\b")


_STRING_OR_KEYWORD = re.compile(
    r'"(?:\\"|[^"])*"|^[ \t]*([A-Z][A-Z_]*)(?=[ \t]*[:"\w])', re.MULTILINE
)
_OF_MESSAGE = re.compile(r'[A-Z_]+\s+(?:"[^"]*"\s+)?(?:(?:BO_|SG_)\s+)?(\d+)\b')
_ATTRIBUTE = re.compile(
    r'BA_\s+"([^"]*)"\s*((?:BO_|SG_|BU_|EV_)[^"]*?)?\s*(?:"[^"]*"|[-+.\w]+)\s*;'
)
_COMMENT = re.compile(r"CM_\s+(\w*)")
# Statements that cantools and `can` use, or that only declare what others use.
_USED = frozenset(
    {
        "BO_", "SG_", "VAL_", "SIG_VALTYPE_", "SG_MUL_VAL_", "BO_TX_BU_", "BU_", "NS_", "BA_DEF_", "BA_DEF_DEF_",
        "BA_DEF_REL_", "BA_DEF_DEF_REL_", "BA_DEF_SGTYPE_", "BS_",
    }
)  # fmt: skip
_LONG_SIGNAL, _LONG_MESSAGE = "SystemSignalLongSymbol", "SystemMessageLongSymbol"
# The frame format follows from id and length; of the send type `can` accounts.
_USED_ATTRIBUTES = frozenset(
    {
        "GenMsgCycleTime",
        "GenSigStartValue",
        "GenMsgSendType",
        "SPN",
        "VFrameFormat",
        "SystemNodeLongSymbol",
    }
    | {_LONG_SIGNAL, _LONG_MESSAGE}
)
_HIDDEN_SUFFIX = " of a DBC"  # suffix for attributes that cantools must not interpret


class _Statement(NamedTuple):
    """Statement with its first line, counted from 1.

    Each signal is a separate statement.
    """

    keyword: str
    text: str
    line: int


def account_for(text: str, account: Account, reported: Container[int | None]) -> None:
    """Count unused statements and attributes of a DBC, except in lines of ``reported``,
    which have a finding.
    """
    for statement in _statements(text):
        if statement.line in reported:
            continue
        if statement.keyword == "BA_":
            match = _ATTRIBUTE.match(statement.text)
            if match is not None and match[1] not in _USED_ATTRIBUTES:
                account.add(
                    "BA_",
                    match[1],
                    f"`{' '.join(match[2].split())}`" if match[2] else "",
                    statement.line,
                )
        elif statement.keyword == "CM_":
            target = _COMMENT.match(statement.text)
            if target is not None and target[1] not in ("BO_", "SG_"):
                account.add(
                    "CM_", target[1] or "text of the network", "", statement.line
                )
        elif statement.keyword == "VERSION":
            if not re.match(r'VERSION\s*""', statement.text):
                account.add("", statement.keyword, "", statement.line)
        elif statement.keyword not in _USED:
            account.add("", statement.keyword, "", statement.line)


def _statements(text: str) -> Iterator[_Statement]:
    """Yield the statements of a DBC. Keywords within quotes are ignored."""
    begun: tuple[str, int] | None = None
    line, counted = 1, 0
    for match in _STRING_OR_KEYWORD.finditer(text):
        if match[1] is None:
            continue
        if begun is not None:
            yield _Statement(begun[0], text[begun[1] : match.start()], line)
        start = match.start(1)
        line += text.count("\n", counted, start)
        counted, begun = start, (match[1], start)
    if begun is not None:
        yield _Statement(begun[0], text[begun[1] :], line)


def with_short_names(text: str) -> str:
    """Return the text with the attributes for long names renamed, so that cantools does
    not interpret them.

    Otherwise cantools uses long names for signals but short names for their
    multiplexers.
    """
    for name in (_LONG_SIGNAL, _LONG_MESSAGE):
        text = text.replace(f'"{name}"', f'"{name}{_HIDDEN_SUFFIX}"')
    return text


def give_long_names(messages: list[Any]) -> None:
    """Rename messages and signals to the names in their long-name attributes, unless
    these are empty or duplicate.
    """
    names = {message.name for message in messages}
    for message in messages:
        taken = {signal.name for signal in message.signals}
        long = {
            signal.name: _long_name(signal, _LONG_SIGNAL, taken)
            for signal in message.signals
        }
        for signal in message.signals:
            signal.name = long[signal.name]
            if signal.multiplexer_signal is not None:
                signal.multiplexer_signal = long.get(
                    signal.multiplexer_signal, signal.multiplexer_signal
                )
        message.name = _long_name(message, _LONG_MESSAGE, names)
        # cantools has tables by name, which it built when it read the message.
        message.refresh(strict=False)


def _long_name(item: Any, attribute: str, taken: set[str]) -> str:
    """Return the long name, or the short name if there is no long name or it is already
    taken.
    """
    value = (
        item.dbc.attributes.get(attribute + _HIDDEN_SUFFIX)
        if item.dbc is not None and item.dbc.attributes
        else None
    )
    name = one_line(str(value.value), _LONGEST_NAME) if value is not None else ""
    if not name or name in taken:
        return str(item.name)
    taken.add(name)
    return name


def mended(text: str, load: Callable[[str], Any], to: Definitions) -> Any:
    """Return the result of ``load`` for the repaired text.

    Reports a last line that may be truncated.
    """
    database = _load_repaired(text, load, to)
    last = text.count("\n") + 1
    if text.rstrip(" \t")[-1:] not in ("\n", ";", "") and all(
        finding.spot.line != last for finding in to.import_findings
    ):
        what = f"the file ends within line {last}: `{one_line(text[text.rfind(chr(10)) + 1 :], 60)}`"
        to.warn(
            NOT_UNDERSTOOD,
            what,
            "check whether the file is complete: the rest may be cut off",
            "warning",
            last,
        )
    return database


def _load_repaired(text: str, load: Callable[[str], Any], to: Definitions) -> Any:
    """Return the result of ``load`` for the repaired text.

    Raises the exception of ``load`` if the fault cannot be repaired.
    """
    text = _without_invalid_ids(_with_extended_ids(text, to), to)
    try:
        for _ in range(MOST):
            try:
                return load(text)
            except Exception as error:  # cantools raises its own exceptions and exceptions of its parser
                reason = str(error)
                repaired = _without_line(text, reason, to) or _without_unused(
                    text, reason, to
                )
                if repaired is None:
                    raise
                text = repaired
        return load(text)
    except Exception as error:
        database = _message_by_message(text, load, to)
        if not database.messages:
            raise error from None
        return database


def _message_by_message(text: str, load: Callable[[str], Any], to: Definitions) -> Any:
    """Load each message separately with its attributes and comments, and return the
    messages that can be read.
    """
    # The last resort, because it parses the shared statements once per message: without
    # it, one faulty message would cost all others.
    shared, blocks = "", []
    of_message: defaultdict[str, str] = defaultdict(str)
    block: list[_Statement] = []
    for statement in _statements(text):
        if statement.keyword == "BO_":
            block = [statement]
            blocks.append(block)
        elif statement.keyword == "SG_" and blocks:
            block.append(statement)
        elif (match := _OF_MESSAGE.match(statement.text)) is not None:
            of_message[match[1]] += statement.text
        elif statement.keyword != "NS_":
            shared += statement.text
    messages: list[Any] = []
    for block in blocks:
        head = _MESSAGE.match(block[0].text)
        if head is None or int(head[1]) == _NO_MESSAGE:
            continue
        try:
            messages += load(
                shared
                + "".join(statement.text for statement in block)
                + of_message[head[1]]
            ).messages
        except Exception as error:
            to.total += 1
            to.left_out(
                head[2],
                one_line(str(error), 200) or type(error).__name__,
                block[0].line,
            )
    return SimpleNamespace(messages=messages)


def _with_extended_ids(text: str, to: Definitions) -> str:
    """Set the flag of extended frames (bit 31) in ids that exceed the 11 bits of a
    standard frame.
    """
    reported = set()

    def widen(match: re.Match[str]) -> str:
        id = int(match[2])
        if not 0x7FF < id < 1 << 29:
            return match[0]
        if id not in reported and match[1].strip() == "BO_":
            reported.add(id)
            line = text.count("\n", 0, match.start(2)) + 1
            message = f"the id {id:#x} has more than the 11 bits of a standard frame"
            help = "it is imported as an extended frame, whose ids have bit 31 set in a DBC"
            to.warn(REPAIRED, message, help, line=line)
        return f"{match[1]}{id | _EXTENDED}"

    return _WITH_ID.sub(widen, text)


def _without_invalid_ids(text: str, to: Definitions) -> str:
    """Return the text without messages whose id exceeds 29 bits."""
    lines = text.split("\n")
    for number, line in enumerate(lines):
        match = _MESSAGE.match(line)
        if (
            match is None
            or int(match[1]) == _NO_MESSAGE
            or int(match[1]) & ~_EXTENDED < 1 << 29
        ):
            continue
        to.total += 1
        to.left_out(
            match[2], f"its id is {int(match[1]):#x}, which no frame has", number + 1
        )
        lines[number : _end_of_statement(lines, number)] = [""] * (
            _end_of_statement(lines, number) - number
        )
    return "\n".join(lines)


def _end_of_statement(lines: list[str], number: int) -> int:
    """Return the index of the line after a message with its signals, or after another
    statement.
    """
    end = number + 1
    while (
        lines[number].lstrip().startswith("BO_ ")
        and end < len(lines)
        and lines[end].lstrip().startswith("SG_")
    ):
        end += 1
    return end


def _without_line(text: str, error: str, to: Definitions) -> str | None:
    """Return the text without the statement of a syntax error, or None if it cannot be
    located.

    ``error`` is the message of cantools.

    A message is removed together with its signals.
    """
    match = _SYNTAX.search(error)
    if match is None:
        return None
    lines = text.split("\n")
    number, column = int(match[1]) - 1, int(match[2])
    # The parser reached the end of the file.
    if number >= len(lines) or not "".join(lines[number:]).strip():
        number, column = (
            max((at for at, line in enumerate(lines) if line.strip()), default=0),
            0,
        )
    if column == 1 + len(lines[number]) - len(
        lines[number].lstrip()
    ) and _STATEMENT.match(lines[number]):
        before = next(
            (at for at in range(number - 1, -1, -1) if lines[at].strip()), None
        )
        if before is None:
            return None
        number = before  # the previous statement lacks its end
    end = _end_of_statement(lines, number)
    shown = lines[number].strip()
    shown = shown if len(shown) <= 80 else shown[:77] + "..."
    more = (
        f", nor are the {end - number - 1} signals below it" if end - number > 1 else ""
    )
    what = f"`{shown}` is not understood{more}"
    to.warn(
        NOT_UNDERSTOOD, what, "it is left out: correct the line", "error", number + 1
    )
    # Empty lines keep the line numbers of later findings.
    lines[number:end] = [""] * (end - number)
    return "\n".join(lines)


def _without_unused(text: str, error: str, to: Definitions) -> str | None:
    """Return the text without value statements about missing signals, or None if there
    is no such statement.
    """
    for keyword, id, name in _UNUSED.findall(error):
        statement = (
            rf'^[ \t]*{keyword}\s+{id}\s+{re.escape(name)}\s[^";]*(?:"[^"]*"[^";]*)*;'
        )
        match = re.search(statement, text, re.MULTILINE)
        if match is None:
            return None
        line = text.count("\n", 0, match.start()) + 1
        message = (
            f"`{keyword}` names `{name}` of message {id}, which has no such signal"
        )
        to.warn(REPAIRED, message, "it is left out", line=line)
        text = text[: match.start()] + "\n" * match[0].count("\n") + text[match.end() :]
    return text if _UNUSED.search(error) else None
