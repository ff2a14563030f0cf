"""Any ICD works, not only ours."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from tests.c import harness, odd
from tests.c.test_frames import assert_agrees, build


@pytest.fixture(scope="module")
def icd(tmp_path_factory):
    return harness.read(*odd.write(tmp_path_factory.mktemp("icd")))


def test_any_order_width_and_place_agrees_with_the_reference_codec(icd, tmp_path):
    program = build(icd, tmp_path)
    assert_no_differences([program])
    assert_agrees(program, icd)


def test_portable_code_agrees_too(icd, tmp_path):
    assert_no_differences([build(icd, tmp_path, "-DICDGEN_PORTABLE")])


@pytest.mark.needs("qemu-s390x", "s390x-linux-gnu-gcc")
def test_big_endian_machines_agree_too(icd, tmp_path):
    harness.generate(icd, tmp_path)
    source = tmp_path / "frames.c"
    source.write_text(harness.frames_source(icd))
    options = ("-std=c99", "-O1", "-static", f"-I{tmp_path}", f"-I{harness.HERE}")
    program = harness.compile(
        source, *options, compiler="s390x-linux-gnu-gcc", output=tmp_path / "frames"
    )
    assert_no_differences(["qemu-s390x", program])


def assert_no_differences(program: list[str | Path]) -> None:
    done = subprocess.run(
        [*program, "random", "200", "11"], capture_output=True, text=True
    )
    assert done.returncode == 0, (done.stdout + done.stderr)[-4000:]


@pytest.mark.parametrize(("compiler", "standard"), harness.LANGUAGES)
def test_text_from_the_icd_breaks_out_of_nothing(icd, tmp_path, compiler, standard):
    harness.generate(icd, tmp_path)
    harness.compile_all(icd, tmp_path, compiler, standard, "-Wtrigraphs", "-Wcomment")


def test_names_of_the_manual_come_back_to_the_letter(icd, tmp_path):
    harness.generate(icd, tmp_path)
    calls = "".join(
        f"    puts(hostile_telemetry_name({n})); putchar(1);\n"
        for n in range(len(odd.HOSTILE))
    )
    source = tmp_path / "names.c"
    source.write_text(
        f'#include "hostile.h"\n#include <stdio.h>\nint main(void)\n{{\n{calls}    return 0;\n}}\n'
    )
    program = harness.compile(
        source,
        "-std=c99",
        "-Werror",
        "-Wall",
        f"-I{tmp_path}",
        output=tmp_path / "names",
    )
    out = subprocess.run([program], capture_output=True).stdout.decode("utf-8")
    assert out.split("\n\x01")[:-1] == odd.HOSTILE
