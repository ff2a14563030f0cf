"""Measure the code size of one more translation unit with a client, on a Cortex-M4 with
-Os.

Usage::

    python bench/c_units.py [--cc arm-none-eabi-gcc]

The unit includes the header of a node, starts a client on the UART, requests a frame,
sends, receives and decodes it. It is compiled once with its own functions and tables,
and once with ICDGEN_SHARED, where `icdgen_wire.c` and `link.c` contain them. Complete
programs of this kind follow for each bus, linked with --gc-sections, with the memory
functions of the C library and without start-up code: with the tables of all messages,
with lookup tables of checksums too, and with only the requested message; each as one
unit, and with ICDGEN_SHARED. The last lines are a client of a framed link, which sends
a request each second.
"""

from __future__ import annotations

import argparse
import subprocess
import tempfile
from pathlib import Path

from icdgen.backends.c import CBackend
from icdgen.loading import load
from icdgen.render import Renderer

BENCH = Path(__file__).parent
UNIT = """\
#include "cubeacp.h"

icd_status_t unit_begin(cubeacp_client_t *client, uint8_t *buffer, size_t size, uint32_t now);
bool unit_send(icd_client_t *client, uint8_t *bytes, size_t capacity, size_t *count);
void unit_receive(icd_client_t *client, uint32_t now, const uint8_t *bytes, size_t count);
int32_t unit_roll;

icd_status_t unit_begin(cubeacp_client_t *client, uint8_t *buffer, size_t size, uint32_t now)
{
    static icd_slot_t slots[1];
    const icd_status_t status = cubeacp_client_uart(client, slots, 1, buffer, size);
    return status != ICD_OK ? status : cubeacp_request_estimated_attitude_angles(client, now);
}

bool unit_send(icd_client_t *client, uint8_t *bytes, size_t capacity, size_t *count)
{
    return icd_client_output(client, bytes, capacity, count);
}

static void on_event(void *context, const icd_event_t *event)
{
    cubeacp_estimated_attitude_angles_t angles;
    (void)context;
    if (cubeacp_receive_estimated_attitude_angles(&angles, event) == ICD_OK) {
        unit_roll = angles.estimated_roll_angle;
    }
}

void unit_receive(icd_client_t *client, uint32_t now, const uint8_t *bytes, size_t count)
{
    icd_client_received(client, now, bytes, count, on_event, NULL);
}
"""
OUTPUT = {
    "uart": (
        "uint8_t bytes[32]; size_t count;",
        "icd_client_output(&acp.client, bytes, sizeof bytes, &count)",
        "(uintptr_t)bytes + count",
    ),
    "i2c": (
        "const uint8_t *bytes; size_t count, read;",
        "icd_client_transfer(&acp.client, &bytes, &count, &read)",
        "(uintptr_t)bytes + count + read",
    ),
    "can": (
        "icd_can_packet_t packet;",
        "icd_client_next_packet(&acp.client, &packet)",
        "packet.id + packet.data[0]",
    ),
}
INPUT = {
    "uart": "icd_client_received(&acp.client, 1, (const uint8_t *)port, *port, on_event, NULL)",
    "i2c": "icd_client_transferred(&acp.client, 1, (const uint8_t *)port, *port, on_event, NULL)",
    "can": "icd_client_packet(&acp.client, 1, (const icd_can_packet_t *)port, on_event, NULL)",
}
PROGRAM = """\
#include "cubeacp.h"
int32_t program_roll;
static void on_event(void *context, const icd_event_t *event)
{{
    cubeacp_estimated_attitude_angles_t angles;
    (void)context;
    if (cubeacp_receive_estimated_attitude_angles(&angles, event) == ICD_OK) {{
        program_roll = angles.estimated_roll_angle;
    }}
}}
void program(volatile uint32_t *place);
void program(volatile uint32_t *place)
{{
    static cubeacp_client_t acp;
    static icd_slot_t slots[1];
    static uint8_t buffer[CUBEACP_CLIENT_BYTES];
    const uint32_t *const port = (const uint32_t *)(uintptr_t)place;
    {declared}
    (void)cubeacp_client_{bus}(&acp, {address}slots, 1, buffer, sizeof buffer);
    (void)cubeacp_request_estimated_attitude_angles(&acp, 0);
    while ({output}) {{
        *place = (uint32_t)({used});
    }}
    {input};
}}
"""
FRAMED = """\
#include "receiver.h"
uint32_t program_time;
static void on_event(void *context, const icd_event_t *event)
{
    receiver_navigation_clock_t clock;
    (void)context;
    if (receiver_receive_navigation_clock(&clock, event) == ICD_OK) {
        program_time = clock.time_of_week;
    }
}
void program(volatile uint32_t *place);
void program(volatile uint32_t *place)
{
    static receiver_client_t client;
    static icd_slot_t slots[1];
    static uint8_t buffer[RECEIVER_CLIENT_BYTES];
    uint8_t line[RECEIVER_LINE_BYTES];
    size_t count = 0;
    uint32_t next = 0;
    (void)receiver_client_init(&client, slots, 1, buffer, sizeof buffer);
    for (;;) {
        const uint32_t now = *place;
        const uint8_t byte = (uint8_t)*place;
        if (now - next < 0x80000000u) {
            next += 1000u;
            (void)receiver_request_navigation_clock(&client, now);
        }
        icd_client_received(&client.client, now, &byte, 1, on_event, NULL);
        while (icd_client_output(&client.client, line, sizeof line, &count)) {
            *place = (uint32_t)((uintptr_t)line + count);
        }
    }
}
"""
CHOSEN = (
    "-DCUBEACP_CHOSEN",
    "-DCUBEACP_WITH_ESTIMATED_ATTITUDE_ANGLES",
    "-DICDGEN_NO_FILES",
    "-DICDGEN_NO_LOGS",
)
WAYS = {"header only": [], "ICDGEN_SHARED": ["-DICDGEN_SHARED"]}
LIBRARY = {"memcpy", "memmove", "memset", "memcmp", "strlen"}


def text_bytes(cc: str, folder: Path, source: str, *options: str) -> int:
    """Return the bytes of code and constants of the object file of a source."""
    flags = [
        "-std=c99",
        "-Os",
        *(["-mcpu=cortex-m4", "-mthumb"] if "arm" in cc else []),
        *options,
    ]
    subprocess.run(
        [
            cc,
            *flags,
            f"-I{folder}",
            "-c",
            str(folder / source),
            "-o",
            str(folder / "unit.o"),
        ],
        check=True,
    )
    return int(tool(cc, "size", str(folder / "unit.o")).splitlines()[1].split()[0])


def linked(cc: str, folder: Path, program: str, shared: str, *options: str) -> str:
    """Return the bytes of code and constants of a linked program, and how many of them
    are functions of the C library. `shared`: folder with `link.c`; empty: one unit.
    """
    flags = [
        "-std=c99",
        "-Os",
        "-ffunction-sections",
        "-fdata-sections",
        f"-I{folder}",
        *options,
        *(["-DICDGEN_SHARED"] if shared else []),
    ]
    target = (
        ["-mcpu=cortex-m4", "-mthumb", "-nostartfiles"]
        if "arm" in cc
        else ["-nostartfiles", "-static"]
    )
    names = [program, *(["icdgen_wire.c", f"{shared}/link.c"] if shared else [])]
    sources = [str(folder / name) for name in names]
    out = str(folder / "program.elf")
    subprocess.run(
        [cc, *flags, *target, "-Wl,--gc-sections,-e,program", *sources, "-o", out],
        check=True,
    )
    symbols = tool(cc, "nm", "-S", out).splitlines()
    library = sum(
        int(row.split()[1], 16) for row in symbols if row.split()[-1] in LIBRARY
    )
    text = int(tool(cc, "size", out).splitlines()[1].split()[0])
    return f"{text} bytes, {library} of them functions of the C library"


def tool(cc: str, name: str, *arguments: str) -> str:
    """Return the output of a tool that belongs to a compiler."""
    path = cc.removesuffix("gcc") + name if cc.endswith("-gcc") else name
    return subprocess.run(
        [path, *arguments], check=True, capture_output=True, text=True
    ).stdout


def bus_program(bus: str) -> str:
    """Return a program with a client on a bus."""
    declared, output, used = OUTPUT[bus]
    address = "1, " if bus == "can" else ""
    return PROGRAM.format(
        bus=bus,
        declared=declared,
        output=output,
        used=used,
        input=INPUT[bus],
        address=address,
    )


def generate(icd: Path, folder: Path) -> None:
    """Write the C of an ICD into a folder."""
    for path, text in CBackend().files(load([icd], check=False).icd, Renderer("c")):
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / path).write_text(text, encoding="utf-8")


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--cc", default="arm-none-eabi-gcc")
    cc = parser.parse_args().cc
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        generate(BENCH.parent / "icd", folder)
        (folder / "unit.c").write_text(UNIT, encoding="utf-8")
        for way, options in WAYS.items():
            print(
                f"a unit with a client, {way}: {text_bytes(cc, folder, 'unit.c', *options)} bytes"
            )
        for source in ("icdgen_wire.c", "cubeacp/link.c"):
            if (folder / source).exists():
                print(f"{source}, once: {text_bytes(cc, folder, source)} bytes")
        for bus in OUTPUT:
            (folder / "program.c").write_text(bus_program(bus), encoding="utf-8")
            for options in ((), ("-DICDGEN_TABLES",), CHOSEN):
                for way, shared in (("one unit", ""), ("ICDGEN_SHARED", "cubeacp")):
                    size = linked(cc, folder, "program.c", shared, *options)
                    print(f"a program on {bus}, {way} {' '.join(options)}: {size}")
        framed = folder / "framed"
        generate(BENCH.parent / "examples" / "links" / "ubx.yaml", framed)
        (framed / "program.c").write_text(FRAMED, encoding="utf-8")
        for option in ("-UICDGEN_TABLES", "-DICDGEN_TABLES"):
            bytes = text_bytes(cc, framed, "program.c", option)
            print(f"a client of a framed link {option}: {bytes} bytes")
        for way, shared in (("one unit", ""), ("ICDGEN_SHARED", "receiver")):
            size = linked(cc, framed, "program.c", shared)
            print(f"a program on a framed link, {way}: {size}")


if __name__ == "__main__":
    main()
