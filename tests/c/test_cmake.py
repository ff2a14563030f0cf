"""The CMake module builds `examples/cmake`, and rebuilds what a changed ICD affects."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tests.c import harness

ROOT = harness.HERE.parent.parent
GENERATORS = [
    name
    for name, tool in (("Unix Makefiles", "make"), ("Ninja", "ninja"))
    if shutil.which(tool)
]

pytestmark = pytest.mark.needs("cmake")


def run(*command: str | Path, status: int = 0) -> str:
    environment = {**os.environ, "PYTHONPATH": str(ROOT / "codegen")}
    done = subprocess.run(
        [*map(str, command)], capture_output=True, text=True, env=environment
    )
    assert done.returncode == status, done.stdout + done.stderr
    return done.stdout + done.stderr


def configure(source: Path, build: Path, generator: str) -> None:
    command = f"-DICDGEN_COMMAND={sys.executable};-m;icdgen"
    run("cmake", "-G", generator, "-S", source, "-B", build, command)


@pytest.mark.parametrize("generator", GENERATORS)
def test_the_example_decodes_a_frame(tmp_path, generator):
    configure(ROOT / "examples" / "cmake", tmp_path, generator)
    run("cmake", "--build", tmp_path)
    assert run(tmp_path / "decode", "146", "2efb0a000000") == (
        "Estimated Attitude Angles: roll -12.34, pitch 0.1, yaw 0 deg\n"
    )
    assert (
        run(tmp_path / "decode", "146", "2efb", status=1)
        == "Estimated Attitude Angles has 6 bytes, 2 given\n"
    )
    assert run(tmp_path / "decode", "77", "00", status=1) == "no telemetry 77\n"


INSTALLED = """\
cmake_minimum_required(VERSION 3.20)
project(installed C)
include(icdgen)
icdgen_add_library(wheel LANG c ICDS wheel.yaml)
add_executable(program main.c)
target_link_libraries(program PRIVATE wheel)
"""
USER = """\
cmake_minimum_required(VERSION 3.20)
project(user C)
include("{module}")
icdgen_add_library("messages" LANG c ICDS "my icd/device.yaml" OUT generated)
add_library(one OBJECT one.c)
target_link_libraries(one PRIVATE messages)
add_library(two OBJECT two.c)
target_link_libraries(two PRIVATE messages)
"""
NODE = """\
icdgen: 1
node: {{name: {name}, title: {name}, byte_order: little, bit_order: lsb0}}
include: [{include}]
messages:
  - name: {message}
    id: {id}
    kind: telemetry
    length: 1
    fields:
      - {{at: 0, bits: 8, name: Level, type: uint}}
"""


def test_the_option_cmake_dir_prints_the_folder_of_the_module(tmp_path):
    """A project of a user who installed icdgen is configured as the README shows."""
    folder = run(sys.executable, "-m", "icdgen", "--cmake-dir").strip()
    (tmp_path / "wheel.yaml").write_text(
        NODE.format(name="wheel", include="", message="Speed", id=1)
    )
    (tmp_path / "CMakeLists.txt").write_text(INSTALLED)
    (tmp_path / "main.c").write_text(
        '#include "wheel.h"\nint main(void) { return 0; }\n'
    )
    command = f"-DICDGEN_COMMAND={sys.executable};-m;icdgen"
    run(
        "cmake",
        f"-DCMAKE_MODULE_PATH={folder}",
        "-S",
        tmp_path,
        "-B",
        tmp_path / "build",
        command,
    )
    run("cmake", "--build", tmp_path / "build")


@pytest.mark.parametrize("generator", GENERATORS)
def test_a_changed_icd_rebuilds_only_the_affected_sources(tmp_path, generator):
    icds = tmp_path / "my icd"
    icds.mkdir()
    (tmp_path / "CMakeLists.txt").write_text(
        USER.format(module=(ROOT / "cmake" / "icdgen.cmake").as_posix())
    )
    (icds / "device.yaml").write_text(
        NODE.format(name="device", include="shared.yaml", message="One", id=1)
    )
    (icds / "shared.yaml").write_text(
        NODE.format(name="shared", include="", message="Two", id=2)
    )
    (tmp_path / "one.c").write_text('#include "device/one.h"\ndevice_one_t one;\n')
    (tmp_path / "two.c").write_text('#include "shared/two.h"\nshared_two_t two;\n')
    build = tmp_path / "build"
    configure(tmp_path, build, generator)
    first = run("cmake", "--build", build)
    assert "Generating messages" in first and "one.c" in first and "two.c" in first
    second = run("cmake", "--build", build)
    assert "one.c" not in second and "two.c" not in second

    time.sleep(1.1)  # Make compares times in whole seconds on some file systems
    shared = icds / "shared.yaml"
    shared.write_text(shared.read_text().replace("Level", "Height"))
    changed = run("cmake", "--build", build)
    assert (
        "Generating messages" in changed
        and "two.c" in changed
        and "one.c" not in changed
    )
    same = run("cmake", "--build", build)
    assert "Generating" not in same and "one.c" not in same and "two.c" not in same


def test_an_invalid_icd_stops_the_build_with_the_error_of_icdgen(tmp_path):
    icds = tmp_path / "my icd"
    icds.mkdir()
    (tmp_path / "CMakeLists.txt").write_text(
        USER.format(module=(ROOT / "cmake" / "icdgen.cmake").as_posix())
    )
    (icds / "device.yaml").write_text(
        NODE.format(name="device", include="", message="One", id=1).replace(
            "bits: 8", "bits: 9"
        )
    )
    for name in ("one.c", "two.c"):
        (tmp_path / name).write_text("int unused;\n")
    build = tmp_path / "build"
    configure(tmp_path, build, GENERATORS[0])
    environment = {**os.environ, "PYTHONPATH": str(ROOT / "codegen")}
    done = subprocess.run(
        ["cmake", "--build", build], capture_output=True, text=True, env=environment
    )
    assert done.returncode != 0
    assert (
        "device.yaml:" in done.stdout + done.stderr
        and "Level" in done.stdout + done.stderr
    )
