"""The C runtime computes CRCs of all widths and bit orders, with and without tables."""

from __future__ import annotations

import random
import subprocess

import pytest

from icdgen.describe.links import byte_table
from icdgen.protocol.sections import Crc
from tests import links
from tests.c import harness
from tests.conformance.icds import icd_of
from tests.conftest import ROOT

PROGRAM = """\
#include "icdgen_wire.h"
#include <stdio.h>

int main(void)
{
    static const uint8_t data[] = {%s};
    icd_crc_t crc;
%s
    return 0;
}
"""
CASE = """\
    {
        static const uint%d_t table[] = {%s};
        static const icd_crc_form_t form = {%s, false, 0u, %s};
        (void)table;
        icd_crc_init(&crc, &form);
        icd_crc_feed(&crc, data, %du);
        icd_crc_feed(&crc, data + %d, sizeof data - %du);
        printf("%%u\\n", (unsigned)icd_crc_result(&crc));
    }
"""
DATA = bytes(range(0, 256, 3)) + b"123456789"


def parameters(generator: random.Random) -> list[Crc]:
    """Return a CRC of each width and bit order."""
    return [
        Crc(width, *(generator.getrandbits(width) for _ in range(2)), into, out,
            generator.getrandbits(width))
        for width in range(1, 33)
        for into in (False, True)
        for out in (False, True)
    ]  # fmt: skip


def case(each: Crc) -> str:
    """Return the lines that print the CRC of the data, which are fed in two pieces."""
    flags = (str(flag).lower() for flag in (each.reflect_in, each.reflect_out))
    numbers = (f"{n}u" for n in (each.width, each.polynomial, each.init))
    form = ", ".join((*numbers, *flags, f"{each.xor_out}u"))
    bits = 8 if each.width <= 8 else 16
    has_table = each.width <= 16
    entries = byte_table(each) if has_table else [0]
    tables = ["NULL", "NULL"]
    if has_table:
        tables[bits // 8 - 1] = "ICDGEN_TABLE(table)"
    table = ", ".join(f"{entry}u" for entry in entries)
    cut = each.width
    return CASE % (bits, table, form, ", ".join(tables), cut, cut, cut)


@pytest.mark.parametrize("option", ["-DICDGEN_PLAIN", "-DICDGEN_NO_TABLES"])
def test_crcs_of_all_widths_and_bit_orders_are_those_of_their_parameters(
    option, tmp_path
):
    icd = icd_of([ROOT / "examples" / "links" / "wheel.yaml"])
    headers = harness.generate(icd, tmp_path / "made")
    every = parameters(random.Random(1))
    source = tmp_path / "program.c"
    data = ", ".join(f"{byte}u" for byte in DATA)
    source.write_text(PROGRAM % (data, "".join(map(case, every))))
    flags = ("-std=c99", *harness.WARNINGS, *harness.SANITIZERS, f"-I{headers}", option)
    program = harness.compile(source, *flags, output=tmp_path / "program")
    output = subprocess.run([program], capture_output=True, text=True, check=True)
    results = [int(line) for line in output.stdout.split()]
    assert results == [links.crc(each, DATA) for each in every]
