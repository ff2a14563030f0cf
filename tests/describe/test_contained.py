"""Members of a contained message are copied from the fields with the same bits."""

from __future__ import annotations

from icdgen.describe import describe
from icdgen.describe.contained import contained_messages
from tests.icd.files import loaded

ICD = """\
messages:
  - name: Wheel
    id: 130
    kind: telemetry
    length: 5
    fields:
      - {at: 0, bits: 16, name: Speed, type: int}
      - {at: 16, bits: 8, name: Phase, type: uint, count: 3}
  - {name: Beat, id: 131, kind: telemetry, length: 0}
  - name: Everything
    id: 132
    kind: telemetry
    length: 11
    contains:
      - {message: Wheel, at: 8}
      - {message: Wheel, at: 48}
    fields:
      - {at: 0, bits: 8, name: Mode, type: uint}
      - {at: 8, bits: 16, name: Left Speed, type: int}
      - {at: 24, bits: 8, name: Left Phase, type: uint, count: 3}
      - {at: 48, bits: 16, name: Right Speed, type: int}
      - {at: 64, bits: 8, name: First, type: uint}
      - {at: 72, bits: 8, name: Second, type: uint}
      - {at: 80, bits: 8, name: Third, type: uint}
"""


def test_members_are_copied_from_arrays_or_from_each_element(tmp_path):
    result = loaded(tmp_path, ICD)
    assert result.ok, [finding.message for finding in result.findings]
    wheel, beat, everything = describe(result.icd).nodes[0].messages
    assert contained_messages(wheel) == contained_messages(beat) == ()
    (part,) = contained_messages(everything)
    assert (part.message, part.positions) == (wheel, (8, 48))
    copies = [
        [
            (copy.member.name, [source.name for source in copy.sources], copy.is_whole)
            for copy in part.copies(everything, begin)
        ]
        for begin in part.positions
    ]
    assert copies == [
        [("speed", ["left_speed"], True), ("phase", ["left_phase"], True)],
        [
            ("speed", ["right_speed"], True),
            ("phase", ["first", "second", "third"], False),
        ],
    ]
