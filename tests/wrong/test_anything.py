"""An ICD with any value replaced by anything gives findings and no exception."""

from __future__ import annotations

import copy
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path
from typing import Any

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from icdgen import reports
from icdgen.loading import load
from tests.conformance.icds import LINKS
from tests.conftest import ROOT

FILES = sorted(
    path
    for folder in (LINKS, ROOT / "examples" / "links", ROOT / "tests" / "icd" / "fine", ROOT / "tests" / "protocol" / "keys")
    for path in folder.glob("*.yaml")
    if path.stat().st_size < 12_000
)  # fmt: skip
JUNK: list[Any] = [
    None, True, 0, -1, 1, 7, 64, 65, 255, 256, 1 << 33, 1.5, "", "x", "raw*2", "∞", [], [1], ["x", "y"], [[1, 2]], {}, {"a": 1},
]  # fmt: skip


@cache
def tree_of(path: Path) -> Any:
    return yaml.load(path.read_text("utf-8"), yaml.CSafeLoader)


def places(tree: Any, before: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """Yield the keys and indexes that lead to each value."""
    items: Iterable[tuple] = ()
    if isinstance(tree, dict):
        items = tree.items()
    elif isinstance(tree, list):
        items = enumerate(tree)
    for key, value in items:
        yield (*before, key)
        yield from places(value, (*before, key))


def at(tree: Any, place: tuple[Any, ...]) -> Any:
    for key in place:
        tree = tree[key]
    return tree


@settings(max_examples=400)
@given(st.data())
def test_any_value_in_any_place_ends_in_findings(tmp_path_factory, data):
    tree = copy.deepcopy(tree_of(data.draw(st.sampled_from(FILES))))
    place = data.draw(st.sampled_from([*places(tree)]))
    other_values = st.sampled_from([*places(tree)]).map(
        lambda other: copy.deepcopy(at(tree, other))
    )
    at(tree, place[:-1])[place[-1]] = data.draw(st.sampled_from(JUNK) | other_values)
    path = tmp_path_factory.mktemp("any") / "any.yaml"
    path.write_text(yaml.safe_dump(tree, sort_keys=False, allow_unicode=True), "utf-8")
    loaded = load([path])
    assert reports.get("text")(loaded.findings, loaded.texts) or loaded.ok


PROCEDURE_PLACES = [
    (),
    ("upload",),
    ("upload", "nodes"),
    ("upload", "inputs"),
    ("upload", "inputs", "area"),
    ("upload", "outputs"),
    ("upload", "steps"),
    ("upload", "steps", 0),
]


@pytest.mark.parametrize("place", PROCEDURE_PLACES, ids=str)
@pytest.mark.parametrize("value", [None, [5], 5, "text"], ids=repr)
def test_a_part_of_a_procedure_of_the_wrong_type_is_a_finding(tmp_path, place, value):
    tree = copy.deepcopy(tree_of(ROOT / "examples" / "links" / "bootloader.yaml"))
    *above, key = ("protocol", "procedures", *place)
    at(tree, tuple(above))[key] = value
    path = tmp_path / "loader.yaml"
    path.write_text(yaml.safe_dump(tree, sort_keys=False), "utf-8")
    assert "ICD010" in {finding.code for finding in load([path]).findings}
