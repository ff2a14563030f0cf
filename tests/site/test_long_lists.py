"""Pages fold the ends of long lists: the places of errata and the uses of units."""

from __future__ import annotations

import re

import pytest

from icdgen.loading import load
from icdgen.site import make_site, write_site

ICD = """\
icdgen: 1
node: {name: demo, title: Demo, byte_order: big, bit_order: msb0}
messages:
  - name: Levels
    kind: telemetry
    id: 1
"""
ERRATA = """\
errata: 1
node: demo
notes:
  - id: DEM-1
    title: Levels without a reference
    where: {message: Levels, fields: [%s]}
    what: The reference of the levels is not stated.
    evidence: Table 1.
    confidence: open
"""


def written(folder, count: int) -> tuple[str, str]:
    """Return the pages of errata and units for a unit and a note with as many fields."""
    fields = "".join(
        f"      - {{at: {8 * number}, bits: 8, name: Level {number}, type: uint, formula: raw*0.5, unit: m}}\n"
        for number in range(count)
    )
    (folder / "errata").mkdir()
    (folder / "demo.yaml").write_text(
        f"{ICD}    length: {count}\n    fields:\n{fields}"
    )
    names = ", ".join(f"Level {number}" for number in range(count))
    (folder / "errata" / "demo.yaml").write_text(ERRATA % names)
    assert load([folder]).findings == []
    write_site(make_site([folder]), folder / "site")
    return tuple(
        (folder / "site" / f"{page}.html").read_text("utf-8")
        for page in ("errata", "units")
    )


@pytest.mark.parametrize(
    ("count", "more_places", "more_fields"),
    [
        (6, [], []),
        (7, ["1 more place"], []),
        (8, ["2 more places"], []),
        (9, ["3 more places"], ["1 more field"]),
        (10, ["4 more places"], ["2 more fields"]),
    ],
)
def test_a_long_list_is_folded_and_has_every_place_once(
    tmp_path, count, more_places, more_fields
):
    errata, units = written(tmp_path, count)
    expected = [f"demo/levels.html#field-level_{number}" for number in range(count)]
    for page, more in ((errata, more_places), (units, more_fields)):
        assert re.findall(r"<summary>(\d+ more \w+)</summary>", page) == more
        assert re.findall(r'href="(demo/levels.html#[^"]+)"', page) == expected
