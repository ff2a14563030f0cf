"""The JavaScript testee: a program for Node that answers the requests of the conformance run about the codec of the site.

The codec is the very file that the pages load, and the plans are those that they hold.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import PurePosixPath

from icdgen.backends import Identifier
from icdgen.backends.html.plan import enum_plan, message_plan
from icdgen.icd.model import Icd, Message, Node
from icdgen.render import Renderer
from tests.conformance.testees import RUNTIME, TEMPLATES


class JsTesteeBackend:
    """A program for Node, and the plans of the pages."""

    name = "js-testee"
    reserved: frozenset[str] = frozenset()
    templates = TEMPLATES / name
    runtime = RUNTIME / name

    def files(self, icd: Icd, render) -> Iterator[tuple[PurePosixPath, str]]:
        """``testee.js`` and what it needs."""
        yield PurePosixPath("codec.js"), Renderer("html")("codec.js")
        for name in ("json.js", "testee.js"):
            yield PurePosixPath(name), render(name)
        nodes = [_node(icd, node) for node in icd.nodes]
        yield PurePosixPath("nodes.json"), json.dumps(nodes, separators=(",", ":")) + "\n"

    def identifiers(self, icd: Icd) -> Iterator[Identifier]:
        """None: JSON strings may hold any name."""
        return iter(())


def _node(icd: Icd, node: Node) -> dict[str, object]:
    return {
        "name": node.name,
        "node_type": node.node_type,
        "interface_version": node.interface_version,
        "speaks": [one.name for one in (*icd.included(node), node)],
        "enums": [[enum.name, enum_plan(enum)] for enum in node.enums],
        "messages": [_message(message, node) for message in node.messages],
    }


def _message(message: Message, node: Node) -> dict[str, object]:
    ways = {
        "telecommand": message.telecommand_id,
        "telemetry": message.telemetry_id,
        "set": message.set_id,
        "get": message.get_id,
    }
    present = {way: id for way, id in ways.items() if id is not None}
    return message_plan(message, node) | {"ids": list(message.ids), "ways": present}
