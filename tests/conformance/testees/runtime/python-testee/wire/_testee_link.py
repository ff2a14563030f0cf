"""Reads requests of the testee about the wire layer."""

from __future__ import annotations

import re
from importlib import import_module
from typing import TYPE_CHECKING, Any

from .. import NODES
from .._lazy import Messages
from ._testee_order import ORDER
from .errors import UnsupportedError
from .link import Link, Settings

if TYPE_CHECKING:
    Request = dict[str, Any]

_HEX = re.compile("(?:[0-9A-Fa-f]{2})*")


class Refusal(Exception):
    """An answer that is not ``ok``."""

    def __init__(self, error: str, **more: object) -> None:
        super().__init__(error)
        self.answer: dict[str, Any] = {"ok": False, "error": error, **more}


def link_of(request: Request) -> Link:
    """The link of the node that is named; without a name, of the last that has one."""
    if "node" in request:
        name = text(request, "node")
        if name not in NODES:
            raise Refusal("unknown-node")
        found = _link(name)
        return _nothing(name) if found is None else found
    for name in reversed(ORDER):
        found = _link(name)
        if found is not None:
            return found
    raise UnsupportedError("no node has a protocol")


def _link(name: str) -> Link | None:
    node = import_module(f"..{name}", __package__)
    return getattr(node, "LINK", None)


def _nothing(name: str) -> Link:
    """What is known of a node without a protocol."""
    none = Messages({}, name, "message", {})
    return Link(
        node=name,
        order="little",
        node_type=None,
        interface_version=None,
        longest=1 << 16,
        longest_data=1 << 16,
        telemetry_ids=(128, 255),
        settings=Settings(1000, 3, 20, 5000),
        errors={},
        commands={},
        frames={},
        TELECOMMANDS=none,
        TELEMETRY=none,
    )


def number(
    request: Request,
    key: str,
    least: int = 0,
    most: int = (1 << 32) - 1,
    default: int | None = None,
) -> int:
    """An integer; it may be missing if there is a default."""
    value = request.get(key, default)
    if type(value) is not int or not least <= value <= most:
        raise Refusal("request", detail=f"`{key}` is no number from {least} to {most}")
    return value


def text(request: Request, key: str) -> str:
    value = request.get(key)
    if not isinstance(value, str):
        raise Refusal("request", detail=f"`{key}` is no text")
    return value


def octets(request: Request, key: str = "bytes") -> bytes:
    return hex_bytes(request.get(key))


def hex_bytes(value: object) -> bytes:
    if not isinstance(value, str) or not _HEX.fullmatch(value):
        raise Refusal("request", detail="these are not hex digits")
    return bytes.fromhex(value)


def flag(request: Request, key: str) -> bool:
    """A truth value, false if it is missing."""
    value = request.get(key, False)
    if type(value) is not bool:
        raise Refusal("request", detail=f"`{key}` is neither true nor false")
    return value


def rows(request: Request, key: str) -> list[Any]:
    value = request.get(key)
    if not isinstance(value, list):
        raise Refusal("request", detail=f"`{key}` is no list")
    return value


def mappings(request: Request, key: str) -> list[dict[str, Any]]:
    found = rows(request, key)
    if not all(isinstance(row, dict) for row in found):
        raise Refusal("request", detail=f"`{key}` has a row that is no object")
    return found
