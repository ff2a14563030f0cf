"""Measure generated Python code and alternatives: decoding frame by frame, 100,000
frames at once, and import.

Usage::

    python bench/python_decode.py [--rounds 60] [--check]

Each candidate is a function of one frame. A round calls all candidates in turn, so that
other load affects all of them; a ratio is the median of the rounds' ratios. Two
candidates decode nothing and show the lower bound: ``stores`` creates the object and
sets its attributes, and ``passes`` performs the two numpy operations that any
conversion of a bit to a boolean needs.

Frames are random, with defined enumeration values and finite floats. ``construct``,
``kaitaistruct`` and ``numpy`` are measured if they are installed; the Kaitai classes
are equal to the output of its compiler. With ``--check``, the exit status is 1 if a
limit is exceeded.
"""

from __future__ import annotations

import argparse
import importlib.util
import random
import statistics
import struct
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from timeit import Timer
from typing import Any

from icdgen.backends.python import PythonBackend
from icdgen.loading import load
from icdgen.render import Renderer

sys.path.insert(0, str(Path(__file__).parent))
from python_others import by_construct, by_kaitaistruct

ROOT = Path(__file__).parent.parent
PACKAGE = "icdgen_messages"
# Times bare struct.unpack, at most
DECODE = {132: 3.6, 190: 2.5, 206: 1.9, 207: 1.9, 146: 1.9}
MANY = {132: 10, 190: 25, 206: 13, 207: 3, 146: 3}  # times a memcpy, at most
IMPORT = 30  # ms, at most
# Times slower than generated code on the first three, at least
OTHERS = {"construct": 60, "kaitaistruct": 20}
FRAMES = 100_000


def sample(cls: Any) -> bytes:
    """Return a random frame with defined enumeration values and finite floats."""
    source = random.Random(cls.ID if hasattr(cls, "ID") else cls.GET_ID)
    message = cls.from_bytes(source.randbytes(cls.LENGTH))
    for info in cls.FIELDS:
        if info.type == "enum":
            members = [member for member in info.enum if member.value < 1 << info.bits]
            setattr(message, info.attribute, source.choice(members))
        elif info.type == "float":
            setattr(message, info.attribute, source.uniform(-1000, 1000))
    return message.to_bytes()


def bare(cls: Any) -> Callable[[bytes], Any]:
    """Return struct.unpack for the frame, with flags as whole bytes."""
    layout = import_module(f"{PACKAGE}._compiled").Codec(cls).form.format
    return lambda frame: struct.unpack(layout, frame)


def stores(cls: Any, frame: bytes) -> Callable[[bytes], Any]:
    """Return a function that creates an object and sets its attributes to existing
    values.
    """
    message = cls.from_bytes(frame)
    names: dict[str, Any] = {
        "cls": cls,
        "new": object.__new__,
        "values": tuple(message.as_dict().values()),
    }
    targets = "".join(f"self.{name}, " for name in message.as_dict())
    exec(
        f"def stores(frame):\n    self = new(cls)\n    {targets}= values\n    return self\n",
        names,
    )
    return names["stores"]


def in_turn(timers: dict[str, Timer], rounds: int) -> dict[str, list[float]]:
    """Return the seconds per call of each timer, by round."""
    numbers = {
        name: max(1, int(0.0005 / min(timer.repeat(3, 1))))
        for name, timer in timers.items()
    }
    times: dict[str, list[float]] = {name: [] for name in timers}
    for _ in range(rounds):
        for name, timer in timers.items():
            times[name].append(timer.timeit(numbers[name]) / numbers[name])
    return times


def ratio(over: list[float], under: list[float]) -> float:
    return statistics.median(a / b for a, b in zip(over, under, strict=True))


def is_installed(module: str) -> bool:
    return importlib.util.find_spec(module) is not None


def single(acp: Any, rounds: int) -> list[str]:
    """Measure decoding frame by frame, and return the exceeded limits."""
    makers = {"construct": by_construct, "kaitaistruct": by_kaitaistruct}
    makers = {name: maker for name, maker in makers.items() if is_installed(name)}
    print(
        "| frame | fields | struct.unpack ns | stores | decode ns | ratio | limit | encode ns | construct | kaitaistruct |"
    )
    print("|---|---|---|---|---|---|---|---|---|---|")
    missed = []
    for place, (id, limit) in enumerate(DECODE.items()):
        cls = acp.TELEMETRY[id]
        frame = sample(cls)
        calls = {
            "bare": bare(cls),
            "stores": stores(cls, frame),
            "decode": cls.from_bytes,
        }
        calls |= {name: maker(cls) for name, maker in makers.items()}
        timers = {
            name: Timer("call(frame)", globals={"call": call, "frame": frame})
            for name, call in calls.items()
        }
        timers["encode"] = Timer(
            "call()", globals={"call": cls.from_bytes(frame).to_bytes}
        )
        times = in_turn(timers, rounds)
        measured, least = (
            ratio(times[name], times["bare"]) for name in ("decode", "stores")
        )
        slower = {name: ratio(times[name], times["decode"]) for name in makers}
        nano = {name: statistics.median(values) * 1e9 for name, values in times.items()}
        shown = " | ".join(
            f"{slower[name]:.0f} times" if name in slower else "" for name in OTHERS
        )
        print(
            f"| {id} | {len(cls.FIELDS)} | {nano['bare']:.0f} | {least:.2f} | {nano['decode']:.0f} | {measured:.2f} | {limit} "
            f"| {nano['encode']:.0f} | {shown} |"
        )
        if measured > limit:
            missed.append(
                f"decode {id}: {measured:.2f} times struct.unpack, limit {limit}"
            )
        for name, least in OTHERS.items():
            if place < 3 and slower.get(name, least) < least:
                missed.append(
                    f"decode {id}: {slower[name]:.0f} times as fast as {name}, limit {least}"
                )
    return missed


def many(acp: Any, rounds: int) -> list[str]:
    """Measure decoding of many frames at once, and return the exceeded limits."""
    if not is_installed("numpy"):
        return ["numpy is not installed"]
    import numpy

    print(
        f"\n| {FRAMES:,} frames | bytes | memcpy us | passes | decode_many us | ratio | limit | physical us | ratio |"
    )
    print("|---|---|---|---|---|---|---|---|---|")
    missed = []
    for id, limit in MANY.items():
        cls = acp.TELEMETRY[id]
        frames = random.Random(id).randbytes(cls.LENGTH * FRAMES)
        flags = numpy.zeros(
            (sum(info.type == "bool" for info in cls.FIELDS), FRAMES // 8), numpy.uint64
        )

        def passes(words=flags):
            numpy.right_shift(words, 1, out=words)
            numpy.bitwise_and(words, 1, out=words)

        calls = {
            "passes": passes,
            "memcpy": numpy.frombuffer(frames, numpy.uint8).copy,
            "raw": lambda cls=cls, frames=frames: cls.decode_many(frames),
            "physical": lambda cls=cls, frames=frames: cls.decode_many(
                frames, physical=True
            ),
        }
        times = in_turn(
            {
                name: Timer("call()", globals={"call": call})
                for name, call in calls.items()
            },
            rounds,
        )
        micro = {
            name: statistics.median(values) * 1e6 for name, values in times.items()
        }
        measured = ratio(times["raw"], times["memcpy"])
        print(
            f"| {id} | {len(frames):,} "
            f"| {micro['memcpy']:.0f} | {ratio(times['passes'], times['memcpy']):.1f} "
            f"| {micro['raw']:.0f} | {measured:.1f} | {limit} "
            f"| {micro['physical']:.0f} | {ratio(times['physical'], times['memcpy']):.1f} |"
        )
        if measured > limit:
            missed.append(
                f"decode_many {id}: {measured:.1f} times a memcpy, limit {limit}"
            )
    return missed


def imports(folder: str, rounds: int) -> list[str]:
    """Measure imports in whole processes, and return the exceeded limits."""
    programs = {
        "pass": "pass",
        "the package": f"import {PACKAGE}",
        "a node": f"import {PACKAGE}.cubeacp",
        "a message": f"from {PACKAGE}.cubeacp import EstimatedAttitudeAngles",
        "all messages of a node": f"from {PACKAGE} import cubeacp; [getattr(cubeacp, name) for name in cubeacp._HOMES]",
    }
    times: dict[str, list[float]] = {name: [] for name in programs}
    for _ in range(max(5, rounds // 4)):
        for name, program in programs.items():
            start = time.perf_counter()
            subprocess.run([sys.executable, "-c", program], cwd=folder, check=True)
            times[name].append((time.perf_counter() - start) * 1e3)
    none = statistics.median(times.pop("pass"))
    print("\n| import | ms |\n|---|---|")
    for name, values in times.items():
        print(f"| {name} | {statistics.median(values) - none:.1f} |")
    import_time = statistics.median(times["the package"]) - none
    return (
        [f"importing the package: {import_time:.1f} ms, limit {IMPORT}"]
        if import_time > IMPORT
        else []
    )


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--rounds", type=int, default=60)
    parser.add_argument("--check", action="store_true")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        for path, text in PythonBackend(PACKAGE).files(
            load([ROOT / "icd"]).icd, Renderer("python")
        ):
            (Path(folder) / path).parent.mkdir(parents=True, exist_ok=True)
            (Path(folder) / path).write_text(text, encoding="utf-8")
        sys.path.insert(0, folder)
        acp = import_module(f"{PACKAGE}.cubeacp")
        print(f"Python {sys.version.split()[0]}, medians of {options.rounds} rounds\n")
        missed = [
            *single(acp, options.rounds),
            *many(acp, options.rounds),
            *imports(folder, options.rounds),
        ]
    print(
        "\n"
        + ("\n".join(f"missed: {limit}" for limit in missed) or "all limits are kept")
    )
    return 1 if missed and options.check else 0


if __name__ == "__main__":
    sys.exit(main())
