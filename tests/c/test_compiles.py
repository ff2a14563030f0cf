"""All generated headers compile without warnings.

The tests compile them as C and C++, with gcc and clang, for hosts and microcontrollers.
"""

from __future__ import annotations

import re
import subprocess

import pytest

from tests.c import harness
from tests.conftest import ROOT

INHERENT = {
    "padded": "members have the order of the manual",
    "declaration-after-statement": "C99 allows it, and values are constant from their declaration on",
    "covered-switch-default": "received values may be unknown; -Wswitch-default and MISRA 16.4 require a default",
    "unused-macros": "other sources include this source and use them",
    "unreachable-code": "handles kinds of parts that no link of the program uses; a compiler removes it",
}
"""Warnings of clang that C99 of this kind cannot avoid, or that contradict others, and
the reason for each.
"""


@pytest.fixture(scope="module")
def headers(tmp_path_factory):
    return harness.generate(harness.shipped(), tmp_path_factory.mktemp("headers"))


@pytest.mark.parametrize(("compiler", "standard"), harness.LANGUAGES)
def test_all_headers_compile_without_a_warning(headers, compiler, standard):
    harness.compile_all(harness.shipped(), headers, compiler, standard)


@pytest.mark.parametrize(
    ("compiler", "standard"), [("gcc", "c99"), ("clang", "c99"), ("g++", "c++17")]
)
@pytest.mark.parametrize(
    "option", ["-DICDGEN_PORTABLE", "-O2", "-Os", "-fsanitize=address,undefined"]
)
def test_all_headers_compile_without_a_warning_in_other_settings(
    headers, compiler, standard, option
):
    harness.compile_all(harness.shipped(), headers, compiler, standard, option, "-c")


@pytest.mark.parametrize("option", ["-O1", "-O2", "-O3", "-Os"])
@pytest.mark.parametrize("compiler", ["gcc", "clang"])
def test_calls_of_all_functions_compile_without_a_warning_of_the_optimiser(
    headers, tmp_path, compiler, option
):
    source = tmp_path / "used.c"
    source.write_text(harness.wrappers(harness.shipped()))
    more = ("-Wstringop-overflow=4", "-Warray-bounds=2") if compiler == "gcc" else ()
    options = (
        "-std=c99",
        option,
        "-D_FORTIFY_SOURCE=2",
        *harness.WARNINGS,
        *more,
        "-c",
        f"-I{headers}",
    )
    harness.compile(source, *options, compiler=compiler)


def test_every_header_can_be_included_alone(headers):
    for header in sorted(headers.rglob("*.h")):
        harness.compile(header, "-std=c99", "-fsyntax-only", "-Werror", "-xc")


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
def test_the_option_no_double_avoids_floating_point_registers(headers, compiler):
    harness.compile_all(
        harness.shipped(),
        headers,
        compiler,
        "c99",
        "-DICDGEN_NO_DOUBLE",
        "-mgeneral-regs-only",
        "-O2",
        "-c",
    )


def test_the_option_no_double_removes_all_floating_point_arithmetic(headers, tmp_path):
    source = tmp_path / "all.c"
    source.write_text(
        "".join(f'#include "{node.name}.h"\n' for node in harness.shipped().nodes)
    )
    done = subprocess.run(
        ["gcc", "-std=c99", "-E", "-P", "-DICDGEN_NO_DOUBLE", f"-I{headers}", source],
        capture_output=True,
        text=True,
    )
    without_members = re.sub(r"(?m)^ *(?:double|float) \w+;$", "", done.stdout)
    assert without_members != done.stdout
    bits = re.findall(
        r"(?:double|float) \*value|\b(?:double|float) icd_f\d\d_of", done.stdout
    )  # copied, not computed
    compared = re.findall(
        r"icd_is_special_f\d\d\((?:double|float) value, (?:double|float) special\)",
        done.stdout,
    )
    everywhere = re.findall(r"\b(?:double|float)\b", without_members)
    assert len(bits) + 2 * len(compared) == len(everywhere) == 10


@pytest.mark.parametrize(
    "shared", [(), ("-DICDGEN_SHARED",)], ids=["header only", "shared"]
)
def test_clang_reports_nothing_with_all_of_its_warnings(headers, tmp_path, shared):
    source = tmp_path / "everything.c"
    source.write_text(
        "".join(f'#include "{node.name}.h"\n' for node in harness.shipped().nodes)
    )
    wide = tmp_path / "wide.c"  # no formula of the shipped ICDs uses this header
    wide.write_text(f'#include "{ROOT / "runtime" / "c" / "icdgen_wide.h"}"\n')
    flags = (
        "-std=c99",
        "-Weverything",
        *(f"-Wno-{name}" for name in INHERENT),
        "-Wno-unknown-warning-option",
        "-Werror",
    )
    for path in (source, wide, *(headers.rglob("*.c") if shared else ())):
        if path.name != "all.c":
            harness.compile(
                path, *flags, *shared, "-fsyntax-only", f"-I{headers}", compiler="clang"
            )


@pytest.mark.needs("avr-gcc")
@pytest.mark.parametrize(
    "option", ["-DICDGEN_NO_DOUBLE", "-UICDGEN_NO_DOUBLE", "-DICDGEN_SHARED"]
)
def test_all_headers_compile_without_a_warning_if_int_has_16_bits(headers, option):
    """On AVR, double may have 32 bits, which -Wdouble-promotion does not consider."""
    harness.compile_all(
        harness.shipped(),
        headers,
        "avr-gcc",
        "c99",
        "-mmcu=atmega2560",
        "-Os",
        "-c",
        option,
    )


@pytest.mark.needs("arm-none-eabi-gcc")
@pytest.mark.parametrize("cpu", ["cortex-m0", "cortex-m4", "cortex-m7"])
@pytest.mark.parametrize("option", ["-DICDGEN_NO_DOUBLE", "-UICDGEN_NO_DOUBLE"])
def test_all_headers_compile_without_a_warning_for_cortex_m(headers, cpu, option):
    cpu_options = (f"-mcpu={cpu}", "-mthumb", "-Os", "-c", "-ffreestanding", option)
    harness.compile_all(
        harness.shipped(), headers, "arm-none-eabi-gcc", "c99", *cpu_options
    )


@pytest.mark.needs("arm-none-eabi-gcc")
def test_cortex_m4_needs_at_most_12_bytes_of_code_a_field(headers, tmp_path):
    source = tmp_path / "size.c"
    source.write_text(harness.wrappers(harness.shipped()))
    fields = sum(
        len(target.message.fields) for target in harness.targets(harness.shipped())
    )
    options = ("-mcpu=cortex-m4", "-mthumb", "-Os", "-std=c99", "-c", f"-I{headers}")
    harness.compile(
        source, *options, compiler="arm-none-eabi-gcc", output=tmp_path / "size.o"
    )
    text = subprocess.run(
        ["arm-none-eabi-size", tmp_path / "size.o"], capture_output=True, text=True
    ).stdout
    assert int(text.splitlines()[1].split()[0]) <= 12 * fields
