"""C code for any bit and byte order, width, position and text works without errors.

The sanitizers check the programs while they run.

A bit-by-bit interpreter in C checks the generated code on random frames. The reference
codec checks the interpreter and the generated code on zeros, ones and extremes.
"""

from __future__ import annotations

import random
import struct
import subprocess
from pathlib import Path

import pytest

from icdgen import codec
from icdgen.icd.model import Icd, Message, Node
from icdgen.icd.places import NodePlace
from tests.c import harness, odd


@pytest.fixture(scope="module")
def icd(tmp_path_factory):
    return harness.read_unchecked(*odd.write(tmp_path_factory.mktemp("icd")))


def test_any_order_width_and_position_agrees_with_the_reference_codec(icd, tmp_path):
    program = build(icd, tmp_path)
    assert_no_differences([program])
    assert_agrees(program, icd)


def test_portable_code_agrees_with_the_interpreter(icd, tmp_path):
    assert_no_differences([build(icd, tmp_path, "-DICDGEN_PORTABLE")])


@pytest.mark.needs("qemu-s390x", "s390x-linux-gnu-gcc")
def test_big_endian_machines_agree_with_the_interpreter(icd, tmp_path):
    harness.generate(icd, tmp_path)
    source = tmp_path / "frames.c"
    source.write_text(harness.frames_source(icd))
    options = ("-std=c99", "-O1", "-static", f"-I{tmp_path}", f"-I{harness.HERE}")
    program = harness.compile(
        source, *options, compiler="s390x-linux-gnu-gcc", output=tmp_path / "frames"
    )
    assert_no_differences(["qemu-s390x", program])


def assert_no_differences(program: list[str | Path]) -> None:
    done = subprocess.run(
        [*program, "random", "200", "11"], capture_output=True, text=True
    )
    assert done.returncode == 0, (done.stdout + done.stderr)[-4000:]


@pytest.mark.parametrize(("compiler", "standard"), harness.LANGUAGES)
def test_text_of_the_icd_does_not_end_comments_or_strings(
    icd, tmp_path, compiler, standard
):
    harness.generate(icd, tmp_path)
    harness.compile_all(icd, tmp_path, compiler, standard, "-Wtrigraphs", "-Wcomment")


def test_name_functions_return_the_exact_names_of_the_manual(icd, tmp_path):
    harness.generate(icd, tmp_path)
    calls = "".join(
        f"    puts(hostile_telemetry_name({n})); putchar(1);\n"
        for n in range(len(odd.HOSTILE))
    )
    source = tmp_path / "names.c"
    source.write_text(
        f'#include "hostile.h"\n#include <stdio.h>\nint main(void)\n{{\n{calls}    return 0;\n}}\n'
    )
    program = harness.compile(
        source,
        "-std=c99",
        "-Werror",
        "-Wall",
        f"-I{tmp_path}",
        output=tmp_path / "names",
    )
    out = subprocess.run([program], capture_output=True).stdout.decode("utf-8")
    assert out.split("\n\x01")[:-1] == odd.HOSTILE


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


def assert_agrees(program: Path, icd: Icd) -> None:
    """Compare the program with the reference codec: same values, same bytes.

    The frames are zeros, ones, a code for each bit position, extremes of each field and
    some random frames.
    """
    targets = harness.targets(icd)
    frames = [list(samples(t.message.node, t.message.model)) for t in targets]
    data = b"".join(
        struct.pack("<HI", index, len(samples_of_message))
        + b"".join(samples_of_message)
        for index, samples_of_message in enumerate(frames)
    )
    done = subprocess.run([program, "sample"], input=data, capture_output=True)
    assert done.returncode == 0, (done.stdout[-1000:] + done.stderr)[-4000:]
    results, offset = done.stdout, 0
    for target, samples_of_message in zip(targets, frames, strict=True):
        node, message = target.message.node, target.message.model
        for frame in samples_of_message:
            raw = codec.decode(node, message, frame)
            expected = record(message, raw) + codec.encode(node, message, raw)
            for origin in ("generated code", "interpreter"):
                output = results[offset : offset + len(expected)]
                assert output == expected, f"{origin}, {message.name}, {frame.hex()}"
                offset += len(expected)
    assert offset == len(results)


def record(message: Message, raw: dict[str, int | bytes]) -> bytes:
    """Return the raw values in the format that the test program writes."""
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
        code = sum(
            ((position >> bit) & 1) << position for position in range(length * 8)
        )
        yield code.to_bytes(length, "little")
    zeros = codec.decode(node, message, bytes(length))
    for field in message.fields:
        for value in extremes(field):
            yield codec.encode(node, message, {**zeros, field.name: value})
    generator = random.Random(message.name)
    for _ in range(3):
        yield generator.randbytes(length)


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
