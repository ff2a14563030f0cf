"""Documents as vendors of sensors and modems set them: with the profile that each needs, its ICD comes back."""

from __future__ import annotations

import pytest

from icdgen.importer import profile, run
from tests.importer.compare import differences
from tests.importer.manuals import browser
from tests.importer.manuals.typeset import TYPESET
from tests.importer.manuals.wild import UNSEEN, WILD


@pytest.mark.parametrize("layout", [*WILD, *UNSEEN, *TYPESET])
def test_a_document_in_the_wild_comes_back(layout, tmp_path):
    wild = (WILD | UNSEEN | TYPESET)[layout]
    if browser.program() is None and layout in ("prose", "ranges", "frames", "sheet"):
        pytest.skip("Chromium is not at hand")
    if layout in ("article", "two columns"):
        pytest.importorskip("typst")
    wild.draw(tmp_path / "motor.pdf")
    words = None
    if wild.profile:
        words = tmp_path / "words.yaml"
        words.write_text("profile: 1\n" + wild.profile, encoding="utf-8")
    result, trees = run.run(tmp_path / "motor.pdf", profile.load(words), jobs=1)
    assert differences({"messages": wild.messages}, next(iter(trees.values())), tables=False) == []
    assert not [t for t in result.troubles if t.code in ("IMP020", "IMP022", "IMP023", "IMP027", "IMP040")]
