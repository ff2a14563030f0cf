"""The page of a protocol has the parameters of each checksum."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from icdgen.backends.html.checksums import of_node
from icdgen.icd.checksum import CRC, FLETCHER, FLETCHER_255, SUM, XOR
from icdgen.protocol.declared import facts_of
from icdgen.protocol.sections import Crc

VALUES = {fact.name: 1 for fact in facts_of(Crc)} | {"width": 16}


def checksum_rows(kind, check=None, seeds=None, **values):
    algorithm = SimpleNamespace(
        name="sum",
        kind=kind,
        crc=SimpleNamespace(**{**VALUES, **values}),
        seeds=seeds or {},
    )
    section = {
        "link": {"checksums": {"sum": {} if check is None else {"check": check}}}
    }
    (result,) = of_node(SimpleNamespace(checksums={"sum": algorithm}), section)
    assert result.name == "sum"
    return result.check, [(row.about, row.value) for row in result.rows]


@pytest.mark.parametrize(
    ("kind", "title", "count"),
    [
        (CRC, "CRC-16", len(VALUES)),
        (FLETCHER, "Fletcher's, sums modulo 256", 3),
        (FLETCHER_255, "Fletcher's, sums modulo 255", 3),
        (SUM, "sum of the bytes", 3),
        (XOR, "exclusive or of the bytes", 3),
    ],
)
def test_only_a_crc_has_a_polynomial_and_reflections(kind, title, count):
    _, rows = checksum_rows(kind)
    assert rows[0] == ("Kind", title)
    assert len(rows) == 1 + count
    assert all(about[:1].isupper() for about, _ in rows)


def test_an_unknown_parameter_has_no_row():
    assert len(checksum_rows(CRC, init=None)[1]) == len(VALUES)
    assert len(checksum_rows(SUM, init=0)[1]) == 4


def test_the_check_value_is_hexadecimal_and_may_be_unknown():
    assert [checksum_rows(CRC, check)[0] for check in (0x29B1, 0, None)] == [
        "0x29B1",
        "0x0",
        "",
    ]


def test_seeds_are_listed_by_message():
    _, rows = checksum_rows(CRC, seeds={"Beat": 50, "Status": 7})
    assert rows[-1] == ("A byte after all others, by message", "Beat 50, Status 7")
