"""Ids of the messages of a node, and errors for messages that it does not have."""

from __future__ import annotations

from typing import Any, Protocol, TypeVar, cast

from .._base import Message
from .._errors import UnknownIdError
from .._hints import N
from .link import Link
from .packet_formats import Direction

M = TypeVar("M", bound=Message)
M2 = TypeVar("M2", bound=Message)
M3 = TypeVar("M3", bound=Message)
M_co = TypeVar("M_co", covariant=True)
N_contra = TypeVar("N_contra", contravariant=True)


class NodeMessage(Protocol[N_contra]):
    """A message of a node, or of a node that it includes."""

    def to_bytes(self) -> bytes: ...

    def _belongs_to(self, node: N_contra, /) -> None: ...


class NodeMessageClass(Protocol[N_contra, M_co]):
    """The class of a message of a node."""

    def __call__(self) -> object: ...

    def _instance(self) -> M_co: ...

    def _belongs_to(self, node: N_contra, /) -> None: ...


def class_of(message: NodeMessageClass[Any, M]) -> type[M]:
    """Return the argument with the type of a message class."""
    return cast("type[M]", message)


def message_of(message: NodeMessage[Any]) -> Message:
    """Return the argument with the type of a message."""
    return cast("Message", message)


def requested_id(link: Link[N], message: NodeMessageClass[N, Message]) -> int:
    """Return the id of telemetry, or of a setting to read.

    Raise `UnknownIdError`, and `TypeError` for a message instead of its class.
    """
    kind = class_of(message)
    if isinstance(kind, Message):
        name = type(kind).__name__
        raise TypeError(f"what is requested is a class: {name}, not {name}(...)")
    return message_id(link, "telemetry", kind)


def sent_id(link: Link[N], message: NodeMessage[N]) -> int:
    """Return the id of a telecommand, or of a setting.

    Raise `UnknownIdError`, and `TypeError` for a class instead of a message.
    """
    instance = message_of(message)
    if isinstance(instance, type):
        raise TypeError(
            f"what is sent is a message: {instance.__name__}(...), not the class"
        )
    return message_id(link, "telecommand", type(instance))


def message_id(link: Link[N], direction: Direction, kind: type[Message]) -> int:
    """Return the id of a message in a direction. Raise `UnknownIdError`."""
    ways = {"telecommand": link.TELECOMMANDS, "telemetry": link.TELEMETRY}
    for id in kind.IDS:
        if id in ways[direction] and kind in ways[direction].of(id):
            return id
    why = f"it is a message of {kind.NODE}" if kind.NODE != link.node else ""
    uses = {
        "telecommand": "a telecommand: send it",
        "telemetry": "telemetry: request it",
    }
    for way, messages in ways.items():
        if any(id in messages and kind in messages.of(id) for id in kind.IDS):
            why = f"it is {uses[way]}"
    raise UnknownIdError(link.node, direction, kind.NAME, why)
