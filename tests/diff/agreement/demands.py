"""Requests from the vectors of an old ICD to the code of a new one."""

from __future__ import annotations

from collections.abc import Iterator

from icdgen.diff.compare import Comparison
from icdgen.diff.pairs import MessagePair
from tests.conformance.cases import (
    DIRECTIONS,
    Case,
    MessageCases,
    enum_cases,
    member_names,
    node_itself,
)

EVERYTHING = ...


def all_cases(data: dict) -> Iterator[Case]:
    """Yield every case of the vectors of a small ICD."""
    enums = member_names({data["node"]: data})
    for message in data["messages"]:
        yield from MessageCases(data["node"], message, enums, data["never_set"]).all()
    yield from enum_cases(data)
    yield node_itself(data)
    yield from ids(data, ())


def on_the_wire(
    data: dict, comparison: Comparison, other_ids: tuple[int, ...]
) -> Iterator[Case]:
    """Yield the cases about bytes and raw values only, with the names of the new ICD.
    ``other_ids`` are ids of the new ICD.
    """
    pairs = {
        p.old.name: p
        for node in comparison.match.nodes
        for p in node.messages
        if p.before is not None
    }
    enums = member_names({data["node"]: data})
    for message in data["messages"]:
        pair = pairs[message["name"]]
        cases = MessageCases(data["node"], message, enums, data["never_set"])
        for vector in message["vectors"]:
            for case in cases.frame(vector):
                if "physical" not in case.request and "names" not in case.request:
                    yield _renamed(case, pair)
        yield from (_renamed(case, pair) for case in cases.routes())
        yield from cases.refused_lengths()
    yield from ids(data, other_ids)


def ids(data: dict, other_ids: tuple[int, ...]) -> Iterator[Case]:
    """Yield cases of ids that select a message, and of ids that must not."""
    names_by_id = {direction: data["ids"][direction] for direction in DIRECTIONS}
    numbers = sorted(
        {int(number) for rows in names_by_id.values() for number in rows}
        | {0, 255, *other_ids}
    )
    for direction in DIRECTIONS:
        for number in numbers:
            if str(number) not in names_by_id[direction]:
                request = {
                    "op": "decode",
                    "node": data["node"],
                    "kind": direction,
                    "id": number,
                    "bytes": "",
                }
                yield Case(
                    f"{direction} {number}",
                    request,
                    {"ok": False, "error": "unknown-id"},
                )


def _renamed(case: Case, pair: MessagePair) -> Case:
    names = {p.old.name: p.new.name for p in pair.common}
    request = dict(case.request)
    if "raw" in request:
        request["raw"] = {
            names.get(name, name): value for name, value in request["raw"].items()
        }
    answer = dict(case.answer)
    if "raw" in answer:
        answer["raw"] = {
            names.get(name, name): value for name, value in answer["raw"].items()
        }
        for part in pair.parts:  # added or removed overlay fields change no bytes
            if part.before is None and part.new.is_read_only:
                answer["raw"][part.new.name] = EVERYTHING
            elif part.after is None and part.old.is_read_only:
                del answer["raw"][part.old.name]
        answer["physical"] = EVERYTHING
    return Case(case.about, request, answer)


def plain(answer: dict) -> dict:
    """Return the answer with raw booleans as numbers, because they are bits on the
    wire.
    """
    raw = answer.get("raw")
    if not isinstance(raw, dict):
        return answer
    return {
        **answer,
        "raw": {
            key: int(value) if isinstance(value, bool) else value
            for key, value in raw.items()
        },
    }
