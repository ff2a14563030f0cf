"""Translate JSON requests into lines for the program of a language, and its replies
into JSON answers.
"""

from __future__ import annotations

import json
from typing import Any

from icdgen.runtime_objects.refusals import Refusal
from icdgen.runtime_objects.request_keys import text
from tests.conformance.front import messages, scripts, wire
from tests.conformance.front.program import Ask, Reply, reply_to

DIRECTIONS = {"telecommand": 0, "telemetry": 1}


class Front:
    """Answers requests about a set of ICDs, described by their `plan`, by asking a
    program.
    """

    def __init__(self, plan: dict[str, Any], ask: Ask) -> None:
        self.plan, self._ask = plan, ask
        self.nodes = {node["name"]: place for place, node in enumerate(plan["nodes"])}
        self._routes = [self._routes_of(node["speaks"]) for node in plan["nodes"]]

    def answer(self, line: bytes) -> dict[str, Any]:
        """Return the answer to any request. Raises `Died` if the program gives none."""
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
        """Send words to the program and return its reply. Raises `Refusal` and `Died`."""
        return reply_to(self._ask, *words)

    def node(self, request: dict[str, Any]) -> int:
        """Return the node that a request names."""
        place = self.nodes.get(text(request, "node"))
        if place is None:
            raise Refusal("unknown-node")
        return place

    def route(
        self, node: int, kind: str, id: int, name: str | None = None
    ) -> tuple[tuple[int, int, int | str], dict[str, Any] | None]:
        """Return node, direction and id of a message, and its plan (``None`` if the ICD
        has no such message).

        If several messages share the id, ``name`` selects one of them. Without it the
        id selects none of them (see `is_shared`).
        """
        if not 0 <= id < 1 << self.plan["nodes"][node]["id_bits"]:
            raise Refusal("unknown-id")
        routes = self._routes[node].get((kind, id), [])
        if not routes and kind == "configuration":
            raise Refusal("unknown-id")
        if len(routes) > 1 and name is None:
            return (node, routes[0][0], id), None
        routes = [route for route in routes if name in (None, route[1]["name"])]
        if name is not None and not routes:
            raise Refusal("unknown-id")
        direction, message = routes[0] if routes else (DIRECTIONS[kind], None)
        if message is not None and self.is_shared(
            node, list(DIRECTIONS)[direction], id
        ):
            return (node, direction, f"{id}:{message['name'].encode().hex()}"), message
        return (node, direction, id), message

    def is_shared(self, node: int, kind: str, id: int) -> bool:
        """Return whether several messages have the id."""
        return len(self._routes[node].get((kind, id), [])) > 1

    def _routes_of(
        self, speaks: list[int]
    ) -> dict[tuple[str, int], list[tuple[int, dict[str, Any]]]]:
        routes: dict[tuple[str, int], list[tuple[int, dict[str, Any]]]] = {}
        spoken = [self.plan["messages"][place] for place in speaks]
        for message in spoken:
            set_id, _ = message["configuration"]
            for kind, id, direction in (
                ("telecommand", message["telecommand"], 0),
                ("telemetry", message["telemetry"], 1),
                ("configuration", set_id, 0),
            ):
                if id is not None:
                    routes.setdefault((kind, id), []).append((direction, message))
        set_ids = set(routes)
        for message in spoken:
            got = ("configuration", message["configuration"][1])
            if got[1] is not None and got not in set_ids:
                routes.setdefault(got, []).append((1, message))
        return routes

    def _wire(self, op: str, request: dict[str, Any]) -> dict[str, Any]:
        """Answer a request about framing. It concerns the named node, or else the last
        node with a protocol.
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
                checked = wire.LinkProgram(
                    lambda *words: _nothing(),
                    {"longest": 1 << 16, "around": 0, "framing": None},
                )
            else:
                checked = wire.LinkProgram(
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
