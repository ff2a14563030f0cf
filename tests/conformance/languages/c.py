"""C: with gcc, with clang, and for a big-endian machine."""

from __future__ import annotations

from functools import partial
from pathlib import Path

from tests.conformance.build import execute
from tests.conformance.languages import Language

WARNINGS = "-Wall -Wextra -Wpedantic -Wconversion -Wsign-conversion -Wshadow -Wcast-align -Wstrict-prototypes -Werror".split()
BACKENDS = ("c", "c-testee")


def build(
    source: Path,
    out: Path,
    compiler: str,
    flags: tuple[str, ...] = (),
    start: tuple[str, ...] = (),
) -> list[str]:
    """Compile the testee with one translation unit per node, or a single one if there
    are many small nodes.
    """
    testee = source / "c-testee"
    files = sorted(testee.rglob("*.c"))
    if len(files) > 20:
        unit = out / "testee_all.c"
        unit.write_text(
            "".join(f'#include "{file.relative_to(testee)}"\n' for file in files)
        )
        files = [unit]
    program = out / "testee"
    execute(
        compiler,
        "-std=c99",
        *WARNINGS,
        *flags,
        "-I",
        source / "c",
        "-I",
        testee,
        *files,
        "-o",
        program,
    )
    return [*start, str(program)]


# With sanitizers, optimising takes longer than the tests: 22 s instead of 6 s for the
# shipped ICDs. `c` is the optimised build.
CHECKED = ("-O0", "-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all")

LANGUAGES = [
    Language("c", BACKENDS, ("gcc",), partial(build, compiler="gcc", flags=("-O2",))),
    Language("c-clang", BACKENDS, ("clang",), partial(build, compiler="clang", flags=("-O2",))),
    Language("c-sanitizers", BACKENDS, ("gcc",), partial(build, compiler="gcc", flags=CHECKED)),
    Language("c-portable", BACKENDS, ("gcc",), partial(build, compiler="gcc", flags=("-Os", "-DICDGEN_PORTABLE"))),
    Language(
        "c-s390x", BACKENDS, ("s390x-linux-gnu-gcc", "qemu-s390x"),
        partial(build, compiler="s390x-linux-gnu-gcc", flags=("-O1", "-static"), start=("qemu-s390x",)),
    ),
]  # fmt: skip
