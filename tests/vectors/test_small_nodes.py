"""Whatever messages a node has, and however few, its link has vectors that every
language can be asked.
"""

from __future__ import annotations

import random
from pathlib import Path

import pytest
import yaml

from icdgen.loading import load
from icdgen.vectors import protocol
from tests.conformance import ROOT
from tests.conformance.icds import LINKS

SOURCES = [
    ROOT / "docs" / "guides" / "tutorial" / "icd" / "line.yaml",
    ROOT / "docs" / "reference" / "api" / "imu.yaml",
    ROOT / "examples" / "links" / "ccsds.yaml",
    LINKS / "battery.yaml",
]


def small(source: Path, folder: Path, chosen: random.Random, count: int) -> Path:
    """The node of ``source`` with a few of its messages, some of which are not
    acknowledged.
    """
    tree = yaml.load(source.read_text(encoding="utf-8"), yaml.CSafeLoader)
    messages = tree.get("messages", [])
    tree["messages"] = chosen.sample(messages, min(count, len(messages)))
    for message in tree["messages"]:
        if chosen.random() < 0.4:
            message.pop("acknowledge", None)
    tree["node"]["name"] = "small"
    path = folder / "small.yaml"
    path.write_text(yaml.safe_dump(tree, sort_keys=False), encoding="utf-8")
    return path


@pytest.mark.parametrize("source", SOURCES, ids=lambda path: path.stem)
@pytest.mark.parametrize("count", range(4))
def test_a_node_of_a_few_messages_has_vectors_and_no_question_that_is_none(
    tmp_path, source, count
):
    chosen = random.Random(count)
    made = 0
    for _ in range(8):
        loaded = load([small(source, tmp_path, chosen, count)])
        if not loaded.ok:  # what the protocol section names is not among them
            continue
        (node,) = loaded.icd.nodes
        found = protocol.cases(loaded.icd, node)
        assert [case for case in found if case.answer.get("error") == "request"] == []
        made += len(found)
    assert made
