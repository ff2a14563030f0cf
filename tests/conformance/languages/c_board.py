"""The C self-test: on this machine, and on Cortex-M under QEMU with and without
floating point.
"""

from __future__ import annotations

from functools import partial
from pathlib import Path

from tests.conformance.build import BOARD, execute
from tests.conformance.languages import SELFTEST, Language
from tests.conformance.languages.c import CHECKED, WARNINGS

BACKENDS = ("c", "c-selftest")
NO_DOUBLE = "-DICDGEN_NO_DOUBLE"


def _compile(source: Path, out: Path, *compiler: str | Path) -> Path:
    selftest = source / "c-selftest"
    program = out / "selftest"
    files = [*sorted(selftest.rglob("*.c")), BOARD / "main.c"]
    execute(
        compiler[0],
        "-std=c99",
        *WARNINGS,
        *compiler[1:],
        "-I",
        source / "c",
        "-I",
        selftest,
        *files,
        "-o",
        program,
    )
    return program


def build_host(source: Path, out: Path, flags: tuple[str, ...]) -> list[str]:
    return [str(_compile(source, out, "gcc", *flags))]


def build_cortex(
    source: Path, out: Path, cpu: str, machine: str, flags: tuple[str, ...]
) -> list[str]:
    program = _compile(
        source, out, "arm-none-eabi-gcc", f"-mcpu={cpu}", "-mthumb", "-Os", "-ffunction-sections", "-fdata-sections", *flags,
        "--specs=rdimon.specs", "-Wl,--gc-sections", "-T", BOARD / "mps2.ld", BOARD / "cortex_m.c",
    )  # fmt: skip
    return [
        "qemu-system-arm",
        "-M",
        machine,
        "-nographic",
        "-monitor",
        "none",
        "-semihosting",
        "-kernel",
        str(program),
    ]


# libgcc for Thumb-2 rounds a difference of doubles wrongly where their exponents are 33
# apart; that for Cortex-M0 does not.
_TOOLS = ("arm-none-eabi-gcc", "qemu-system-arm")
M0 = partial(build_cortex, cpu="cortex-m0", machine="mps2-an385")
M3 = partial(build_cortex, cpu="cortex-m3", machine="mps2-an385")
M4 = partial(build_cortex, cpu="cortex-m4", machine="mps2-an386")

LANGUAGES = [
    Language(
        "c-selftest", BACKENDS, ("gcc",), partial(build_host, flags=CHECKED), SELFTEST
    ),
    Language(
        "c-selftest-no-double",
        BACKENDS,
        ("gcc",),
        partial(build_host, flags=(*CHECKED, NO_DOUBLE)),
        SELFTEST,
    ),
    Language("c-cortex-m0", BACKENDS, _TOOLS, partial(M0, flags=()), SELFTEST),
    Language("c-cortex-m", BACKENDS, _TOOLS, partial(M3, flags=()), SELFTEST),
    Language(
        "c-cortex-m-no-double",
        BACKENDS,
        _TOOLS,
        partial(M3, flags=(NO_DOUBLE,)),
        SELFTEST,
    ),
    Language(
        "c-cortex-m4f",
        BACKENDS,
        _TOOLS,
        partial(M4, flags=("-mfloat-abi=hard", "-mfpu=fpv4-sp-d16")),
        SELFTEST,
    ),
]
