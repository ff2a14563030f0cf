"""ICDs of which XTCE is made and read back: the shipped ones, those of other devices
and links, the documented, and odd ones.
"""

from __future__ import annotations

from pathlib import Path

from tests import documents
from tests.c import odd as of_c
from tests.conformance import odd
from tests.conftest import ROOT


def sets(folder: Path) -> dict[str, list[Path]]:
    """Sets of ICDs by name; those that are made are written to the folder."""
    found = {
        "shipped": sorted((ROOT / "icd").glob("*.yaml")),
        "devices": sorted((ROOT / "examples" / "devices").rglob("*.yaml")),
        "links": sorted((ROOT / "examples" / "links").glob("*.yaml")),
        "fine": sorted((ROOT / "tests" / "icd" / "fine").glob("*.yaml")),
    }
    (inner := folder / "odd").mkdir()
    found["odd"] = sorted(odd.write(inner).glob("*.yaml"))
    (inner := folder / "hostile").mkdir()
    found["hostile"] = [
        path for path in of_c.write(inner) if path.stem in ("hostile", "silent")
    ]
    for number, text in enumerate(
        text
        for page in documents.pages()
        for text in documents.icds(page.read_text("utf-8"))
    ):
        path = folder / f"example{number}.yaml"
        path.write_text(text, encoding="utf-8")
        if "include:" not in text:
            found[f"example {number}"] = [path]
    return found
