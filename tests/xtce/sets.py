"""ICDs from which XTCE is generated and imported again.

The sets are the shipped ICDs, devices, links, the examples of the documents, and odd
ICDs.
"""

from __future__ import annotations

from pathlib import Path

from tests import documents
from tests.c import odd as of_c
from tests.conformance import odd
from tests.conftest import ROOT


def sets(folder: Path) -> dict[str, list[Path]]:
    """Return sets of ICDs by name; generated ICDs are written to the folder."""
    icds = {
        "shipped": sorted((ROOT / "icd").glob("*.yaml")),
        "devices": sorted((ROOT / "examples" / "devices").rglob("*.yaml")),
        "links": sorted((ROOT / "examples" / "links").glob("*.yaml")),
        "fine": sorted((ROOT / "tests" / "icd" / "fine").glob("*.yaml")),
    }
    (inner := folder / "odd").mkdir()
    icds["odd"] = sorted(odd.write(inner).glob("*.yaml"))
    (inner := folder / "hostile").mkdir()
    icds["hostile"] = [
        path for path in of_c.write(inner) if path.stem in ("hostile", "silent")
    ]
    for number, text in enumerate(
        text
        for page in documents.pages()
        for text in documents.icds(page.read_text("utf-8"))
    ):
        path = folder / f"example{number}.yaml"
        path.write_text(text, encoding="utf-8")
        # An example that includes other ICDs is not complete by itself.
        if "include:" not in text:
            icds[f"example {number}"] = [path]
    return icds
