"""Generates the crate and its testee, builds them, and asks the testee what the
reference codec is asked.
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
    """Every file of the backend."""
    return {
        str(path): text
        for path, text in backends.get(backend).files(icd, _renderer(backend))
    }


def generate(icd: Icd, folder: Path) -> Path:
    """Writes the crate and its testee below the folder; the crate's main file."""
    for backend in BACKENDS:
        for path, text in texts(icd, backend).items():
            target = folder / backend / path
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_text(text, encoding="utf-8")
    return folder / "rust" / "src" / "lib.rs"


def main_of_testee(crate: Path) -> Path:
    """The main file of the testee that lies beside the crate."""
    return crate.parent.parent.parent / "rust-testee" / "src" / "main.rs"


def build_testee(icd: Icd) -> list[str]:
    """The command that starts the testee, with the checks of a debug build; shared with
    the conformance run.
    """
    return build(all_languages()["rust-debug"], icd)


def ask(program: list[str], lines: Iterable[bytes]) -> list[dict]:
    """The testee's answers."""
    done = subprocess.run(
        program, input=b"".join(line + b"\n" for line in lines), capture_output=True
    )
    assert done.returncode == 0, done.stderr[-2000:]
    return [json.loads(line) for line in done.stdout.splitlines()]


def differences(
    icd: Icd, program: list[str], requests: list[dict]
) -> list[tuple[dict, dict, dict]]:
    """Requests that the reference codec answers otherwise: request, its answer, the
    testee's.
    """
    reference = Reference(icd)
    lines = [json.dumps(request).encode() for request in requests]
    pairs = zip(
        requests, map(reference.answer, lines), ask(program, lines), strict=True
    )
    return [
        (request, good, given)
        for request, good, given in pairs
        if _bare(good) != _bare(given)
    ]


def _bare(answer: dict) -> dict:
    return {key: value for key, value in answer.items() if key != "detail"}


def routes(icd: Icd) -> Iterator[tuple[Node, Message, str, int]]:
    """Every way to every message: node, message, kind, id."""
    for node in icd.nodes:
        for message in icd.messages_of(node):
            for kind, id in (
                ("telecommand", message.telecommand_id),
                ("telemetry", message.telemetry_id),
            ):
                if id is not None:
                    yield node, message, kind, id


def frame_requests(icd: Icd, count: int, seed: int = 1) -> list[dict]:
    """Decoding of zeros, ones, one-hot bytes and random frames, and of frames that are
    too short or too long.
    """
    source = random.Random(seed)
    found = []
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
            bytes(1 << (at + n) % 8 if n == at else 0 for n in range(size))
            for at in range(min(size, 40))
        ]
        frames += [source.randbytes(size) for _ in range(count)]
        to = {"op": "decode", "node": node.name, "kind": kind, "id": id, "names": True}
        found += [{**to, "bytes": frame.hex()} for frame in frames]
    return found


def value_requests(icd: Icd, largest: int, seed: int = 1) -> list[dict]:
    """Encoding with values at and beyond the ends of each field, and with physical
    values near and at ties, of one field for each scale, width and sign.

    Messages of more than ``largest`` fields are left out: every request holds all of
    them.
    """
    source = random.Random(seed)
    reference = Reference(icd)
    found, scaled = [], set()
    for node, message, kind, id in routes(icd):
        to = {"node": node.name, "kind": kind, "id": id}
        found.append({"op": "constants", **to})
        if len(message.fields) > largest:
            continue
        fresh = reference.answer(json.dumps(found[-1]).encode())["default"]
        for field in message.fields:
            rest = {name: value for name, value in fresh.items() if name != field.name}
            found += [
                {"op": "encode", **to, "raw": {**fresh, field.name: value}}
                for value in _raw_values(field)
            ]
            kind = (field.scale, field.bits, field.type)
            if not field.scale or kind in scaled:
                continue
            scaled.add(kind)
            for value in _doubles(field, source):
                found.append(
                    {"op": "encode", **to, "raw": rest, "physical": {field.name: value}}
                )
    return found


def _raw_values(field: NodePlace) -> list[object]:
    if field.is_bytes:
        return ["ab" * (field.bits // 8), "", "00" * (field.bits // 8 + 1)]
    if field.type == "float":
        digits = field.bits // 4
        signalling = "7fa00001" if digits == 8 else "7ff0000000000001"
        return ["7ff80000deadbeef"[:digits], signalling, "80" + "0" * (digits - 2)]
    low, high = field.raw_min, field.raw_max
    return [low, high, low - 1, high + 1, high // 3, low // 3]


def _doubles(field: NodePlace, source: random.Random) -> list[str]:
    low, high = field.raw_min, field.raw_max
    found = [
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
    for raw in (low, high, 0, source.randint(low, high), source.randint(low, high)):
        for doubled in (2 * raw - 1, 2 * raw, 2 * raw + 1):  # a tie, the value, a tie
            middle = field.scale.factor * doubled / 2 + field.scale.offset
            value = middle.numerator / middle.denominator
            found += [
                math.nextafter(value, -math.inf),
                value,
                math.nextafter(value, math.inf),
            ]
    return [struct.pack(">d", value).hex() for value in found]
