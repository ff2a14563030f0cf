"""Generate a crate and its testee, build them, and compare them with the reference.

The testee is a program that answers requests about the crate. `differences` sends the
same requests to the testee and to the reference codec.
"""

from __future__ import annotations

import json
import math
import random
import struct
import subprocess
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path

from icdgen import backends
from icdgen.icd.model import Icd, Message, Node
from icdgen.icd.places import NodePlace
from icdgen.render import Renderer
from tests.conformance.build import build
from tests.conformance.icds import (  # noqa: F401
    SHIPPED,
    read_unchecked,
    shipped,
)
from tests.conformance.languages import all_languages
from tests.conformance.reference import Reference

BACKENDS = ("rust", "rust-testee")


@cache
def _renderer(name: str) -> Renderer:
    return Renderer.of_backend(backends.get(name))


def texts(icd: Icd, backend: str = "rust") -> dict[str, str]:
    """Return the text of every file of the backend by its path."""
    return {
        str(path): text
        for path, text in backends.get(backend).files(icd, _renderer(backend))
    }


def generate(icd: Icd, folder: Path) -> Path:
    """Write the crate and its testee to ``folder``; return the crate's main file."""
    for backend in BACKENDS:
        for path, text in texts(icd, backend).items():
            target = folder / backend / path
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_text(text, encoding="utf-8")
    return folder / "rust" / "src" / "lib.rs"


def main_of_testee(crate: Path) -> Path:
    """Main file of the testee that `generate` wrote with a crate."""
    return crate.parent.parent.parent / "rust-testee" / "src" / "main.rs"


def build_testee(icd: Icd) -> list[str]:
    """Build the testee with debug checks and return the command that starts it.

    The conformance tests share the build.
    """
    return build(all_languages()["rust-debug"], icd)


def ask(program: list[str], lines: Iterable[bytes]) -> list[dict]:
    """Send requests to the testee, one on each line, and return its answers."""
    done = subprocess.run(
        program, input=b"".join(line + b"\n" for line in lines), capture_output=True
    )
    assert done.returncode == 0, done.stderr[-2000:]
    return [json.loads(line) for line in done.stdout.splitlines()]


def differences(
    icd: Icd, program: list[str], requests: list[dict]
) -> list[tuple[dict, dict, dict]]:
    """Return requests to which the testee and the reference codec answer differently.

    Each item has the request, the answer of the reference codec and that of the testee.
    """
    reference = Reference(icd)
    lines = [json.dumps(request).encode() for request in requests]
    pairs = zip(
        requests, map(reference.answer, lines), ask(program, lines), strict=True
    )
    return [
        (request, expected, answer)
        for request, expected, answer in pairs
        if _bare(expected) != _bare(answer)
    ]


def _bare(answer: dict) -> dict:
    return {key: value for key, value in answer.items() if key != "detail"}


def routes(icd: Icd) -> Iterator[tuple[Node, Message, str, int]]:
    """Yield node, message, kind and id of every message under each of its ids."""
    for node in icd.nodes:
        for message in icd.messages_of(node):
            for kind, id in (
                ("telecommand", message.telecommand_id),
                ("telemetry", message.telemetry_id),
            ):
                if id is not None:
                    yield node, message, kind, id


def frame_requests(icd: Icd, count: int, seed: int = 1) -> list[dict]:
    """Make requests to decode zeros, ones, single bits and random frames.

    Some frames are too short or too long.
    """
    generator = random.Random(seed)
    requests = []
    for node, message, kind, id in routes(icd):
        size = message.length
        frames = [
            bytes(size),
            b"\xff" * size,
            b"\x01" * (size + 1),
            b"\x80" * max(0, size - 1),
            b"",
        ]
        frames += [
            bytes(
                1 << (index + position) % 8 if position == index else 0
                for position in range(size)
            )
            for index in range(min(size, 40))
        ]
        frames += [generator.randbytes(size) for _ in range(count)]
        keys = {
            "op": "decode",
            "node": node.name,
            "kind": kind,
            "id": id,
            "names": True,
        }
        requests += [{**keys, "bytes": frame.hex()} for frame in frames]
    return requests


def value_requests(icd: Icd, largest: int, seed: int = 1) -> list[dict]:
    """Make requests to encode raw values at and beyond the limits of each field.

    Further requests encode physical values at and near ties, for one field of each
    scale, width and sign. Messages of more than ``largest`` fields are skipped, since
    every request contains all fields.
    """
    generator = random.Random(seed)
    reference = Reference(icd)
    requests, scaled = [], set()
    for node, message, kind, id in routes(icd):
        keys = {"node": node.name, "kind": kind, "id": id}
        requests.append({"op": "constants", **keys})
        if len(message.fields) > largest:
            continue
        defaults = reference.answer(json.dumps(requests[-1]).encode())["default"]
        for field in message.fields:
            other_values = {
                name: value for name, value in defaults.items() if name != field.name
            }
            requests += [
                {"op": "encode", **keys, "raw": {**defaults, field.name: value}}
                for value in _raw_values(field)
            ]
            kind = (field.scale, field.bits, field.type)
            if not field.scale or kind in scaled:
                continue
            scaled.add(kind)
            for value in _doubles(field, generator):
                requests.append(
                    {
                        "op": "encode",
                        **keys,
                        "raw": other_values,
                        "physical": {field.name: value},
                    }
                )
    return requests


def _raw_values(field: NodePlace) -> list[object]:
    if field.is_bytes:
        return ["ab" * (field.bits // 8), "", "00" * (field.bits // 8 + 1)]
    if field.type == "float":
        digits = field.bits // 4
        signalling = "7fa00001" if digits == 8 else "7ff0000000000001"
        return ["7ff80000deadbeef"[:digits], signalling, "80" + "0" * (digits - 2)]
    low, high = field.raw_min, field.raw_max
    return [low, high, low - 1, high + 1, high // 3, low // 3]


def _doubles(field: NodePlace, generator: random.Random) -> list[str]:
    low, high = field.raw_min, field.raw_max
    values = [
        math.nan,
        math.inf,
        -math.inf,
        0.0,
        -0.0,
        5e-324,
        -5e-324,
        1.7e308,
        -1.7e308,
        2.0**63,
        2.0**97,
        -(2.0**126),
    ]
    for raw in (
        low,
        high,
        0,
        generator.randint(low, high),
        generator.randint(low, high),
    ):
        for doubled in (2 * raw - 1, 2 * raw, 2 * raw + 1):  # a tie, the value, a tie
            middle = field.scale.factor * doubled / 2 + field.scale.offset
            double = middle.numerator / middle.denominator
            values += [
                math.nextafter(double, -math.inf),
                double,
                math.nextafter(double, math.inf),
            ]
    return [struct.pack(">d", double).hex() for double in values]
