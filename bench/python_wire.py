"""Measure the speed of the wire layer of the generated Python package: streams,
checksums, logs, CAN, and its import.

``python bench/python_wire.py [--rounds N]``
"""

from __future__ import annotations

import argparse
import random
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from importlib import import_module
from pathlib import Path

from icdgen.backends.python import PythonBackend
from icdgen.loading import load
from icdgen.render import Renderer

ROOT = Path(__file__).parent.parent
PACKAGE = "icdgen_messages"
STREAM = 2_000_000  # bytes, about


def rate(run: Callable[[], object], size: int, rounds: int) -> float:
    """Return the megabytes per second, as median of several rounds."""
    times = []
    for _ in range(rounds):
        start = time.perf_counter()
        run()
        times.append(time.perf_counter() - start)
    return size / statistics.median(times) / 1e6


def in_pieces(
    make: Callable[[], object], data: bytes, size: int
) -> Callable[[], object]:
    """Return a function that feeds a new decoder in pieces of ``size`` bytes."""
    pieces = [data[at : at + size] for at in range(0, len(data), size)]

    def run() -> None:
        feed = make().feed
        for piece in pieces:
            feed(piece)

    return run


def streams(acp, wire, rounds: int) -> None:
    """Measure the UART decoder."""
    source, link = random.Random(1), acp.LINK
    frames = {id: length for id, length in link.frames.items() if length}
    mixed, ids = [], list(frames)
    for _ in range(STREAM // 50):
        id = source.choice(ids)
        mixed.append(
            wire.uart_encode(link, bytes((id,)) + source.randbytes(frames[id]))
        )
    packet = wire.uart_encode(link, bytes((119, 0, 0)) + bytes(20))
    cases = [
        ("frames of all lengths", b"".join(mixed), len(mixed)),
        ("download packets", packet * (STREAM // len(packet)), STREAM // len(packet)),
        ("random bytes", source.randbytes(STREAM), 0),
        ("zeros", bytes(STREAM), 0),
        ("nothing but starts", b"\x1f\x7f" * (STREAM // 2), 0),
    ]
    print(
        "| UART decoder | 4096 bytes a piece, MB/s | 64 bytes, MB/s | 1 byte, MB/s | messages a second |\n|---|---|---|---|---|"
    )
    for name, data, count in cases:
        speed = {
            size: rate(
                in_pieces(lambda: wire.UartDecoder(link), data, size), len(data), rounds
            )
            for size in (4096, 64)
        }
        short = data[: STREAM // 20]
        speed[1] = rate(
            in_pieces(lambda: wire.UartDecoder(link), short, 1), len(short), rounds
        )
        each = f"{count * speed[4096] * 1e6 / len(data):,.0f}" if count else ""
        print(
            f"| {name} | {speed[4096]:.1f} | {speed[64]:.1f} | {speed[1]:.2f} | {each} |"
        )


def checksums_logs_and_can(acp, wire, rounds: int) -> None:
    """Measure checksums, logs and CAN."""
    source, link = random.Random(2), acp.LINK
    block = source.randbytes(link.files.block_bytes)
    writer = wire.LogWriter(link, bytes([255, 255, 255]) + bytes(7))
    lengths = [
        bit.length for bit in link.mask.selected(bytes([255, 255, 255]) + bytes(7))
    ]
    entry = writer.entry(1, 2, [source.randbytes(size) for size in lengths])
    log = writer.header() + entry * (1_000_000 // len(entry))
    id = max(link.frames, key=lambda id: link.frames[id])
    message = wire.CanMessage("reply", id, 1, 0, source.randbytes(link.frames[id]))
    packets = wire.can_split(link, message) * 100

    def join() -> None:
        joiner = wire.CanJoiner(link)
        for number, packet in enumerate(packets):
            joiner.feed(number, packet)

    print("\n| other | MB/s |\n|---|---|")
    read = in_pieces(lambda: wire.LogReader(link), log, 65536)
    print(
        f"| CRC-16 of a block | {rate(lambda: wire.checksum(link, 'crc16', block), len(block), rounds * 3):.1f} |"
    )
    print(
        f"| CRC-8 of 20 kB | {rate(lambda: wire.checksum(link, 'crc8', block), len(block), rounds * 3):.1f} |"
    )
    print(
        f"| log of {len(lengths)} frames an entry, 64 kB a piece | {rate(read, len(log), rounds):.1f} |"
    )
    print(
        f"| CAN packets of {link.frames[id]} bytes | {rate(join, 8 * len(packets), rounds):.2f} |"
    )


def imports(folder: str, rounds: int) -> None:
    programs = {
        "the package": f"import {PACKAGE}",
        "a node and its link": f"from {PACKAGE}.cubeacp import LINK",
        "a client": f"from {PACKAGE}.cubeacp import LINK; from {PACKAGE}.wire import Client",
    }
    times: dict[str, list[float]] = {name: [] for name in ("pass", *programs)}
    for _ in range(max(7, rounds)):
        for name in times:
            start = time.perf_counter()
            subprocess.run(
                [sys.executable, "-c", programs.get(name, "pass")],
                cwd=folder,
                check=True,
            )
            times[name].append((time.perf_counter() - start) * 1e3)
    none = statistics.median(times.pop("pass"))
    print("\n| import | ms |\n|---|---|")
    for name, values in times.items():
        print(f"| {name} | {statistics.median(values) - none:.1f} |")


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--rounds", type=int, default=5)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        for path, text in PythonBackend(PACKAGE).files(
            load([ROOT / "icd"]).icd, Renderer("python")
        ):
            (Path(folder) / path).parent.mkdir(parents=True, exist_ok=True)
            (Path(folder) / path).write_text(text, encoding="utf-8")
        sys.path.insert(0, folder)
        acp, wire = (
            import_module(f"{PACKAGE}.cubeacp"),
            import_module(f"{PACKAGE}.wire"),
        )
        print(f"Python {sys.version.split()[0]}, medians of {options.rounds} rounds\n")
        streams(acp, wire, options.rounds)
        checksums_logs_and_can(acp, wire, options.rounds)
        imports(folder, options.rounds)


if __name__ == "__main__":
    main()
