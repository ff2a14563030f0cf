"""Runs a client, of any language, against the simulator, with losses and spoiled
acknowledges.

    python -m tests.sim.harness [--size 1048576] [--loss 0,1,10,30] [--fault ...] -- CLIENT [ARGUMENT]...

CLIENT is started for each loss with three more arguments: host, TCP port, size of the
file. On that connection, which is the UART, it is expected to

1. identify the node, and end with 3 if it is not the one of its ICD,
2. request every telemetry frame,
3. set every configuration message and read it back,
4. download file 1 of type 2, which has that size,
5. send every telecommand, those that restart the node last: then the boot program answers, which the request for identification
   keeps from booting,
6. upload what it downloaded (of more than a destination holds as much as that) to destination 3,
7. have it copied to where it can run, and see that size and checksum of the copy are those of what it uploaded,
8. start it, and see that the node of its ICD identifies itself again,

and to end with 0. What it uploaded, and what runs, is held against the file, so both
directions are proved at once; every frame must have been requested, and every
telecommand sent. A telecommand that is refused for a reason that the ICD has is
answered (such as one of the file transfer for which nothing is prepared), one without
an answer is a failure; after one that restarts the node another program answers.
Acknowledges carry no checksum: a refusal with a code that the ICD does not have is a
damaged one, and worth asking again. A client that takes longer than ``--limit`` seconds
hangs, which is a failure. A client in Python is ``PYTHONPATH=generated/python python -m
tests.python.sim_client``.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from random import Random
from urllib.parse import urlsplit

from tests.sim.device import ICD, simulator
from tests.sim.tap import Tap, missing

LOSSES = "0,1,10,30"
ROOM = 524288  # bytes of a destination
RUNNING = 1  # the program after a copy
BOOT = ("--boot", "100000")  # a client that starts slowly still meets the boot program


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--size", type=int, default=1 << 20)
    parser.add_argument("--loss", default=LOSSES, help="per cent")
    parser.add_argument(
        "--fault", action="append", default=[], help="as of `icdgen sim`"
    )
    parser.add_argument("--node", default="cubeacp")
    parser.add_argument("--limit", type=float, default=900.0)
    parser.add_argument("client", nargs="+")
    options = parser.parse_args(arguments)
    good = True
    for loss in options.loss.split(","):
        begin = time.monotonic()
        wrong = run(
            options.client,
            options.size,
            loss,
            options.fault,
            options.node,
            options.limit,
        )
        print(
            f"{loss} % lost: {wrong or 'identical'}, {time.monotonic() - begin:.1f} s",
            flush=True,
        )
        good &= wrong is None
    return 0 if good else 1


def run(
    client: list[str],
    size: int,
    loss: str,
    faults: list[str],
    node: str = "cubeacp",
    limit: float = 900.0,
) -> str | None:
    """Return the error, or ``None``."""
    data = Random(f"{loss} {size}").randbytes(size)
    with tempfile.TemporaryDirectory() as folder:
        stored, uploaded = Path(folder, "stored"), Path(folder, "3.bin")
        stored.write_bytes(data)
        spoil = [word for fault in faults for word in ("--fault", fault)]
        options = (
            "--file",
            f"2:1={stored}",
            "--uploads",
            folder,
            "--loss",
            f"{loss}%",
            "--late",
            "400",
            *BOOT,
            *spoil,
        )
        with simulator("--node", node, "--tcp", "0", *options) as (place, _):
            where = urlsplit(place)
            with Tap(str(where.hostname), int(where.port or 0)) as tap:
                words = [*client, "127.0.0.1", str(tap.port), str(size)]
                try:
                    ended = subprocess.run(
                        words, capture_output=True, text=True, timeout=limit
                    )
                except subprocess.TimeoutExpired:
                    return "hangs"
        if ended.returncode:
            return f"ended with {ended.returncode}: {ended.stderr.strip() or ended.stdout.strip()}"
        for path, what in (
            (uploaded, "uploaded"),
            (Path(folder, f"{RUNNING}.bin"), "running"),
        ):
            if not path.is_file() or path.read_bytes() != data[:ROOM]:
                return f"the {what} file is another one"
        never = missing(ICD, node, tap.messages(ICD, node))
        return f"never sent: {', '.join(never)}" if never else None


def against(client: list[str], *options: str) -> subprocess.CompletedProcess:
    """The client's end against a simulator with these options; the file it wants has
    100 bytes.
    """
    with simulator(*options, *BOOT, "--tcp", "0") as (place, _):
        where = urlsplit(place)
        words = [*client, str(where.hostname), str(where.port), "100"]
        return subprocess.run(words, capture_output=True, text=True, timeout=60)


if __name__ == "__main__":
    sys.exit(main())
