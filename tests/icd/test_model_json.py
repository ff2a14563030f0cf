"""A model that was kept is the model that was loaded, and what is kept can hold nothing
but models.
"""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from icdgen import shipped
from icdgen.icd import model_json
from icdgen.icd.model import Icd
from icdgen.loading import load


@pytest.fixture(scope="module")
def kept() -> bytes:
    loaded = load([shipped.icds()])
    return model_json.json_of_model(loaded.icd, loaded.inputs)


def test_the_shipped_icds_come_back_the_same(kept):
    loaded = load([shipped.icds()])
    icd, inputs = model_json.model_of_json(kept)
    assert (icd, inputs) == (loaded.icd, loaded.inputs)
    assert repr(icd) == repr(loaded.icd)  # 1 is not 1.0, and a tuple no list
    assert model_json.json_of_model(icd, inputs) == kept


def test_what_two_fields_share_is_shared_again(kept):
    icd, _ = model_json.model_of_json(kept)
    enums = {id(enum) for node in icd.nodes for enum in node.enums}
    used = {
        id(f.enum)
        for n in icd.nodes
        for m in n.messages
        for f in m.fields
        if f.enum is not None
    }
    assert used and used <= enums


@pytest.mark.parametrize(
    "text",
    [
        "", "null", "[]", "{}", "[1, 2, 3]", '[{"is": "Icd", "nodes": []}]', '[{"is": "Path"}, []]', '[{"is": "os.system"}, []]',
        '[{"is": "Icd"}, []]', '[{"is": "Icd", "nodes": [], "more": 1}, []]', '[{"same": 0}, []]', '[{"nodes": []}, []]',
        '[{"is": "/", "parts": [1, 0]}, []]', '[{"is": "raw", "json": "{"}, []]', '["Icd", []]', '[{"is": ["Icd"]}, []]',
        '[{"is": "Icd", "nodes": []}, [[1]]]', "[" * 100_000, "\ud800", b"\xff\xfe",
    ],
)  # fmt: skip
def test_what_is_no_model_is_none(text):
    data = text if isinstance(text, bytes) else text.encode("utf-8", "surrogatepass")
    assert model_json.model_of_json(data) is None


def test_every_torn_model_is_none_or_a_model(kept):
    for end in range(0, len(kept), 4099):
        assert model_json.model_of_json(kept[:end]) is None
    rows = json.loads(kept)
    rows[0] = {"is": "Icd", "nodes": []}
    assert model_json.model_of_json(json.dumps(rows).encode()) == (
        Icd(()),
        {Path(path): seen for path, seen in rows[1]},
    )
