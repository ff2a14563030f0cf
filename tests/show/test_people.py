"""``icdgen show`` in its form for people."""

from __future__ import annotations

from collections import Counter

import pytest

from icdgen.loading import load
from icdgen.show.people import to_text
from icdgen.values.errors import NotFound
from icdgen.values.find import find_message
from icdgen.values.frame import decoded_frame
from icdgen.values.text import to_text as values_text
from tests.conformance.icds import icd_of
from tests.conftest import ROOT
from tests.icd.files import HEAD, status
from tests.show.test_machine import BASE, OVERLAY, TOP

EXPECTED = """\
top: Temperature
configuration 2/140 (hex 02/8C); 4 bytes; table 98

offset  bits  type  name   unit   resolution   from                 to  notes
------  ----  ----  -----  -----  ----------  -----  -----------------  ------------------
     0    16  int   Air    K             5/9  -40.5  18186.11111111111  below 100; TOP-001
    16     8  Mode  Mode
    24     8  uint  Count  stars           5      0               1275  255: many

Mode (enumeration, table 3)
value  name  meaning
-----  ----  ---------
    0  Idle
    1  Run   At speed.

Erratum TOP-001 (likely): Wrong unit
  It is.
  Table 98.
  Printed and held: unit C -> K
  Tables: 98
"""


@pytest.fixture(scope="module")
def icd(tmp_path_factory):
    folder = tmp_path_factory.mktemp("show")
    (folder / "errata").mkdir()
    for name, text in (
        ("base.yaml", BASE),
        ("top.yaml", TOP),
        ("errata/top.yaml", OVERLAY),
    ):
        (folder / name).write_text(text, encoding="utf-8")
    return load([folder / "top.yaml"], check=False).icd


def test_the_nodes(icd):
    assert to_text(icd) == (
        "node  title  type  version  commands  telemetry  settings  fields  errata  notes  includes\n"
        "----  -----  ----  -------  --------  ---------  --------  ------  ------  -----  --------\n"
        "base  Base                         0          0         0       0       0      0\n"
        "top   Top       0        7         1          1         1       4       1      2  base\n"
    )


def test_a_node(icd):
    assert to_text(icd, ["top"]) == (
        "top: Top\n"
        "node type 0; interface version 7; little-endian, lsb0; includes base; 1 erratum, 2 notes\n"
        "\n"
        "   id  kind           name         bytes  fields  table\n"
        "-----  -------------  -----------  -----  ------  -----\n"
        "    0  telecommand    Reset            1       1\n"
        "2/140  configuration  Temperature      4       3     98\n"
        "  141  telemetry      Nothing          0       0\n"
        "\n"
        "Missing: telemetry 186 Torque. Not described.\n"
    )
    assert "Temperature" not in to_text(icd, ["top"], kind="telemetry")


def test_a_message_by_id_or_name(icd):
    assert to_text(icd, ["top", "140"]) == EXPECTED
    assert (
        to_text(icd, ["top", "0x8c"])
        == to_text(icd, ["top", "temperature"])
        == to_text(icd, ["top", "140"])
    )


def test_a_message_without_fields_and_one_that_is_not_acknowledged(icd):
    assert (
        to_text(icd, ["top", "141"])
        == "top: Nothing\ntelemetry 141 (hex 8D); 0 bytes\n"
    )
    assert "not acknowledged" in to_text(icd, ["top", "reset"])
    assert "always 0" in to_text(icd, ["top", "reset"])


def test_an_enumeration_and_a_note(icd):
    assert to_text(icd, ["top", "mode"]).startswith("Mode (enumeration, table 3)\n")
    assert to_text(icd, ["top", "top-002"]) == "Note TOP-002: A section\n  W.\n  E.\n"


@pytest.mark.parametrize("selection", [["nope"], ["top", "nope"], ["base", "TOP-001"]])
def test_what_is_not_there(icd, selection):
    with pytest.raises(NotFound):
        to_text(icd, selection)


@pytest.mark.parametrize("width", [90, 100, 120])
@pytest.mark.parametrize("selection", [[], ["top"], ["top", "140"]])
def test_on_a_terminal_every_line_fits(icd, selection, width):
    text = to_text(icd, selection, width)
    assert all(len(line) <= width for line in text.splitlines())


@pytest.mark.parametrize("width", [20, 60, 80, 90, 100])
@pytest.mark.parametrize("selection", [[], ["top"], ["top", "140"]])
def test_on_a_terminal_no_text_is_cut(icd, selection, width):
    wide, narrow = (
        Counter("".join(text.replace("-", "").split()))
        for text in (to_text(icd, selection), to_text(icd, selection, width))
    )
    assert wide == narrow


def test_a_struct_is_shown_by_its_name(tmp_path):
    (tmp_path / "demo.yaml").write_text(
        "icdgen: 1\n"
        "node: {name: demo, title: Demo, byte_order: little, bit_order: lsb0}\n"
        "structs:\n"
        "  - name: Peak\n"
        "    length: 4\n"
        "    summary: A line of a spectrum.\n"
        "    fields: [{at: 0, bits: 16, name: Frequency, type: uint, unit: kHz}]\n"
        "messages:\n"
        "  - {name: Peaks, id: 1, kind: telemetry, length: 4, fields: [{at: 0, name: Best, struct: Peak}]}\n",
        encoding="utf-8",
    )
    expected = """\
demo: Peak
struct; 4 bytes
A line of a spectrum.

offset  bits  type      name       unit  from     to
------  ----  --------  ---------  ----  ----  -----
     0    16  uint      Frequency  kHz      0  65535
    16    16  reserved
"""
    assert to_text(load([tmp_path / "demo.yaml"]).icd, ["demo", "peak"]) == expected


def test_ids_of_several_bytes_are_shown_as_decode_shows_them():
    icd = icd_of([ROOT / "examples" / "links"])
    clock = to_text(icd, ["receiver", "Navigation Clock"])
    assert clock.startswith("receiver: Navigation Clock\ntelemetry 01 22; ")
    assert "(telemetry 01 22)" in values_text(
        decoded_frame(
            icd,
            icd.node("receiver"),
            find_message(icd, "receiver", "Navigation Clock"),
            bytes(20),
        )
    )
    assert "01 22  telemetry" in to_text(icd, ["receiver"])
    with pytest.raises(NotFound) as error:
        find_message(icd, "receiver", "Navigation Clock", "telecommand")
    assert error.value.help == "`Navigation Clock` is telemetry 01 22"


@pytest.mark.parametrize(
    ("name", "text"),
    [
        (
            "Set Mode",
            "confirmed by Ack, refused by Nak, busy: Busy; may be sent again after a "
            "time-out",
        ),
        ("Get Events", "answered with Events, refused by Nak, busy: Busy"),
        ("Reset", "no response"),
    ],
)
def test_the_responses_to_a_telecommand_on_a_framed_link(name, text):
    icd = load([ROOT / "examples" / "links" / "wheel.yaml"]).icd
    assert text in to_text(icd, ["wheel", name], None)


@pytest.mark.parametrize(
    ("keys", "ends"),
    [
        ("", ["-128", "127"]),
        (", min: 0", ["0", "127"]),
        (", max: 0", ["-128", "0"]),
        (", min: -5, max: 5", ["-5", "5"]),
    ],
)
def test_a_limit_of_zero_is_shown_as_any_other(tmp_path, keys, ends):
    field = f"{{at: 0, bits: 8, name: Value, type: int{keys}}}"
    path = tmp_path / "demo.yaml"
    path.write_text(HEAD + status(field[1:-1], length=1))
    (row,) = [
        line.split()
        for line in to_text(load([path]).icd, ["demo", "Status"]).splitlines()
        if " Value " in line
    ]
    assert row == ["0", "8", "int", "Value", *ends]
