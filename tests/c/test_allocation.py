"""The generated C does not allocate memory.

The tests compile all functions, and check that the object refers only to functions that
copy and compare bytes.
"""

from __future__ import annotations

import subprocess
from pathlib import Path

from tests.c import harness
from tests.c.test_units import undefined
from tests.conformance import odd

ALLOWED_SYMBOLS = {"memcpy", "memset", "memmove", "memcmp", "strlen"}


def undefined_symbols(text: str, folder: Path) -> set[str]:
    """Compile a source with all its inline functions and return its undefined symbols.

    Fails if the source has an array of variable length or calls ``alloca``.
    """
    (folder / "unit.c").write_text(text)
    options = (
        "-std=c99",
        "-O0",
        "-c",
        "-fno-builtin",
        "-fkeep-inline-functions",
        "-Wvla",
        "-Walloca",
        "-Werror",
    )
    return undefined(
        harness.compile(
            folder / "unit.c", *options, f"-I{folder}", output=folder / "unit.o"
        )
    )


def test_no_function_of_messages_of_variable_length_allocates(tmp_path):
    icd = harness.read_unchecked(*odd.variable(tmp_path))
    folder = harness.generate(icd, tmp_path / "c")
    text = "".join(f'#include "{node.name}.h"\n' for node in icd.nodes)
    assert undefined_symbols(text, folder) <= ALLOWED_SYMBOLS
    defined = subprocess.run(
        ["nm", folder / "unit.o"], capture_output=True, text=True, check=True
    ).stdout
    assert (
        " t ublox_telemetry_decode" in defined and " t open_counted_encode" in defined
    )


def test_the_test_finds_an_allocation(tmp_path):
    assert undefined_symbols(
        "#include <stdlib.h>\nvoid *f(void) { return malloc(1); }\n", tmp_path
    ) == {"malloc"}
