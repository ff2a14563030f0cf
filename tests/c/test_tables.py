"""Tables of links and procedures in C: declarations come before their use, and equal
ones exist once.
"""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from icdgen.backends.c.facts import TableRow
from icdgen.backends.c.tables import Table, TableSet, algorithm_table_name
from icdgen.describe.links import byte_table
from icdgen.protocol.sections import Crc, Framing


class Assumptions:
    """Test double that knows one reason, which it returns once."""

    def __init__(self) -> None:
        self.left = [("escape", "not */ in the manual")]

    def of_part(self, part: object) -> list[tuple[str, str]]:
        reasons, self.left = self.left, []
        return reasons


def table_set(prefix="icdgen_node_demo_"):
    facts = SimpleNamespace(node=SimpleNamespace(name="demo"))
    return TableSet(SimpleNamespace(facts=facts), Assumptions(), prefix)


def test_a_table_has_its_prefix_and_is_referred_to_by_its_address():
    tables = table_set()
    rows = [TableRow("{1u}", "Reset"), "{2u}"]
    assert tables.declare("form", "icd_form_t", rows, unless="NO_FORM") == (
        "&icdgen_node_demo_form"
    )
    assert tables.declare("form", "icd_form_t", [], [("key", "why"), ("x", "y")]) == (
        "&icdgen_node_demo_form"
    )
    name = "icdgen_node_demo_form"
    assert tables.tables == [
        Table("", "icd_form_t", name, ["{1u}, /* Reset */", "{2u}"], "NO_FORM"),
        Table("    /** Assumed key: why Assumed x: y */", "icd_form_t", name, [], ""),
    ]


def test_an_array_is_referred_to_by_its_name_and_an_empty_one_by_null():
    tables = table_set()
    assert tables.declare_array("rows", "row_t", ["{1u}", TableRow("{2u}", "B")]) == (
        "icdgen_node_demo_rows"
    )
    assert tables.declare_array("none", "row_t", []) == "NULL"
    numbers = (f"{n}u" for n in range(5))
    assert tables.declare_numbers("data", "uint8_t", numbers, 2, unless="SMALL") == (
        "icdgen_node_demo_data"
    )
    assert tables.declare_numbers("none", "uint8_t", [], 2) == "NULL"
    assert tables.tables == [
        Table("", "row_t", "icdgen_node_demo_rows[]", ["{1u},", "{2u}, /* B */"]),
        Table(
            "",
            "uint8_t",
            "icdgen_node_demo_data[]",
            ["0u, 1u,", "2u, 3u,", "4u,"],
            "SMALL",
        ),
    ]


def test_arrays_of_equal_rows_exist_once_under_each_name():
    tables = table_set("")
    declared = [
        tables.declare_once(name, "t", rows)
        for name, rows in (
            ("echoes", ["1"]),
            ("echoes", iter(["1"])),
            ("places", ["1"]),
            ("echoes", ["2"]),
            ("echoes", []),
            ("echoes", ["1", "2"]),
            ("places", ["2"]),
            ("echoes", ["2"]),
        )
    ]
    assert declared == [
        "echoes_0",
        "echoes_0",
        "places_0",
        "echoes_1",
        "NULL",
        "echoes_2",
        "places_1",
        "echoes_1",
    ]
    assert [table.name for table in tables.tables] == [
        "echoes_0[]",
        "places_0[]",
        "echoes_1[]",
        "echoes_2[]",
        "places_1[]",
    ]


def test_a_section_has_its_facts_and_assumptions_and_further_rows():
    tables = table_set("")
    framing = Framing(0x1F, 0x7F, 0xFF, 0xF1, False, True)
    assert tables.declare_section("framing", None) == "NULL"
    assert tables.declare_section("framing", framing, TableRow("7u", "seven")) == (
        "&framing"
    )
    (table,) = tables.tables
    assert (table.type, table.name) == ("icd_framing_t", "framing")
    assert table.rows == [
        "0x1fu, /* escape */",
        "0x7fu, /* start */",
        "0xffu, /* end */",
        "0xf1u, /* escaped */",
        "false, /* escapes_id */",
        "true, /* ignores_other */",
        "7u, /* seven */",
    ]
    assert table.comment == "    /** Assumed escape: not * / in the manual */"
    assert tables.values_of_facts(framing) == "0x1fu, 0x7fu, 0xffu, 0xf1u, false, true"


def test_times_are_in_milliseconds():
    from icdgen.protocol.sections import Settings

    rows = table_set().rows_of_facts(Settings())
    assert [str(row) for row in rows][:3] == [
        "1000u, /* reply_timeout in ms */",
        "3u, /* retries */",
        "20u, /* poll_interval in ms */",
    ]


@pytest.mark.parametrize(
    ("name", "table"),
    [("CRC-16/ARC", "checksum_crc_16_arc"), ("sum8", "checksum_sum8")],
)
def test_the_table_of_an_algorithm_has_the_name_of_the_checksum(name, table):
    assert algorithm_table_name(name) == table
    algorithm = SimpleNamespace(name=name)
    # Procedures, whose tables have no prefix, use that of the node, too.
    assert table_set("").pointer_to_algorithm(algorithm) == (
        f"&icdgen_node_demo_{table}"
    )


def crc(width, init=0, xor_out=0, reflect=False, polynomial=7):
    return Crc(width, polynomial, init, reflect, reflect, xor_out)


def test_a_crc_of_up_to_16_bits_has_a_table_of_the_smallest_integers():
    def has_table(width):
        tables = table_set("")
        text = tables.declare_crc("crc", crc(width), True)
        if not tables.tables:
            assert text.endswith(",\n         NULL, NULL")
            return False
        (table,) = tables.tables
        bits = 8 if width <= 8 else 16
        assert (table.name, table.type) == ("crc_table[]", f"uint{bits}_t")
        assert table.unless == "ICDGEN_NO_TABLES"
        pointers = "ICDGEN_TABLE(crc_table), NULL"
        if bits == 16:
            pointers = "NULL, ICDGEN_TABLE(crc_table)"
        assert text.splitlines()[1] == f"         {pointers}"
        entries = " ".join(table.rows).replace("u,", "").split()
        assert [int(entry, 16) for entry in entries] == byte_table(crc(width))
        # All entries have the digits of the width.
        assert {len(entry) - 2 for entry in entries} == {-(-width // 4)}
        assert len(table.rows) == 32
        return True

    assert [has_table(width) for width in (3, 4, 7, 8, 9, 12, 15, 16, 17, 32)] == [
        *[True] * 8,
        False,
        False,
    ]


def test_another_kind_of_checksum_has_parameters_but_no_table():
    tables = table_set("")
    assert tables.declare_crc("sum", crc(8, init=1, xor_out=0xFF), False) == (
        "8u, 0x7u, 0x1u, false, false, 0xffu, false, 0x0u,\n         NULL, NULL"
    )
    assert tables.tables == []
