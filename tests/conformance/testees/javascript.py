"""The JavaScript testee: a Node program that answers requests about the codec of the
site.

Codec and plans are the files that the pages load.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import PurePosixPath

from icdgen.backends import Identifier
from icdgen.backends.html.plan import enum_plan, message_plan
from icdgen.backends.html.recognition import message_numbers
from icdgen.icd.model import Icd, Message
from icdgen.icd.variants import ids_of
from icdgen.render import Renderer
from tests.conformance.testees import RUNTIME, TEMPLATES


class JsTesteeBackend:
    """A Node program and the plans of the pages."""

    name = "js-testee"
    reserved: frozenset[str] = frozenset()
    templates = TEMPLATES / name
    runtime = RUNTIME / name

    def files(self, icd: Icd, render) -> Iterator[tuple[PurePosixPath, str]]:
        """Return ``testee.js`` and the files that it needs."""
        for name in ("codec.js", "frames.js"):
            yield PurePosixPath(name), Renderer("html")(name)
        yield PurePosixPath("testee.js"), render("testee.js")
        yield (
            PurePosixPath("nodes.json"),
            json.dumps(_plans(icd), separators=(",", ":")) + "\n",
        )

    def identifiers(self, icd: Icd) -> Iterator[Identifier]:
        """Return no identifiers, because JSON strings can contain any name."""
        return iter(())


def _plans(icd: Icd) -> dict[str, object]:
    """Return the plans of all messages, and per node its enumerations and messages by
    id and direction.
    """
    places = {
        (message.node, message.name): place
        for place, message in enumerate(_messages(icd))
    }
    nodes = []
    for node in icd.nodes:
        ids = ids_of(icd, node)
        nodes.append(
            {
                "facts": {
                    "node_type": node.node_type,
                    "interface_version": node.interface_version,
                },
                "enums": [enum_plan(enum) for enum in node.enums],
                "ways": [
                    message_numbers(ids.telecommand, places),
                    message_numbers(ids.telemetry, places),
                ],
            }
        )
    declaring = {node.name: node for node in icd.nodes}
    plans = []
    for message in _messages(icd):
        plan = message_plan(message, declaring[message.node])
        enums = {
            field.enum.name: enum_plan(field.enum)
            for field in message.fields
            if field.enum
        }
        plans.append(plan | {"enums": enums, "ids": list(message.ids)})
    return {"messages": plans, "nodes": nodes}


def _messages(icd: Icd) -> Iterator[Message]:
    return (message for node in icd.nodes for message in node.messages)
