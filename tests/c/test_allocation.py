"""Nothing in the generated C allocates: compiled whole, it asks for nothing but what
copies and compares bytes.
"""

from __future__ import annotations

import subprocess
from pathlib import Path

from tests.c import harness
from tests.c.test_units import undefined
from tests.conformance import odd

ASKED_FOR = {"memcpy", "memset", "memmove", "memcmp", "strlen"}


def asked_for(text: str, folder: Path) -> set[str]:
    """The symbols that a source, compiled with all its inline functions, has from
    elsewhere; it has no array of variable length.
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
    icd = harness.read(*odd.variable(tmp_path))
    folder = harness.generate(icd, tmp_path / "c")
    text = "".join(f'#include "{node.name}.h"\n' for node in icd.nodes)
    assert asked_for(text, folder) <= ASKED_FOR
    defined = subprocess.run(
        ["nm", folder / "unit.o"], capture_output=True, text=True, check=True
    ).stdout
    assert (
        " t ublox_telemetry_decode" in defined and " t open_counted_encode" in defined
    )


def test_an_allocation_would_be_seen(tmp_path):
    assert asked_for(
        "#include <stdlib.h>\nvoid *f(void) { return malloc(1); }\n", tmp_path
    ) == {"malloc"}
