"""Requests in JSON -> what the program is asked -> answers in JSON."""

from __future__ import annotations

import json
from typing import Any

from icdgen.runtime_objects.refusals import Refusal
from icdgen.runtime_objects.request_keys import text
from tests.conformance.front import messages, scripts, wire
from tests.conformance.front.program import Ask, Reply, asked

DIRECTIONS = {"telecommand": 0, "telemetry": 1}


class Front:
    """Answers requests for a set of ICDs, whose `plan` it is given, by asking a
    program.
    """

    def __init__(self, plan: dict[str, Any], ask: Ask) -> None:
        self.plan, self._ask = plan, ask
        self.nodes = {node["name"]: place for place, node in enumerate(plan["nodes"])}
        self._routes = [self._routes_of(node["speaks"]) for node in plan["nodes"]]

    def answer(self, line: bytes) -> dict[str, Any]:
        """The answer to a request, whatever it is.

        Raises `Died` if the program has none.
        """
        try:
            request = json.loads(line.decode("utf-8"))
            if not isinstance(request, dict):
                raise Refusal("request", detail="not a JSON object")
            op = text(request, "op")
            if op in messages.OPS:
                return {"ok": True, **messages.OPS[op](self, request)}
            if op in wire.OPS or op in scripts.OPS:
                return {"ok": True, **self._wire(op, request)}
            raise Refusal("request", detail="there is no such op")
        except Refusal as refusal:
            return {"ok": False, **refusal.details}
        except (ValueError, RecursionError) as error:
            return {"ok": False, "error": "request", "detail": str(error)}

    def ask(self, *words: object) -> Reply:
        """Asks the program. Raises `Refusal` and `Died`."""
        return asked(self._ask, *words)

    def node(self, request: dict[str, Any]) -> int:
        """The node that a request names."""
        place = self.nodes.get(text(request, "node"))
        if place is None:
            raise Refusal("unknown-node")
        return place

    def route(
        self, node: int, kind: str, id: int, name: str | None = None
    ) -> tuple[tuple[int, int, int | str], dict[str, Any] | None]:
        """Node, direction and id that lead to a message, and what is known of it: None
        if the ICD has none there.

        Of an id that several messages have ``name`` says which is meant; without it the
        id leads to none of them: see `is_shared`.
        """
        if not 0 <= id < 1 << self.plan["nodes"][node]["id_bits"]:
            raise Refusal("unknown-id")
        found = self._routes[node].get((kind, id), [])
        if not found and kind == "configuration":
            raise Refusal("unknown-id")
        if len(found) > 1 and name is None:
            return (node, found[0][0], id), None
        found = [one for one in found if name in (None, one[1]["name"])]
        if name is not None and not found:
            raise Refusal("unknown-id")
        direction, message = found[0] if found else (DIRECTIONS[kind], None)
        if message is not None and self.is_shared(
            node, list(DIRECTIONS)[direction], id
        ):
            return (node, direction, f"{id}:{message['name'].encode().hex()}"), message
        return (node, direction, id), message

    def is_shared(self, node: int, kind: str, id: int) -> bool:
        """Whether several messages have the id."""
        return len(self._routes[node].get((kind, id), [])) > 1

    def _routes_of(
        self, speaks: list[int]
    ) -> dict[tuple[str, int], list[tuple[int, dict[str, Any]]]]:
        found: dict[tuple[str, int], list[tuple[int, dict[str, Any]]]] = {}
        spoken = [self.plan["messages"][place] for place in speaks]
        for message in spoken:
            set_id, _ = message["configuration"]
            for kind, id, direction in (
                ("telecommand", message["telecommand"], 0),
                ("telemetry", message["telemetry"], 1),
                ("configuration", set_id, 0),
            ):
                if id is not None:
                    found.setdefault((kind, id), []).append((direction, message))
        set_ids = set(found)
        for message in spoken:
            got = ("configuration", message["configuration"][1])
            if got[1] is not None and got not in set_ids:
                found.setdefault(got, []).append((1, message))
        return found

    def _wire(self, op: str, request: dict[str, Any]) -> dict[str, Any]:
        """The answer about how the messages travel: of the node that is named, else of
        the last that has a protocol.
        """
        if "node" in request:
            place: int | None = self.node(request)
        else:
            linked = [
                place for place, node in enumerate(self.plan["nodes"]) if node["link"]
            ]
            place = linked[-1] if linked else None
        link = self.plan["nodes"][place]["link"] if place is not None else None
        try:
            if link is None:
                checked = wire.Asking(
                    lambda *words: _nothing(),
                    {"longest": 1 << 16, "around": 0, "framing": None},
                )
            else:
                checked = wire.Asking(
                    lambda word, *more: self.ask(word, place, *more), link
                )
            return {**wire.OPS, **scripts.OPS}[op](checked, request)
        except Refusal as refusal:
            if refusal.details["error"] == "range" and op not in (
                "dos_time",
                "stream_encode",
                "stream_encode_packet",
            ):
                raise Refusal("range") from None
            raise


def _nothing() -> Reply:
    raise Refusal("unsupported")
