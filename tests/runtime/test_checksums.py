"""The checksums of the runtimes are compared with the check values of the usual
catalogues.
"""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

import pytest

from icdgen.describe.links import byte_table
from icdgen.protocol.sections import Crc
from tests import links
from tests.conftest import ROOT
from tests.rust.tools import Toolchain, run

RUNTIME = ROOT / "runtime"
HERE = Path(__file__).parent


class CatalogueCrc(NamedTuple):
    """A CRC of the catalogue and its checksum of the digits 1 to 9."""

    name: str
    width: int
    polynomial: int
    init: int
    reflect_in: int
    reflect_out: int
    xor_out: int
    check: int


CATALOGUE = [
    CatalogueCrc("CRC-3/GSM", 3, 0x3, 0x0, 0, 0, 0x7, 0x4),
    CatalogueCrc("CRC-5/EPC-C1G2", 5, 0x09, 0x09, 0, 0, 0x00, 0x00),
    CatalogueCrc("CRC-5/USB", 5, 0x05, 0x1F, 1, 1, 0x1F, 0x19),
    CatalogueCrc("CRC-7/MMC", 7, 0x09, 0x00, 0, 0, 0x00, 0x75),
    CatalogueCrc("CRC-8/SMBUS", 8, 0x07, 0x00, 0, 0, 0x00, 0xF4),
    CatalogueCrc("CRC-8/MAXIM-DOW", 8, 0x31, 0x00, 1, 1, 0x00, 0xA1),
    CatalogueCrc("CRC-8/I-432-1", 8, 0x07, 0x00, 0, 0, 0x55, 0xA1),
    CatalogueCrc("CRC-12/UMTS", 12, 0x80F, 0x000, 0, 1, 0x000, 0xDAF),
    CatalogueCrc("CRC-16/XMODEM", 16, 0x1021, 0x0000, 0, 0, 0x0000, 0x31C3),
    CatalogueCrc("CRC-16/IBM-3740", 16, 0x1021, 0xFFFF, 0, 0, 0x0000, 0x29B1),
    CatalogueCrc("CRC-16/KERMIT", 16, 0x1021, 0x0000, 1, 1, 0x0000, 0x2189),
    CatalogueCrc("CRC-16/MODBUS", 16, 0x8005, 0xFFFF, 1, 1, 0x0000, 0x4B37),
    CatalogueCrc("CRC-16/IBM-SDLC", 16, 0x1021, 0xFFFF, 1, 1, 0xFFFF, 0x906E),
    CatalogueCrc("CRC-24/OPENPGP", 24, 0x864CFB, 0xB704CE, 0, 0, 0x000000, 0x21CF02),
    CatalogueCrc(
        "CRC-32/ISO-HDLC", 32, 0x04C11DB7, 0xFFFFFFFF, 1, 1, 0xFFFFFFFF, 0xCBF43926
    ),
]
DIGITS = b"123456789"


@pytest.mark.parametrize("crc", CATALOGUE, ids=lambda crc: crc.name)
def test_python(crc):
    code = "import json, sys; from icdgen_runtime.wire.crc import Crc; from icdgen_runtime.wire.link import CrcForm\n"
    code += "form = CrcForm(*json.loads(sys.argv[1]), None)\n"
    code += f"whole = Crc(form).feed({DIGITS!r}).result()\n"
    code += f"assert whole == Crc(form, table=False).feed({DIGITS[:4]!r}).feed({DIGITS[4:]!r}).result()\nprint(whole)"
    command = [sys.executable, "-B", "-c", code, json.dumps(crc[1:7])]
    done = subprocess.run(
        command, cwd=RUNTIME / "python", check=True, capture_output=True, text=True
    )
    assert int(done.stdout) == crc.check


@pytest.mark.parametrize("crc", CATALOGUE, ids=lambda crc: crc.name)
def test_the_reference(crc):
    assert (
        links.crc(
            Crc(*crc[1:4], bool(crc.reflect_in), bool(crc.reflect_out), crc.xor_out),
            DIGITS,
        )
        == crc.check
    )


@pytest.mark.parametrize(
    "width, polynomial", [(3, 0x3), (7, 0x09), (12, 0x80F), (32, 0x04C11DB7)]
)
def test_the_tables_of_generated_c(width, polynomial):
    plain = Crc(width, polynomial, 0, False, False, 0)
    assert byte_table(plain) == [links.crc(plain, bytes([byte])) for byte in range(256)]


@pytest.fixture(scope="module")
def c_program(tmp_path_factory) -> Path:
    program = tmp_path_factory.mktemp("c") / "crc"
    checked = ("-fsanitize=address,undefined", "-fno-sanitize-recover=all")
    options = (
        "-std=c99",
        "-Wall",
        "-Wextra",
        "-Werror",
        "-DICDGEN_SHARED",
        *checked,
        "-I",
        RUNTIME / "c",
    )
    run(
        "gcc", *options, HERE / "crc.c", RUNTIME / "c" / "wire" / "crc.c", "-o", program
    )
    return program


@pytest.fixture(scope="module")
def rust_program(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("rust")
    toolchain = Toolchain("default")
    options = (
        "--crate-type",
        "lib",
        "--crate-name",
        "icdgen_runtime",
        "--out-dir",
        folder,
    )
    run("rustc", "--edition", "2021", *options, RUNTIME / "rust" / "src" / "lib.rs")
    extern = f"icdgen_runtime={folder / 'libicdgen_runtime.rlib'}"
    run(
        "rustc",
        "--edition",
        "2021",
        "-D",
        "warnings",
        "--extern",
        extern,
        "-o",
        folder / "crc",
        HERE / "crc.rs",
    )
    toolchain.formatted(HERE / "crc.rs")
    return folder / "crc"


@pytest.mark.parametrize("language", ["c_program", "rust_program"])
def test_compiled(language, request):
    program = request.getfixturevalue(language)
    for crc in CATALOGUE:
        assert run(program, *map(str, crc[1:7])) == f"{crc.check}\n", crc.name
