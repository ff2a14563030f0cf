"""The link of a node with few messages, or none, has vectors that every language can
answer.
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
    """Write the node of ``source`` with a few of its messages; some are not
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
def test_a_node_of_few_messages_has_vectors_without_invalid_requests(
    tmp_path, source, count
):
    chosen = random.Random(count)
    count_of_cases = 0
    for _ in range(8):
        loaded = load([small(source, tmp_path, chosen, count)])
        if not loaded.ok:  # a message that the protocol section names is missing
            continue
        (node,) = loaded.icd.nodes
        cases = protocol.cases(loaded.icd, node)
        assert [case for case in cases if case.answer.get("error") == "request"] == []
        count_of_cases += len(cases)
    assert count_of_cases
