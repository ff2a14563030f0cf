"""The examples of the guide to drivers in C compile and run.

The main loop runs on a UART driver that the test provides.
"""

from __future__ import annotations

import subprocess
import sys
from urllib.parse import urlsplit

import pytest

from tests import documents
from tests.c import harness
from tests.conformance import ROOT
from tests.conformance.icds import read_unchecked
from tests.sim.device import simulator

EXAMPLE = ROOT / "examples" / "loop.c"
DRIVER = r"""
#define main loop_main
#include "%s"
#undef main
#include "port.h"

static int connection;

uint32_t milliseconds(void) { return port_now(); }

size_t uart_read(uint8_t *bytes, size_t capacity)
{
    struct pollfd ready = {connection, POLLIN, 0};
    ssize_t count;
    fflush(stdout);
    if (poll(&ready, 1, 1) <= 0) { return 0; }
    count = read(connection, bytes, capacity);
    if (count <= 0) { exit(0); }
    return (size_t)count;
}

void uart_write(const uint8_t *bytes, size_t count)
{
    if (write(connection, bytes, count) != (ssize_t)count) { exit(1); }
}

int main(int argc, char **argv)
{
    connection = port_open("127.0.0.1", argc > 1 ? argv[1] : "4000");
    return loop_main();
}
"""


@pytest.fixture(scope="module")
def program(tmp_path_factory):
    folder = tmp_path_factory.mktemp("loop")
    headers = harness.generate(harness.shipped(), folder)
    source = folder / "driver.c"
    source.write_text(DRIVER % EXAMPLE)
    flags = (
        "-std=c99",
        "-D_POSIX_C_SOURCE=200809L",
        *harness.WARNINGS,
        *harness.SANITIZERS,
    )
    return harness.compile(
        source, *flags, f"-I{headers}", f"-I{EXAMPLE.parent}", output=folder / "loop"
    )


def test_the_loop_requests_an_angle_each_second(program):
    angle = ("--set", "Estimated Attitude Angles", "roll=12.5")
    with (
        simulator("--node", "cubeacp", "--tcp", "0", *angle) as (address, _),
        subprocess.Popen(
            [program, str(urlsplit(address).port)], stdout=subprocess.PIPE, text=True
        ) as process,
    ):
        lines = [process.stdout.readline() for _ in range(2)]
        process.kill()
    assert lines == ["roll 12.50 deg\n"] * 2


def test_the_guide_shows_the_loop():
    assert EXAMPLE.read_text(encoding="utf-8").partition("*/\n")[2] in documents.text(
        "guides/driver-in-c"
    )


def test_the_first_lines_of_the_guide_decode_and_encode(tmp_path):
    lines = documents.blocks(documents.text("guides/driver-in-c"), "c")[0]
    include, _, body = lines.partition("\n")
    source = tmp_path / "lines.c"
    source.write_text(
        f"{include}\nbool use(uint8_t id, const uint8_t *data, size_t length);\n"
        f"bool use(uint8_t id, const uint8_t *data, size_t length)\n{{\n{body}return temperature > raw && buffer[0] == 1u;\n}}\n"
    )
    for command in (("init", "heater"), ("--lang", "c")):
        subprocess.run(
            [sys.executable, "-m", "icdgen", *command],
            cwd=tmp_path,
            check=True,
            capture_output=True,
        )
    harness.compile(
        source,
        "-std=c99",
        "-Wall",
        "-Wextra",
        "-c",
        f"-I{tmp_path / 'generated' / 'c'}",
        output=tmp_path / "o",
    )


def test_the_unit_test_of_the_guide_passes(tmp_path):
    section = documents.text("guides/driver-in-c").split(
        "## Play the device in your tests"
    )[1]
    (code,) = documents.blocks(section, "c")
    source = tmp_path / "test_meter.c"
    source.write_text(code)
    headers = harness.generate(
        read_unchecked(ROOT / "examples" / "links" / "modbus.yaml"), tmp_path
    )
    flags = ("-std=c99", *harness.WARNINGS, *harness.SANITIZERS, f"-I{headers}")
    program = harness.compile(source, *flags, output=tmp_path / "test_meter")
    subprocess.run([program], check=True)
