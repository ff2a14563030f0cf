"""Files: procedures do what the reference does, on whatever becomes of their requests."""

from __future__ import annotations

import json
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from icdgen.protocol.facts import Facts
from icdgen.runtime_objects import reference
from icdgen.vectors.wire import node as nodes
from icdgen.vectors.wire.procedures import record
from tests.python import packages
from tests.python.wire import NODE, known, link

KINDS = [
    {"do": "list"},
    {
        "do": "download",
        "bus": "uart",
        "type": 2,
        "counter": 1,
        "size": 130,
        "block": 80,
    },
    {"do": "download", "bus": "i2c", "type": 2, "counter": 1, "block": 60},
    {"do": "download", "bus": "can", "type": 2, "counter": 2, "size": 0},
    {
        "do": "upload",
        "node": "bootloader",
        "destination": 3,
        "bytes": bytes(range(150)).hex(),
        "block": 80,
    },
    {"do": "erase", "type": 2, "counter": 1, "all": True},
    {"do": "format"},
]


@pytest.fixture(scope="module")
def wire(shipped):
    return shipped.module("wire")


def facts_of(request: dict) -> Facts:
    """The facts of the node that the request is for."""
    return known(request.get("node", NODE))


def node_of(request: dict, seed: int, loss: float) -> nodes.FileNode:
    node = nodes.FileNode(
        facts_of(request), request.get("bus", "uart"), Random(seed), loss
    )
    node.files.update({(2, 0): b"", (2, 1): bytes(range(130)), (2, 2): b"\x1f" * 41})
    return node


def compare(shipped, request: dict) -> dict:
    """The answer of the package, which must be that of the reference."""
    made = shipped.answer(json.dumps(request).encode())
    assert made == reference.answer(packages.shipped(), request)
    return made


@given(
    st.integers(0, 1 << 32),
    st.sampled_from(KINDS),
    st.sampled_from([0.0, 0.1, 0.3, 0.6]),
)
@settings(max_examples=60)
def test_against_a_node_that_loses_things(shipped, seed, request, loss):
    script, _ = record(facts_of(request), request, node_of(request, seed, loss))
    compare(shipped, {"op": "file", "node": NODE, **request, "script": script})


OUTCOMES = st.sampled_from(["done", "done", "done", "refused", "timeout"])


@given(st.data(), st.sampled_from(KINDS))
@settings(max_examples=150)
def test_against_any_outcome_at_any_time(shipped, data, request):
    """Each request has an outcome; a frame holds anything, and time goes on by leaps."""
    from icdgen.protocol.scripts import procedure_of

    procedure, now, script = procedure_of(facts_of(request), request), 0, [{"at": 0}]
    asked = procedure.next(0)
    for _ in range(data.draw(st.integers(0, 40))):
        if procedure.result:
            break
        now += data.draw(st.sampled_from([0, 1, 50, 600, 20_000]))
        row: dict = {"at": now}
        if asked is None and data.draw(st.booleans()):
            number, piece = data.draw(st.integers(0, 9)), data.draw(
                st.binary(min_size=20, max_size=20)
            )
            row["event"] = {"event": "packet", "number": number, "bytes": piece.hex()}
        elif asked is not None:
            row["event"] = {"event": data.draw(OUTCOMES)}
            if row["event"]["event"] == "done":
                length = (
                    facts_of(request).telemetry[asked.id].length
                    if asked.kind == "telemetry"
                    else 0
                )
                frame = data.draw(
                    st.lists(
                        st.sampled_from([0, 0, 1, 2, 130, 255]),
                        min_size=length,
                        max_size=length,
                    )
                )
                row["event"]["bytes"] = bytes(frame).hex()
        if "event" in row:
            procedure.event(now, row["event"])
        asked = procedure.next(now) or (asked if "event" not in row else None)
        script.append(row)
    compare(shipped, {"op": "file", "node": NODE, **request, "script": script})


def test_what_the_icd_does_not_describe_is_unsupported(shipped, wire):
    like = link(shipped)
    with pytest.raises(wire.UnsupportedError):
        wire.FileList(like._replace(files=None))
    with pytest.raises(wire.UnsupportedError, match="format"):
        wire.Format(like._replace(files=like.files._replace(format=None)))
