"""A cached model equals the loaded model, and cache files can contain nothing but
models.
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
def stored() -> bytes:
    loaded = load([shipped.icds()])
    return model_json.json_of_model(loaded.icd, loaded.inputs)


def test_the_shipped_icds_come_back_the_same(stored):
    loaded = load([shipped.icds()])
    icd, inputs = model_json.model_of_json(stored)
    assert (icd, inputs) == (loaded.icd, loaded.inputs)
    assert repr(icd) == repr(loaded.icd)  # 1 is not 1.0, and a tuple no list
    assert model_json.json_of_model(icd, inputs) == stored


def test_objects_shared_by_two_fields_stay_shared(stored):
    icd, _ = model_json.model_of_json(stored)
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
def test_other_json_is_no_model(text):
    data = text if isinstance(text, bytes) else text.encode("utf-8", "surrogatepass")
    assert model_json.model_of_json(data) is None


def test_a_truncated_model_is_ignored(stored):
    for end in range(0, len(stored), 4099):
        assert model_json.model_of_json(stored[:end]) is None
    rows = json.loads(stored)
    rows[0] = {"is": "Icd", "nodes": []}
    assert model_json.model_of_json(json.dumps(rows).encode()) == (
        Icd(()),
        {Path(path): seen for path, seen in rows[1]},
    )
