"""``YAMCS_LIB=FOLDER python -m tests.xtce.yamcs [FRAMES]``: random frames decoded by
Yamcs from the generated files.

The folder has the jars of Yamcs, from Maven or of the package `fprime-yamcs-bundle`;
`java` and `javac` must be there. All values are compared with those of the reference
codec.
"""

from __future__ import annotations

import math
import os
import random
import struct
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ElementTree
from pathlib import Path

from icdgen import codec
from icdgen.icd.frames import frame_fields
from icdgen.icd.model import Icd, Message, Node
from icdgen.icd.places import NodePlace, raw_fields_in
from icdgen.loading import load
from icdgen.vectors import patterns
from tests.xtce.decoding import alias
from tests.xtce.meaning import has_open_end, is_ordered, line
from tests.xtce.readback import SPACE, write
from tests.xtce.sets import sets

PROGRAM = Path(__file__).parent / "Decode.java"
MOST = 6  # elements of an open end
Values = dict[str, tuple[str, str]]  # raw and engineering, as Yamcs prints them


def main(arguments: list[str]) -> int:
    frames, found = int(arguments[0]) if arguments else 5, []
    with tempfile.TemporaryDirectory() as folder:
        jars = f"{os.environ['YAMCS_LIB']}/*"
        subprocess.run(["javac", "-cp", jars, "-d", folder, PROGRAM], check=True)
        for number, (name, icds) in enumerate(sets(Path(folder)).items()):
            icd = load(icds, check=False).icd
            (out := Path(folder, f"out{number}")).mkdir()
            values, unlike = 0, []
            for node, file in write(icd, out).items():
                for count, text in _compared(
                    icd, icd.node(node), file, [jars, folder], frames
                ):
                    values += count
                    unlike += [f"{node}: {text}"] if text else []
            print(
                f"{name:<12} {values:7} values {len(unlike):4} differences", flush=True
            )
            print(
                "".join(f"    {one}\n" for one in sorted(set(unlike))[:20]),
                end="",
                flush=True,
            )
            found += unlike
    return 1 if found else 0


def _compared(
    icd: Icd, node: Node, file: Path, classes: list[str], frames: int
) -> list[tuple[int, str]]:
    """Of each frame how many values are alike, and what is not."""
    chance, asked = random.Random(1), []
    messages = [one for one in icd.messages_of(node) if one.telemetry_id is not None]
    if not messages:
        return []
    head, width = _head(file)
    for message in messages:
        for _ in range(frames):
            owner = icd.node(message.node)
            fields = frame_fields(message.layout, owner.orders)
            frame = chance.randbytes(message.length)
            frame = codec.frame_of(
                frame, {one: one.const for one in fields if one.const is not None}
            )
            if message.layout.parts and not message.layout.has_gaps:
                (part,) = message.layout.parts
                has_more = has_open_end(message) and not part.is_rest
                more = (
                    chance.randint(0, min(MOST, part.high - part.low))
                    if has_more
                    else 0
                )
                frame = patterns.cut(message, owner, frame, part.fewest + more)
            elif message.layout.parts:
                frame = codec.encode(
                    owner, message, codec.initial_values(owner, message)
                )
            asked.append(
                (
                    message,
                    frame,
                    (message.telemetry_id << head).to_bytes(width, "big") + frame,
                )
            )
    root = ElementTree.parse(file).getroot()
    names = {
        one.get("name", ""): line(alias(one))
        for one in root.iterfind(f".//{SPACE}Parameter")
    }
    containers = {
        line(alias(one)): f"{one.get('name')}_"
        for one in root.iterfind(f".//{SPACE}SequenceContainer")
    }
    text = "".join(f"{data.hex()}\n" for _, _, data in asked)
    command = ["java", "-cp", ":".join(classes), "Decode", file]
    said = subprocess.run(
        command, input=text, capture_output=True, text=True, check=True
    ).stdout.splitlines()
    return [
        _unlike(
            icd.node(message.node),
            message,
            frame,
            _read(printed, names, containers[line(message.name)]),
        )
        for (message, frame, _), printed in zip(asked, said, strict=True)
    ]


def _head(file: Path) -> tuple[int, int]:
    """Bits behind the id in the header, and bytes of that."""
    entries = ElementTree.parse(file).iterfind(
        f".//{SPACE}SequenceContainer[@name='TelemetryFrame']/{SPACE}EntryList/*"
    )
    names = [one.get("parameterRef") for one in entries]
    if "Apid" in names:
        return 32, 6
    encoding = ElementTree.parse(file).find(
        f".//{SPACE}IntegerParameterType/{SPACE}IntegerDataEncoding"
    )
    assert encoding is not None
    return 0, int(encoding.get("sizeInBits", "8")) // 8


def _read(said: str, names: dict[str, str], container: str) -> Values:
    """The parameters of a container: a frame may be of others, too, that share its id."""
    parts = (one.partition("=") for one in said.split("\t") if one)
    return {
        names[name]: _pair(value)
        for name, _, value in parts
        if name.startswith(container)
    }


def _pair(text: str) -> tuple[str, str]:
    raw, _, physical = text.rpartition("|")
    return raw, physical


def _unlike(
    node: Node, message: Message, frame: bytes, theirs: Values
) -> tuple[int, str]:
    raw, count = codec.decode(node, message, frame), 0
    end = 8 * (len(frame) if has_open_end(message) else message.layout.length)
    for field in message.fields:
        is_left_out = (
            field.is_count
            or field.derived
            or field.at >= end
            or not is_ordered(field, node)
        )
        if (
            is_left_out
            or field.is_bytes
            or (
                field.is_read_only
                and not all(
                    is_ordered(one, node) for one in raw_fields_in(message.layout)
                )
            )
        ):
            continue
        name, index = line(field.name), None
        if name not in theirs and field.index is not None:
            name, index = name.rpartition("[")[0], field.index
        if field.name not in raw:
            if name in theirs:
                return (
                    count,
                    f"{message.name}: {field.name} is not there, theirs {theirs[name][0]}",
                )
            continue
        if name not in theirs:
            return count, f"{message.name}: {field.name} is missing"
        said = (
            theirs[name]
            if index is None
            else tuple(_element(one, index) for one in theirs[name])
        )
        if text := _one(field, int(raw[field.name]), *said):
            return count, f"{message.name}: {text}"
        count += 1
    return count, ""


def _element(text: str, index: int) -> str:
    return text.strip("[]").split(", ")[index]


def _one(field: NodePlace, raw: int, theirs: str, physical: str) -> str:
    if field.type == "float":
        ours = codec.float_value(field, raw)
        same = _close(ours, float(theirs), 1e-6 if field.bits == 32 else 1e-12)
    else:
        ours = raw
        known = {"true": "1", "false": "0"}.get(theirs, theirs)
        is_number = known.lstrip("-").isdecimal()
        same = is_number and (int(known) == raw or int(known) & (1 << 64) - 1 == raw)
    if not same:
        return f"{field.name} is {ours}, theirs {theirs}"
    if field.has_formula:
        exact = codec.physical_double(field, raw)
        if (
            exact is not None
            and exact == exact
            and not _close(exact, float(physical), 1e-9)
        ):
            return f"{field.name} is {exact}, theirs {physical} of {theirs}"
    return ""


def _close(one: float, other: float, part: float) -> bool:
    return (
        one == other
        or one != one
        or math.isclose(one, other, rel_tol=part, abs_tol=1e-12)
        or _single(one) == other
    )


def _single(value: float) -> float:
    """As a float of 32 bits."""
    try:
        return float(struct.unpack("f", struct.pack("f", value))[0])
    except OverflowError:
        return math.inf


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
