"""``YAMCS_LIB=FOLDER python -m tests.xtce.shapes [FRAMES]``: Yamcs judges what `icdgen
import` makes of the shapes of public files.

Random packets of telemetry are decoded by Yamcs from the files of XTCE, and by the
reference codec from the imported ICD; commands are encoded by both. The folder has the
jars of Yamcs, as for `tests.xtce.yamcs`.
"""

from __future__ import annotations

import os
import random
import struct
import subprocess
import sys
import tempfile
from pathlib import Path

from icdgen import codec
from icdgen.definitions import kinds, run
from icdgen.icd.fmt import emit
from icdgen.icd.frames import frame_fields
from icdgen.icd.model import Icd
from icdgen.icd.places import NodePlace
from icdgen.loading import load
from tests.conftest import ROOT

PROGRAM = Path(__file__).parent / "Shapes.java"
SHAPES = ROOT / "tests" / "definitions" / "files" / "shapes"
DATABASES = {  # by the outermost container of telemetry
    "Packet": [SHAPES / "aggregate.xml"],
    "ccsds": sorted((SHAPES / "pus").glob("*.xml")),
}
_FREE = 2  # what `Shapes.java` gives arguments that are free


def main(arguments: list[str]) -> int:
    frames, found = int(arguments[0]) if arguments else 20, []
    with tempfile.TemporaryDirectory() as folder:
        jars = f"{os.environ['YAMCS_LIB']}/*"
        subprocess.run(["javac", "-cp", jars, "-d", folder, PROGRAM], check=True)
        for root, files in DATABASES.items():
            icd = _imported(files, Path(folder, root))
            values, unlike = _compared(icd, root, files, [jars, folder], frames)
            print(
                f"{root:<12} {values:6} values {len(unlike):4} differences", flush=True
            )
            print("".join(f"    {one}\n" for one in unlike[:20]), end="", flush=True)
            found += unlike
    return 1 if found else 0


def _imported(files: list[Path], folder: Path) -> Icd:
    folder.mkdir()
    paths = []
    for read in run.read_set([(path, kinds.get("xtce")) for path in files]):
        for name, tree in read.trees.items():
            paths.append(folder / f"{name}.yaml")
            paths[-1].write_text(emit.canonical_yaml(tree), encoding="utf-8")
    return load(paths).icd


def _compared(
    icd: Icd, root: str, files: list[Path], classes: list[str], frames: int
) -> tuple[int, list[str]]:
    """How many values are alike, and what is not."""
    (node,) = icd.nodes
    chance, asked = random.Random(1), []
    telemetry = [one for one in icd.messages_of(node) if one.telemetry_id is not None]
    for message in telemetry:
        fixed = {
            one: one.const
            for one in frame_fields(message.layout, node.orders)
            if one.const is not None
        }
        for count in range(frames):
            frame = codec.frame_of(chance.randbytes(message.length), fixed)
            head = struct.pack(
                ">HHH", message.telemetry_id, 0xC000 | count, len(frame) - 1
            )
            asked.append((message, frame, head + frame))
    text = "".join(f"{packet.hex()}\n" for _, _, packet in asked)
    command = ["java", "-cp", ":".join(classes), "Shapes", root, *map(str, files)]
    said = subprocess.run(
        command, input=text, capture_output=True, text=True, check=True
    ).stdout.splitlines()
    commands = (one.split("\t") for one in said if one.startswith("command"))
    packets = {name: bytes.fromhex(data) for _, name, data in commands}
    printed = [one.split("\t")[1:] for one in said if one.startswith("telemetry")]
    values, unlike = 0, []
    for (message, frame, _), parameters in zip(asked, printed, strict=True):
        theirs = dict(one.split("=", 1) for one in parameters)
        raw = codec.decode(node, message, frame)
        for field in message.fields:
            values += 1
            if not _is_same(field, raw[field.name], theirs.get(field.name, "")):
                unlike.append(
                    f"{message.name}: {field.name} is {raw[field.name]}, theirs {theirs.get(field.name)}"
                )
    for message in (one for one in icd.messages_of(node) if one not in telemetry):
        given = {
            one.name: _FREE if one.const is None else one.const
            for one in message.fields
        }
        values += 1
        ours, packet = (
            codec.encode(node, message, given),
            packets.get(message.name, b""),
        )
        if (ours, message.telecommand_id) != (
            packet[6:],
            struct.unpack(">H", packet[:2])[0] & 0x7FF,
        ):
            unlike.append(f"{message.name} is {ours.hex()}, theirs {packet.hex()}")
    return values, unlike


def _is_same(field: NodePlace, ours: object, theirs: str) -> bool:
    if (
        field.type == "float"
    ):  # of 32 bits, printed with as many digits as tell it from others
        value = codec.float_value(field, int(ours))
        return (
            theirs == "NaN"
            if value != value
            else struct.pack(">f", float(theirs)) == struct.pack(">f", value)
        )
    return theirs.isdecimal() and int(theirs) == int(ours)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
