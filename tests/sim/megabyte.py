"""A megabyte down and a megabyte up with 0, 1, 10 and 30 % of the packets lost, over TCP: byte for byte.

python -m tests.sim.megabyte [--size 1048576] [--loss 0,1,10,30] [--way tcp|pty|udp]
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from pathlib import Path
from random import Random

from icdgen.protocol import transfer
from tests.sim.device import download, session


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--size", type=int, default=1 << 20)
    parser.add_argument("--loss", default="0,1,10,30")
    parser.add_argument("--way", choices=["tcp", "pty", "udp"], default="tcp")
    options = parser.parse_args()
    good = True
    for loss in options.loss.split(","):
        good &= run(options.way, options.size, loss)
    return 0 if good else 1


def run(way: str, size: int, loss: str) -> bool:
    data = Random(loss).randbytes(size)
    listen = ("--pty",) if way == "pty" else (f"--{way}", "0")
    with tempfile.TemporaryDirectory() as folder:
        stored = Path(folder, "stored")
        stored.write_bytes(data)
        words = ("--file", f"2:1={stored}", "--uploads", folder, "--loss", f"{loss}%")
        with session(*listen, *words) as client:
            begin = time.monotonic()
            down = download(client, 2, 1, size) == ("done", data)
            middle = time.monotonic()
            up = client.run(transfer.Upload(client.known, 3, data)) == "done"
            up = up and Path(folder, "3.bin").read_bytes() == data
            end = time.monotonic()
    words = ["failed", "identical"]
    print(f"{loss} % lost: download {words[down]}, {middle - begin:.1f} s; upload {words[up]}, {end - middle:.1f} s")
    sys.stdout.flush()
    return down and up


if __name__ == "__main__":
    sys.exit(main())
