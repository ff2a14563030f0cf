"""One content in sixteen layouts, with rules and without, captions above and below: the same rules give it back from each."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.importer.compare import differences
from tests.importer.conftest import imported
from tests.importer.manuals import content
from tests.importer.manuals.further import FURTHER
from tests.importer.manuals.layouts import LAYOUTS
from tests.importer.test_layouts import TITLES

RULES = str(Path(__file__).with_name("layouts.yaml"))
DRAWN = LAYOUTS | FURTHER


@pytest.mark.parametrize("layout", DRAWN)
def test_rules_give_the_content_back_from_every_layout(layout, tmp_path):
    trees = content.shipped("common", "bootloader") | content.shipped("cubeacp", most=10)
    manual = content.manual(trees, TITLES)
    DRAWN[layout](manual, tmp_path / "manual.pdf")
    result, got = imported(tmp_path / "manual.pdf", RULES)
    assert {name: differences(tree, got.get(name, {})) for name, tree in manual.trees.items()} == {
        name: [] for name in trees
    }
    # A rule for labels in a column of their own has no table in layouts without it; nothing else is wrong.
    assert {t.code for t in result.troubles if t.severity == "error"} <= {"IMP101"}
    assert result.interpretation is not None
