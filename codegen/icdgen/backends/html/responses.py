"""Responses to telecommands on framed links, for the pages of the protocol and of
messages.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

from icdgen.backends.html.all_facts import Row
from icdgen.backends.html.relations import Relations
from icdgen.backends.html.texts import capitalized
from icdgen.icd.model import Message, Node
from icdgen.icd.responses import (
    ACK,
    BUSY,
    NAK,
    NONE,
    PROGRESS,
    REPLY,
    declared_responses,
    echoes_of,
    responses_in,
)

_ABOUT = {
    ACK: "confirms",
    REPLY: "requested telemetry",
    NAK: "refuses",
    BUSY: "the device is busy",
    PROGRESS: "still being executed",
}
_LABELS = {
    ACK: "Confirmed by",
    REPLY: "Answered with",
    NAK: "Refused by",
    BUSY: "Busy device",
    PROGRESS: "In progress",
}
_CAUSES = {
    "unknown_id": "no such telecommand",
    "length": "wrong length",
    "value": "a value is not allowed",
    "checksum": "wrong checksum",
    "busy": "another telecommand is being executed",
}
_MOST_NAMES = 6  # telecommands that the page of a response lists


class ResponseRow(NamedTuple):
    """Response to telecommands: the telemetry, its meaning, and its fields."""

    kind: str  # one of `icdgen.icd.responses.KINDS`
    name: str
    url: str
    about: str
    echo: str
    judges: str  # status values and reason
    has_status: bool


class TelecommandRow(NamedTuple):
    """Telecommand with its responses."""

    name: str
    url: str
    rows: list[ResponseRow]
    timeout: str
    repeat: str


def of_node(relations: Relations, node: Node) -> dict[str, object]:
    """Return the responses of a node: those of all telecommands, those of each
    telecommand that differs, and the reasons of refusals. Empty without responses.
    """
    commands = _commands(relations, node)
    rows = [
        _telecommand(relations, node, message)
        for message in _telecommands(relations, node)
        if message.response is not None or message.repeat
    ]
    if not commands and not rows:
        return {}
    reasons: Mapping[str, str] = commands.get("reasons", {})
    return {
        "general": general(relations, node),
        "telecommands": rows,
        "reasons": [
            Row(capitalized(about), reasons[cause])
            for cause, about in _CAUSES.items()
            if cause in reasons
        ],
    }


def general(relations: Relations, node: Node) -> list[ResponseRow]:
    """Return the responses to all telecommands without other responses."""
    return _rows(relations, node, responses_in(_commands(relations, node)))


def of_message(
    relations: Relations, node: Node, message: Message
) -> Iterator[tuple[str, str, str]]:
    """Yield label, text and link of each fact about responses on the page of a message."""
    if "stream" not in relations.icd.protocol_of(node):
        return
    if message.telecommand_id is not None:
        row = _telecommand(relations, node, message)
        yield from ((_LABELS[each.kind], each.name, each.url) for each in row.rows)
        if not row.rows:
            yield "Response", NONE, ""
        yield "Time-out", row.timeout, ""
        yield "May be repeated", row.repeat, ""
        return
    page = relations.links.protocol(node.name) + "#responses"
    commands = _commands(relations, node)
    requests: dict[str, list[str]] = {}
    for telecommand in _telecommands(relations, node):
        for kind, response in declared_responses(commands, telecommand).items():
            if response["message"] == message.name:
                requests.setdefault(kind, []).append(telecommand.name)
    for kind, names in requests.items():
        more = len(names) - _MOST_NAMES
        listed = ", ".join(names[:_MOST_NAMES]) + (
            f" and {more} more" if more > 0 else ""
        )
        yield "Response", f"{_ABOUT[kind]}: {listed}", page


def _commands(relations: Relations, node: Node) -> Mapping[str, Any]:
    stream: Mapping[str, Any] = relations.icd.protocol_of(node).get("stream", {})
    commands: Mapping[str, Any] = stream.get("commands", {})
    return commands


def _telecommands(relations: Relations, node: Node) -> list[Message]:
    messages = relations.icd.messages_of(node)
    return [message for message in messages if message.telecommand_id is not None]


def _telecommand(relations: Relations, node: Node, message: Message) -> TelecommandRow:
    own = message.response
    timeout = own.get("timeout_ms") if isinstance(own, Mapping) else None
    declared = declared_responses(_commands(relations, node), message)
    return TelecommandRow(
        message.name,
        relations.links.message(message),
        _rows(relations, node, declared),
        f"{timeout:,} ms" if timeout else "",
        "yes" if message.repeat else "",
    )


def _rows(
    relations: Relations, node: Node, declared: Mapping[str, Mapping[str, Any]]
) -> list[ResponseRow]:
    messages = {message.name: message for message in relations.icd.messages_of(node)}
    rows = []
    for kind, row in declared.items():
        message = messages[row["message"]]
        echo = ", ".join(
            f"{field} = {repeated}" for field, repeated in echoes_of(row).items()
        )
        url = relations.links.message(message)
        about = f"{_ABOUT[kind]}, or refuses" if "status" in row else _ABOUT[kind]
        rows.append(
            ResponseRow(
                kind,
                message.name,
                url,
                about,
                echo,
                _judges(kind, row),
                "status" in row,
            )
        )
    return rows


def _judges(kind: str, row: Mapping[str, Any]) -> str:
    """Return the meaning of status and reason in words."""
    texts = []
    if "status" in row:
        words = {
            "success": _ABOUT[kind],
            "busy": _ABOUT[BUSY],
            "progress": _ABOUT[PROGRESS],
        }
        meanings = [
            f"{', '.join(map(str, row[key]))}: {text}"
            for key, text in words.items()
            if key in row
        ]
        texts.append(f"{row['status']}: {'; '.join([*meanings, 'otherwise: refuses'])}")
    if "reason" in row:
        texts.append(f"reason in {row['reason']}")
    return "; ".join(texts)
