"""``YAMCS_LIB=FOLDER python -m tests.xtce.yamcs [FRAMES]`` compares how Yamcs decodes
random frames with the generated files.

The folder has the jars of Yamcs, from Maven or from the package `fprime-yamcs-bundle`;
`java` and `javac` must be installed. All values are compared with the reference codec.
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
from tests.xtce.meaning import has_variable_length, is_ordered, line
from tests.xtce.readback import SPACE, write
from tests.xtce.sets import sets

PROGRAM = Path(__file__).parent / "Decode.java"
MOST = 6  # elements of a variable-length array
Values = dict[str, tuple[str, str]]  # raw and engineering, as Yamcs prints them


def main(arguments: list[str]) -> int:
    frames, all_differences = int(arguments[0]) if arguments else 5, []
    with tempfile.TemporaryDirectory() as folder:
        jars = f"{os.environ['YAMCS_LIB']}/*"
        subprocess.run(["javac", "-cp", jars, "-d", folder, PROGRAM], check=True)
        for number, (name, icds) in enumerate(sets(Path(folder)).items()):
            icd = load(icds, check=False).icd
            (out := Path(folder, f"out{number}")).mkdir()
            values, differences = 0, []
            for node, file in write(icd, out).items():
                for count, text in _compared(
                    icd, icd.node(node), file, [jars, folder], frames
                ):
                    values += count
                    differences += [f"{node}: {text}"] if text else []
            print(
                f"{name:<12} {values:7} values {len(differences):4} differences",
                flush=True,
            )
            print(
                "".join(
                    f"    {difference}\n"
                    for difference in sorted(set(differences))[:20]
                ),
                end="",
                flush=True,
            )
            all_differences += differences
    return 1 if all_differences else 0


def _compared(
    icd: Icd, node: Node, file: Path, classes: list[str], frames: int
) -> list[tuple[int, str]]:
    """Return for each frame the number of equal values, and the first difference or an
    empty text.
    """
    chance, samples = random.Random(1), []
    messages = [
        message for message in icd.messages_of(node) if message.telemetry_id is not None
    ]
    if not messages:
        return []
    head, width = _head(file)
    for message in messages:
        for _ in range(frames):
            owner = icd.node(message.node)
            fields = frame_fields(message.layout, owner.orders)
            frame = chance.randbytes(message.length)
            frame = codec.with_numbers(
                frame,
                {field: field.const for field in fields if field.const is not None},
            )
            if message.layout.parts and not message.layout.has_inner_gaps:
                (part,) = message.layout.parts
                has_more = has_variable_length(message) and not part.is_rest
                more = (
                    chance.randint(0, min(MOST, part.high - part.low))
                    if has_more
                    else 0
                )
                # The frame ends after as many elements as its counter states.
                frame = patterns.cut(message, owner, frame, part.fewest + more)
            elif message.layout.parts:
                frame = codec.encode(
                    owner, message, codec.initial_values(owner, message)
                )
            samples.append(
                (
                    message,
                    frame,
                    (message.telemetry_id << head).to_bytes(width, "big") + frame,
                )
            )
    root = ElementTree.parse(file).getroot()
    names = {
        parameter.get("name", ""): line(alias(parameter))
        for parameter in root.iterfind(f".//{SPACE}Parameter")
    }
    containers = {
        line(alias(container)): f"{container.get('name')}_"
        for container in root.iterfind(f".//{SPACE}SequenceContainer")
    }
    text = "".join(f"{data.hex()}\n" for _, _, data in samples)
    command = ["java", "-cp", ":".join(classes), "Decode", file]
    output = subprocess.run(
        command, input=text, capture_output=True, text=True, check=True
    ).stdout.splitlines()
    return [
        _unlike(
            icd.node(message.node),
            message,
            frame,
            _read(printed, names, containers[line(message.name)]),
        )
        for (message, frame, _), printed in zip(samples, output, strict=True)
    ]


def _head(file: Path) -> tuple[int, int]:
    """Return the number of bits behind the id in the header, and the size of both in
    bytes.
    """
    entries = ElementTree.parse(file).iterfind(
        f".//{SPACE}SequenceContainer[@name='TelemetryFrame']/{SPACE}EntryList/*"
    )
    names = [entry.get("parameterRef") for entry in entries]
    if "Apid" in names:
        return 32, 6
    encoding = ElementTree.parse(file).find(
        f".//{SPACE}IntegerParameterType/{SPACE}IntegerDataEncoding"
    )
    assert encoding is not None
    return 0, int(encoding.get("sizeInBits", "8")) // 8


def _read(output: str, names: dict[str, str], container: str) -> Values:
    """Return the parameters of a container from a line of output.

    Yamcs also prints parameters of other containers that share the id.
    """
    parts = (parameter.partition("=") for parameter in output.split("\t") if parameter)
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
    end = 8 * (len(frame) if has_variable_length(message) else message.layout.length)
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
                    is_ordered(other, node) for other in raw_fields_in(message.layout)
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
        printed = (
            theirs[name]
            if index is None
            else tuple(_element(text, index) for text in theirs[name])
        )
        if text := _difference(field, int(raw[field.name]), *printed):
            return count, f"{message.name}: {text}"
        count += 1
    return count, ""


def _element(text: str, index: int) -> str:
    return text.strip("[]").split(", ")[index]


def _difference(field: NodePlace, raw: int, theirs: str, physical: str) -> str:
    if field.type == "float":
        ours = codec.float_value(field, raw)
        is_same = _is_close(ours, float(theirs), 1e-6 if field.bits == 32 else 1e-12)
    else:
        ours = raw
        # Yamcs prints Boolean parameters as words.
        number = {"true": "1", "false": "0"}.get(theirs, theirs)
        is_number = number.lstrip("-").isdecimal()
        is_same = is_number and (
            int(number) == raw or int(number) & (1 << 64) - 1 == raw
        )
    if not is_same:
        return f"{field.name} is {ours}, theirs {theirs}"
    if field.has_formula:
        exact = codec.physical_double(field, raw)
        if (
            exact is not None
            and exact == exact
            and not _is_close(exact, float(physical), 1e-9)
        ):
            return f"{field.name} is {exact}, theirs {physical} of {theirs}"
    return ""


def _is_close(ours: float, theirs: float, part: float) -> bool:
    return (
        ours == theirs
        or ours != ours
        or math.isclose(ours, theirs, rel_tol=part, abs_tol=1e-12)
        or _single(ours) == theirs
    )


def _single(value: float) -> float:
    """Return a value rounded to a float of 32 bits."""
    try:
        return float(struct.unpack("f", struct.pack("f", value))[0])
    except OverflowError:
        return math.inf


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
