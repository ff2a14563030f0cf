"""Every message decodes and encodes as the reference codec does it, with nothing for
the sanitizers to find.

Random frames and walking bits are judged by a bit-by-bit interpreter in C, which in
turn is held to the reference codec. ``ICDGEN_RANDOM_FRAMES`` says how many random
frames a message gets; the default is the full 10,000.
"""

from __future__ import annotations

import os
import random
import struct
import subprocess
from pathlib import Path

import pytest

from icdgen import codec
from icdgen.icd.model import Icd, Message, Node
from icdgen.icd.places import NodePlace
from tests.c import harness

RANDOM = os.environ.get("ICDGEN_RANDOM_FRAMES", "10000")


@pytest.fixture(scope="module")
def program(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("frames")
    return build(harness.shipped(), folder)


def build(icd: Icd, folder: Path, *options: str) -> Path:
    harness.generate(icd, folder)
    source = folder / "frames.c"
    source.write_text(harness.frames_source(icd))
    options = (
        "-std=c99",
        "-O1",
        *harness.SANITIZERS,
        f"-I{folder}",
        f"-I{harness.HERE}",
        *options,
    )
    return harness.compile(source, *options, output=folder / "frames")


def test_all_messages_agree_with_the_interpreter_on_random_frames(program):
    done = subprocess.run(
        [program, "random", RANDOM, "7"], capture_output=True, text=True
    )
    assert done.returncode == 0, (done.stdout + done.stderr)[-4000:]
    assert done.stdout == f"171 messages, {RANDOM} random frames each, 0 differences\n"


def test_all_messages_and_the_interpreter_agree_with_the_reference_codec(program):
    assert_agrees(program, harness.shipped())


def assert_agrees(program: Path, icd: Icd) -> None:
    """Zeros, ones, a code for each bit position, extremes of each field, some random
    frames: same values, same bytes.
    """
    targets = harness.targets(icd)
    frames = [list(samples(t.message.node, t.message.model)) for t in targets]
    data = b"".join(
        struct.pack("<HI", index, len(of_message)) + b"".join(of_message)
        for index, of_message in enumerate(frames)
    )
    done = subprocess.run([program, "sample"], input=data, capture_output=True)
    assert done.returncode == 0, (done.stdout[-1000:] + done.stderr)[-4000:]
    out, at = done.stdout, 0
    for target, of_message in zip(targets, frames, strict=True):
        node, message = target.message.node, target.message.model
        for frame in of_message:
            raw = codec.decode(node, message, frame)
            expected = record(message, raw) + codec.encode(node, message, raw)
            for who in ("generated code", "interpreter"):
                found = out[at : at + len(expected)]
                assert found == expected, f"{who}, {message.name}, {frame.hex()}"
                at += len(expected)
    assert at == len(out)


def record(message: Message, raw: dict[str, int | bytes]) -> bytes:
    """The raw values as the test program writes them."""
    out = b""
    for field in message.fields:
        value = raw[field.name]
        out += (
            value
            if isinstance(value, bytes)
            else (value & 0xFFFFFFFFFFFFFFFF).to_bytes(8, "little")
        )
    return out


def samples(node: Node, message: Message):
    length = message.length
    yield bytes(length)
    yield b"\xff" * length
    for bit in range((length * 8).bit_length()):
        code = sum(((at >> bit) & 1) << at for at in range(length * 8))
        yield code.to_bytes(length, "little")
    zeros = codec.decode(node, message, bytes(length))
    for field in message.fields:
        for value in extremes(field):
            yield codec.encode(node, message, {**zeros, field.name: value})
    source = random.Random(message.name)
    for _ in range(3):
        yield source.randbytes(length)


def extremes(field: NodePlace):
    if field.is_bytes:
        return [
            (
                bytes(range(1, field.bits // 8 + 1))
                if field.bits < 2040
                else b"\x5a" * (field.bits // 8)
            )
        ]
    if field.type == "float":
        exponent = (
            0x7F800001 if field.bits == 32 else 0x7FF0000000000001
        )  # a signalling NaN
        return [1 << (field.bits - 1), exponent]
    return [field.raw_min, field.raw_max]
