"""The diff of ICDs that differ in fields after a variable-length field."""

from __future__ import annotations

from icdgen.diff import inputs, report

OLD = """\
icdgen: 1
node: {name: demo, title: Demo, byte_order: little, bit_order: lsb0}
messages:
  - name: Packet
    id: 1
    kind: telemetry
    length: 1
    fields:
      - {at: 0, bits: 8, name: Size, type: uint}
      - {at: 8, name: Payload, type: bytes, size: Size, up_to: 8}
      - {at: 8, after: Payload, bits: 8, name: Mode, type: uint}
      - {at: 8, after: Mode, bits: 16, name: CRC, type: uint}
"""


def changes(tmp_path, *replaced):
    """Return rule and text of the changes to OLD with these replacements."""
    (tmp_path / "old").mkdir()
    (tmp_path / "new").mkdir()
    (tmp_path / "old" / "demo.yaml").write_text(OLD)
    new = OLD
    for old_text, new_text in replaced:
        assert old_text in new
        new = new.replace(old_text, new_text)
    (tmp_path / "new" / "demo.yaml").write_text(new)
    sides = inputs.sides([str(tmp_path / "old"), str(tmp_path / "new")], [])
    return [
        (change.rule.code, change.message)
        for change in report.make_report(*sides).changes
    ]


def test_more_elements_before_a_field_do_not_move_it(tmp_path):
    reported = changes(tmp_path, ("up_to: 8", "up_to: 9"))
    assert [rule for rule, _ in reported if rule < "DIF300"] == ["DIF119"]


def test_fields_that_change_places_are_reported(tmp_path):
    reported = changes(
        tmp_path,
        ("after: Payload, bits: 8, name: Mode", "after: Payload, bits: 16, name: CRC"),
        ("after: Mode, bits: 16, name: CRC", "after: CRC, bits: 8, name: Mode"),
    )
    moved = [text for rule, text in reported if rule == "DIF107"]
    assert len(moved) == 2 and "`Mode`" in moved[0] and "`CRC`" in moved[1]


def test_a_new_field_at_the_end_makes_the_frame_longer(tmp_path):
    reported = changes(
        tmp_path,
        (
            "name: CRC, type: uint}\n",
            "name: CRC, type: uint}\n      - {at: 8, after: CRC, bits: 8, name: End, type: uint}\n",
        ),
    )
    assert "DIF106" in [rule for rule, _ in reported]
    assert any("`End`" in text for _, text in reported)
