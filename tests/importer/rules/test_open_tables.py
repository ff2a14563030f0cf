"""Tables with horizontal rules only start at the headings of rules and end at their
last horizontal rule.
"""

from __future__ import annotations

from icdgen.importer import profile, run
from tests.importer.rules.drawing import draw, heading, open_table, text

PROFILE = r"""profile: 1
node: {byte_order: big, bit_order: lsb0}
rules:
  - tables: {head: Octets | Parameter | Format | Resolution | Remarks}
    message: {heading: '^[\d.]+ {message} \({id}\)$', kind: telecommand}
    columns: {Octets: '^{byte}(?:-{last_byte})?$', Parameter: name, Format: type, Resolution: '^{scale} {unit}$', Remarks: text}
  - what: bits
    tables: {head: Bit | Flag | Meaning when set}
    message: {before: '^Bits of {of}:$'}
    columns: {Bit: bit, Flag: name, Meaning when set: text}
    each: {type: uint}
    width: unit
"""
HEAD = ["Octets", "Parameter", "Format", "Resolution", "Remarks"]
WIDTHS = [50, 110, 60, 80, 110]


def test_a_table_of_one_row_and_the_text_between_two_tables(tmp_path):
    rows = [
        HEAD,
        ["0-1", "Voltage", "U16", "10 mV", "-"],
        ["2", "Status", "U8", "-", "Bits below"],
    ]
    flags = [
        ["Bit", "Flag", "Meaning when set"],
        *([str(n), f"Flag {n}", "-"] for n in range(8)),
    ]
    draw(tmp_path / "battery.pdf", [
        heading("4.1 Clear faults (19)", 2), open_table([HEAD, ["0", "Key", "U8", "-", "Always the same"]], WIDTHS),
        heading("4.2 Set limits (20)", 2), open_table(rows, WIDTHS), text("Bits of Status:"), open_table(flags, [60, 150, 150]),
    ])  # fmt: skip
    (tmp_path / "rules.yaml").write_text(PROFILE, encoding="utf-8")
    result, trees = run.run(
        tmp_path / "battery.pdf", profile.load(tmp_path / "rules.yaml"), jobs=1
    )
    assert [t.message for t in result.import_findings if t.severity != "note"] == []
    names = [
        [field["name"] for field in message["fields"]]
        for message in trees["battery"]["messages"]
    ]
    assert names == [["Key"], ["Voltage", *(f"Flag {n}" for n in range(8))]]
