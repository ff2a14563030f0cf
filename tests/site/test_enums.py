"""Values of the page of an enumeration."""

from __future__ import annotations

from icdgen.backends.html import enums
from icdgen.backends.html.relations import PageLink, Relations
from tests.icd.files import loaded, status

ICD = """\
enums:
  - name: Mode
    members:
      - {value: 255, name: Run}
      - {value: 0, name: Idle}
      - {value: 1, to: 3, name: Run!}
"""


def test_members_have_anchors_and_fields_of_the_type_are_listed(tmp_path):
    fields = (
        "at: 0, bits: 8, name: First, type: enum, enum: Mode",
        "at: 8, bits: 8, name: Second, type: enum, enum: Mode",
    )
    result = loaded(tmp_path, ICD + status(*fields))
    (enum,) = result.icd.nodes[0].enums
    values = enums.values(Relations(result.icd), enum)
    assert [(member.value, anchor) for member, anchor in values["members"]] == [
        (255, "member-run"),
        (0, "member-idle"),
        (1, "member-run-2"),
    ]
    assert values["users"] == [
        PageLink("Status: First", "demo/status.html#field-first"),
        PageLink("Status: Second", "demo/status.html#field-second"),
    ]
    assert (values["enum"], values["node"].name) == (enum, "demo")
    assert list(values["errata"]) == []
