"""Checksums of the runtime have the values of the catalogues and of their parameters."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st
from icdgen_runtime.wire.checks import checksum
from icdgen_runtime.wire.crc import Crc
from icdgen_runtime.wire.errors import UnsupportedError
from icdgen_runtime.wire.link import ChecksumAlgorithm, CrcForm

from icdgen.icd.checksum import plain
from tests import links
from tests.protocol import cut

NAMES = ("crc8", "crc16")
CATALOGUE = [
    (CrcForm(8, 0x07, 0, False, False, 0), 0xF4),  # CRC-8/SMBUS
    (CrcForm(16, 0x1021, 0xFFFF, False, False, 0), 0x29B1),  # CRC-16/IBM-3740
    (CrcForm(16, 0x8005, 0, True, True, 0), 0xBB3D),  # CRC-16/ARC
    (
        CrcForm(32, 0x04C11DB7, 0xFFFFFFFF, True, True, 0xFFFFFFFF),
        0xCBF43926,
    ),  # CRC-32/ISO-HDLC
]


def forms_of(width: int) -> st.SearchStrategy[CrcForm]:
    numbers, flags = st.integers(0, (1 << width) - 1), st.booleans()
    return st.builds(
        CrcForm, st.just(width), numbers, numbers, flags, flags, numbers, st.none() | numbers
    )  # fmt: skip


FORMS = st.integers(1, 32).flatmap(forms_of) | st.sampled_from(
    [form for form, _ in CATALOGUE]
)


@pytest.mark.parametrize("form, check", CATALOGUE)
def test_the_check_values_of_the_catalogues(form, check):
    assert Crc(form).feed(b"123456789").result() == check


def test_the_check_values_of_the_node(link):
    assert [checksum(link, name, b"123456789") for name in NAMES] == [0x25, 0x31C3]


def test_no_bytes_at_all_have_the_value_that_the_icd_gives(link):
    assert [checksum(link, name, b"") for name in NAMES] == [0xFF, 0]


@given(
    form=FORMS,
    data=st.binary(max_size=40),
    places=st.lists(st.integers(0, 40), max_size=4),
    table=st.booleans(),
)
def test_crcs_of_all_parameters_with_and_without_a_table_in_pieces(
    form, data, places, table
):
    register = Crc(form, table)
    for piece in cut(data, places):
        register.feed(piece)
    assert register.result() == links.crc(form, data)


@given(data=st.binary(max_size=300))
def test_the_crcs_of_the_node_are_those_of_its_parameters(link, data):
    for name in NAMES:
        assert checksum(link, name, data) == links.crc(link.checksums[name].crc, data)


@pytest.mark.parametrize("kind", ["fletcher", "fletcher_255", "sum", "xor"])
@given(data=st.binary(max_size=300), half=st.integers(0, 254))
def test_checksums_of_other_kinds_are_computed_by_name(link, kind, data, half):
    init = half << 8 | half
    form = CrcForm(16, 0, init, False, False, 0x1234)
    other = link._replace(checksums={"other": ChecksumAlgorithm(kind, form)})
    expected = plain(kind, data, 16, init, 0x1234)
    assert checksum(other, "other", data) == expected


def test_a_checksum_that_the_icd_does_not_have_is_rejected(link):
    with pytest.raises(UnsupportedError, match="crc32"):
        checksum(link, "crc32", b"")


@given(data=st.binary(min_size=1, max_size=300))
def test_the_narrow_one_shifts_after_the_constant_is_applied(link, data):
    register = 0
    for byte in data:
        register ^= byte
        for _ in range(8):
            register = (register ^ 0x91 if register & 1 else register) >> 1
    assert checksum(link, "crc8", data) == register
