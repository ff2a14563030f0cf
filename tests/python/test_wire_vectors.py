"""The golden vectors of the protocol, and those of a device that does everything the
other way round.
"""

from __future__ import annotations

import json

import pytest

from icdgen.vectors import protocol
from tests.conformance.compare import difference
from tests.conftest import ROOT
from tests.python import packages

OTHERWISE = {
    "byte_order: little": "byte_order: big",
    "    bit_order: lsb0": "    bit_order: msb0",
    "tables: [216]\n    printed: {bit_order: lsb0}": "tables: [216]\n    printed: {bit_order: msb0}",
    "escaped_in: [id, data]": "escaped_in: [data]",
    "other: error": "other: ignore",
    " first: 0": " first: 1",
    "received: 1": "received: 0",
    "beyond_end: 1": "beyond_end: 0",
    "fill: 0x00": "fill: 0x5A",
    "covers: {from: data, to: data}": "covers: {from: id, to: data}",
    "covers_fill: false": "covers_fill: true",
    "reflect_in: true": "reflect_in: false",
    "check: 0x25": "check: 0x57",
}


@pytest.fixture(scope="module")
def otherwise(tmp_path_factory):
    """Made from the ICDs of the project, with other orders, markers, fills and counts."""
    folder = tmp_path_factory.mktemp("otherwise")
    for path in (ROOT / "icd").rglob("*.yaml"):
        text = path.read_text(encoding="utf-8")
        for old, new in OTHERWISE.items():
            text = text.replace(old, new)
        made = folder / "icd" / path.relative_to(ROOT / "icd")
        made.parent.mkdir(parents=True, exist_ok=True)
        made.write_text(text, encoding="utf-8")
    return packages.write(packages.read(folder / "icd"), folder, "otherwise_messages")


@pytest.mark.parametrize("name", ["shipped", "otherwise"])
def test_every_vector_is_answered_as_it_must_be(name, request):
    package = request.getfixturevalue(name)
    asked = 0
    for node in protocol.nodes(package.icd):
        for case in protocol.cases(package.icd, node):
            answer = package.answer(json.dumps(case.request).encode())
            assert difference(case.answer, json.dumps(answer).encode()) is None, (
                case.why
            )
            asked += 1
    assert asked > 1000


def first_packet(link) -> int:
    return link.procedures["download"].blocks.first_packet


def test_the_other_device_is_another_one(otherwise, shipped):
    there, here = otherwise.module("cubeacp").LINK, shipped.module("cubeacp").LINK
    assert (there.order, there.framing.escapes_id, first_packet(there)) == (
        "big",
        False,
        1,
    )
    for part in ("framing", "checksum", "mask", "procedures"):
        assert getattr(there, part) != getattr(here, part)
