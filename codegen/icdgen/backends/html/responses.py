"""Responses to telecommands on framed links, for the pages of the protocol and of
messages.

Input are the keys ``commands``, ``requests`` and ``response`` of the ICD; output are
rows with names, links and phrases. `sequences` draws the same rows.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from icdgen.backends.html.all_facts import FactRow
from icdgen.backends.html.packets import packet_urls
from icdgen.backends.html.relations import PageLink, Relations
from icdgen.backends.html.texts import capitalized
from icdgen.frozen import NamedTuple
from icdgen.icd.model import Message, Node, framed_link
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
from icdgen.protocol import facts

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
    "checksum": "wrong checksum: it is sent again at once",
    "busy": "another telecommand is being executed",
}
_MOST_NAMES = 6  # telecommands that the page of a response lists


class ResponseRow(NamedTuple):
    """Response to telecommands or requests: the telemetry or packet, its meaning, and
    its fields.
    """

    kind: str  # one of `icdgen.icd.responses.KINDS`
    name: str
    url: str
    about: str
    echo: str
    judges: str  # status values and reason
    has_status: bool


class RequestRow(NamedTuple):
    """Requests of telemetry by a packet with its id."""

    packet: PageLink  # empty text if the link has one packet format
    response: PageLink | None  # packet that carries the telemetry without its id
    messages: list[PageLink]
    rows: list[ResponseRow]
    timeout: str


class TelecommandRow(NamedTuple):
    """Telecommand with its responses."""

    name: str
    url: str
    rows: list[ResponseRow]
    timeout: str
    repeat: str


def of_node(relations: Relations, node: Node) -> dict[str, object]:
    """Return the template values of the responses of a node; empty without responses.

    They contain the responses to all telecommands, to each telecommand with its own
    responses, and to telemetry requests, and the possible reasons for a NAK.
    """
    requests = request_row(relations, node)
    commands = _commands(relations, node)
    rows = [
        _telecommand_row(relations, node, message)
        for message in _telecommands(relations, node)
        # Other telecommands have the general responses.
        if message.response is not None or message.repeat
    ]
    if not commands and not rows and not requests:
        return {}
    reasons: Mapping[str, str] = commands.get("reasons", {})
    return {
        "general": general_responses(relations, node),
        "telecommands": rows,
        "requests": requests,
        "reasons": [
            FactRow(capitalized(about), str(reasons[cause]))
            for cause, about in _CAUSES.items()
            if cause in reasons
        ],
    }


def general_responses(relations: Relations, node: Node) -> list[ResponseRow]:
    """Return the responses to all telecommands without other responses."""
    return _response_rows(relations, node, responses_in(_commands(relations, node)))


def request_row(relations: Relations, node: Node) -> RequestRow | None:
    """Return how telemetry is requested by its id; None if no packet does."""
    stream = facts.of(relations.icd, node).stream
    if stream is None or stream.request is None:
        return None
    section = relations.icd.protocol_of(node)["link"]["requests"]
    name = stream.packets[stream.request.packet].name
    urls = packet_urls(relations, node)
    response: str | None = section.get("response")
    ids = {row.id for row in stream.telemetry if row.is_requested}
    return RequestRow(
        PageLink(name, urls[name]),
        PageLink(response, urls[response]) if response else None,
        [
            relations.place(message)
            for message in relations.icd.messages_of(node)
            if message.telemetry_id in ids
        ],
        _response_rows(relations, node, responses_in(section)),
        _milliseconds(section.get("timeout_ms")),
    )


def of_message(
    relations: Relations, node: Node, message: Message
) -> Iterator[tuple[str, str, str]]:
    """Yield label, text and link of each fact about responses on the page of a message."""
    if not framed_link(relations.icd.protocol_of(node)):
        return
    if message.telecommand_id is not None:
        row = _telecommand_row(relations, node, message)
        yield from ((_LABELS[each.kind], each.name, each.url) for each in row.rows)
        if not row.rows:
            yield "Response", NONE, ""
        yield "Time-out", row.timeout, ""
        yield "May be repeated", row.repeat, ""
        return
    yield from _of_request(relations, node, message)
    page = relations.links.protocol(node.name) + "#responses"
    commands = _commands(relations, node)
    requests: dict[str, list[str]] = {}
    for telecommand in _telecommands(relations, node):
        for kind, response in declared_responses(commands, telecommand).items():
            if response.get("message") == message.name:
                requests.setdefault(kind, []).append(telecommand.name)
    for kind, names in requests.items():
        more = len(names) - _MOST_NAMES
        listed = ", ".join(names[:_MOST_NAMES]) + (
            f" and {more} more" if more > 0 else ""
        )
        yield "Response", f"{_ABOUT[kind]}: {listed}", page


def _of_request(
    relations: Relations, node: Node, message: Message
) -> Iterator[tuple[str, str, str]]:
    """Yield label, text and link of each fact about the request of telemetry."""
    request = request_row(relations, node)
    if request is None or relations.place(message) not in request.messages:
        return
    text = f"packet {request.packet.text} with its id" if request.packet.text else ""
    yield "Requested by", text or "a packet with its id", request.packet.url
    yield from ((_LABELS[each.kind], each.name, each.url) for each in request.rows)
    yield "Time-out", request.timeout, ""


def _milliseconds(timeout: int | None) -> str:
    return f"{timeout:,} ms" if timeout else ""


def _commands(relations: Relations, node: Node) -> Mapping[str, Any]:
    link = framed_link(relations.icd.protocol_of(node))
    commands: Mapping[str, Any] = link.get("commands", {})
    return commands


def _telecommands(relations: Relations, node: Node) -> list[Message]:
    messages = relations.icd.messages_of(node)
    return [message for message in messages if message.telecommand_id is not None]


def _telecommand_row(
    relations: Relations, node: Node, message: Message
) -> TelecommandRow:
    own = message.response
    timeout = own.get("timeout_ms") if isinstance(own, Mapping) else None
    declared = declared_responses(_commands(relations, node), message)
    return TelecommandRow(
        message.name,
        relations.links.message(message),
        _response_rows(relations, node, declared),
        _milliseconds(timeout),
        "yes" if message.repeat else "",
    )


def _response_rows(
    relations: Relations, node: Node, declared: Mapping[str, Mapping[str, Any]]
) -> list[ResponseRow]:
    places = {
        message.name: relations.place(message)
        for message in relations.icd.messages_of(node)
    }
    packets = packet_urls(relations, node) if declared else {}
    rows = []
    for kind, row in declared.items():
        place = (
            PageLink(f"packet {row['packet']}", packets[row["packet"]])
            if "packet" in row
            else places[row["message"]]
        )
        echo = ", ".join(
            f"{field} = {repeated}" for field, repeated in echoes_of(row).items()
        )
        about = f"{_ABOUT[kind]}, or refuses" if "status" in row else _ABOUT[kind]
        can_be_busy = kind == NAK and BUSY in row
        if can_be_busy:
            about = f"{about}, or {_ABOUT[BUSY]}"
        rows.append(
            ResponseRow(
                kind,
                place.text,
                place.url,
                about,
                echo,
                _judges(kind, row),
                "status" in row or can_be_busy,
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
    if kind == NAK and BUSY in row:
        names = ", ".join(map(str, row[BUSY]))
        texts.append(f"{names}: {_ABOUT[BUSY]}")
    if "reason" in row:
        texts.append(f"reason in {row['reason']}")
    return "; ".join(texts)
