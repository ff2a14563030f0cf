"""Compare the packet decoder in C with the parser that MAVLink's generator emits, on
one stream of all messages of `common`.

Usage::

    pip install pymavlink && python bench/stream_decoders.py [--messages 2000] [--noise 0.1]

Both are generated from the same XML file, get the same bytes and must find all
messages. They are measured in instructions (valgrind) and in time, taking turns, as the
minimum of many rounds. The decoder of icdgen also reports gaps and discarded bytes. The
parser of MAVLink does not search for a frame within bytes that are no frame.
"""

from __future__ import annotations

import argparse
import random
import re
import struct
import subprocess
import sys
import tempfile
from importlib import import_module
from pathlib import Path
from typing import Any

from icdgen.backends.c import CBackend
from icdgen.definitions import kinds, run
from icdgen.icd.fmt import emit
from icdgen.loading import load
from icdgen.render import Renderer

CALLS = """\
#include <icdgen_wire.h>
#include "common.h"
#include <string.h>
unsigned long ours(const uint8_t *stream, size_t size, size_t piece);
static void on_event(void *context, const icd_event_t *event)
{
    *(unsigned long *)context += event->kind == ICD_EVENT_MESSAGE;
}
unsigned long ours(const uint8_t *stream, size_t size, size_t piece)
{
    static uint8_t buffer[COMMON_LONGEST];
    uint32_t sequences[COMMON_SEQUENCES];
    unsigned long found = 0;
    icd_stream_decoder_t decoder;
    (void)icd_stream_decoder_init(
        &decoder, common_link(), ICD_TELEMETRY, buffer, sizeof buffer, sequences, COMMON_SEQUENCES);
    for (size_t at = 0; at < size; at += piece) {
        icd_stream_feed(&decoder, stream + at, piece < size - at ? piece : size - at, on_event, &found);
    }
    return found;
}
"""
THEIRS = """\
#pragma GCC diagnostic ignored "-Waddress-of-packed-member"
#include "common/mavlink.h"
unsigned long theirs(const uint8_t *stream, size_t size, size_t piece);
unsigned long theirs(const uint8_t *stream, size_t size, size_t piece)
{
    unsigned long found = 0;
    mavlink_message_t message;
    mavlink_status_t status;
    (void)piece;
    for (size_t at = 0; at < size; ++at) {
        found += mavlink_parse_char(MAVLINK_COMM_0, stream[at], &message, &status);
    }
    return found;
}
"""
MAIN = """\
#define _POSIX_C_SOURCE 199309L
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
unsigned long ours(const uint8_t *stream, size_t size, size_t piece);
unsigned long theirs(const uint8_t *stream, size_t size, size_t piece);
typedef unsigned long decoder_t(const uint8_t *stream, size_t size, size_t piece);
static double timed(decoder_t *decode, const uint8_t *stream, size_t size, size_t piece, unsigned long *found)
{
    struct timespec start, end;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &start);
    *found = decode(stream, size, piece);
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &end);
    return (double)(end.tv_sec - start.tv_sec) + 1e-9 * (double)(end.tv_nsec - start.tv_nsec);
}
int main(int count, char **words)
{
    static uint8_t stream[1 << 22];
    const size_t size = fread(stream, 1, sizeof stream, stdin);
    const int rounds = count > 1 ? atoi(words[1]) : 1;
    double least[3] = {1e9, 1e9, 1e9};
    unsigned long found[3] = {0, 0, 0};
    for (int round = 0; round < rounds; ++round) {
        for (int which = 0; which < 3; ++which) {
            const double spent = timed(which == 2 ? theirs : ours, stream, size, which == 0 ? 1 : 4096, &found[which]);
            least[which] = spent < least[which] ? spent : least[which];
        }
    }
    printf("%zu %lu %lu %lu %g %g %g\\n", size, found[0], found[1], found[2], least[0], least[1], least[2]);
    return 0;
}
"""


def stream(dialect: Any, messages: int, noise: float, chance: random.Random) -> bytes:
    """Return frames of random messages and values, with noise between some of them.

    No noise byte starts a frame.
    """
    output = bytearray()
    kinds_of = sorted(dialect.mavlink_map.values(), key=lambda message: message.id)
    for number in range(messages):
        message = chance.choice(kinds_of)
        data = chance.randbytes(message.unpacker.size).rstrip(b"\0") or b"\0"
        head = bytes([len(data), 0, 0, number & 0xFF, 1, 1]) + message.id.to_bytes(
            3, "little"
        )
        crc = dialect.x25crc(head + data)
        crc.accumulate(bytes([message.crc_extra]))
        output += b"\xfd" + head + data + struct.pack("<H", crc.crc)
        if chance.random() < noise:
            output += bytes(chance.choices(range(0xFD), k=chance.randrange(40)))
    return bytes(output)


def build(folder: Path) -> Path:
    """Build the program with both decoders, and return its path."""
    dialect = import_module("pymavlink.dialects.v20.common")
    xml = Path(str(dialect.__file__)).with_suffix(".xml")
    (tree,) = run.read(xml, kinds.reader_of_kind("mavlink")).trees.values()
    (folder / "common.yaml").write_text(emit.canonical_yaml(tree), encoding="utf-8")
    for path, text in CBackend().files(
        load([folder / "common.yaml"]).icd, Renderer("c")
    ):
        (folder / "c" / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / "c" / path).write_text(text, encoding="utf-8")
    mavgen = [
        "--lang=C",
        "--wire-protocol=2.0",
        "--no-validate",
        f"--output={folder / 'mavlink'}",
        str(xml),
    ]
    subprocess.run(
        [sys.executable, "-m", "pymavlink.tools.mavgen", *mavgen],
        check=True,
        capture_output=True,
    )
    objects = []
    for name, text in (("calls", CALLS), ("theirs", THEIRS), ("main", MAIN)):
        (folder / f"{name}.c").write_text(text)
        include = folder / ("mavlink" if name == "theirs" else "c")
        objects.append(folder / f"{name}.o")
        standard = "gnu11" if name == "theirs" else "c99"
        options = [
            f"-std={standard}",
            "-O2",
            f"-I{include}",
            "-DICDGEN_WIRE_HEADER_ONLY",
        ]
        subprocess.run(
            ["gcc", *options, "-c", folder / f"{name}.c", "-o", objects[-1]], check=True
        )
    subprocess.run(["gcc", *objects, "-o", folder / "bench"], check=True)
    return folder / "bench"


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--messages", type=int, default=2000)
    parser.add_argument(
        "--noise", type=float, default=0.1, help="of how many frames noise follows"
    )
    parser.add_argument("--rounds", type=int, default=200)
    options = parser.parse_args()
    dialect = import_module("pymavlink.dialects.v20.common")
    data = stream(dialect, options.messages, options.noise, random.Random(1))
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        program = build(folder)
        words = subprocess.run(
            [program, str(options.rounds)], input=data, capture_output=True, check=True
        ).stdout.split()
        counts_of_messages, least = (
            [int(word) for word in words[1:4]],
            [float(word) for word in words[4:]],
        )
        out = folder / "counts"
        valgrind = [
            "valgrind",
            "--tool=callgrind",
            f"--callgrind-out-file={out}",
            str(program),
        ]
        subprocess.run(valgrind, input=data, check=True, capture_output=True)
        annotate = [
            "callgrind_annotate",
            "--inclusive=yes",
            "--threshold=100",
            str(out),
        ]
        text = subprocess.run(
            annotate, check=True, capture_output=True, text=True
        ).stdout
    counts = {
        word: int(number.replace(",", ""))
        for number, word in re.findall(r"^\s*([\d,]+) .*?:(ours|theirs)\b", text, re.M)
    }
    print(
        f"{len(data):,} bytes, {options.messages:,} messages; found {counts_of_messages}"
    )
    print(
        f"instructions a byte: ours {counts['ours'] / 2 / len(data):.1f}, MAVLink's {counts['theirs'] / len(data):.1f}"
    )
    for title, spent in zip(
        ("ours, byte by byte", "ours, pieces of 4,096", "MAVLink's"), least, strict=True
    ):
        print(
            f"{title}: {len(data) / spent / 1e6:.0f} MB/s, {least[2] / spent:.2f} times MAVLink's"
        )


if __name__ == "__main__":
    main()
