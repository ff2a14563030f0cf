"""The page of changes links each changed object to its page of this release."""

from __future__ import annotations

from icdgen.backends.html import changes
from icdgen.backends.html.relations import Relations
from icdgen.diff.inputs.side import ComparisonSide
from tests.icd.files import loaded

ICD = """\
enums:
  - {name: Mode, members: [{value: 0, name: Idle}]}
messages:
  - {name: Status, id: 0, kind: telemetry, length: 1, fields: [
      {at: 0, bits: 8, name: Mode, type: enum, enum: Mode}]}
  - {name: Stop, id: 255, kind: telecommand, length: 1}
"""
OLD = (
    ICD.replace("name: Idle", "name: Off")
    .replace("at: 0, bits: 8", "at: 0, bits: 4")
    .replace("name: Stop", "name: Halt, group: x")
    .replace("id: 255", "id: 254")
)


def test_only_objects_of_this_release_have_a_link(tmp_path):
    (tmp_path / "old").mkdir()
    previous = loaded(tmp_path / "old", OLD).icd
    current = loaded(tmp_path, ICD).icd
    values = changes.values(Relations(current), ComparisonSide("old", previous))
    urls = {group.title: url for group, url in values["sections"]}
    assert urls == {
        "Status": "demo/status.html",
        "Stop": "demo/stop.html",
        "Halt": "",
        "Mode": "demo/enum-mode.html",
    }


def test_the_link_of_an_object_is_its_page(tmp_path):
    icd = loaded(tmp_path, ICD).icd
    relations, (node,) = Relations(icd), icd.nodes
    assert changes._url(relations, node.messages[0]) == "demo/status.html"
    assert changes._url(relations, node.enums[0]) == "demo/enum-mode.html"
    assert changes._url(relations, node) == "demo/index.html"
    assert changes._url(relations, None) == ""
