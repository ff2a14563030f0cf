"""``YAMCS_LIB=FOLDER python -m tests.xtce.shapes [FRAMES]`` compares the import of
public XTCE files with Yamcs.

Yamcs decodes random packets of telemetry from the XTCE files, and the reference codec
from the imported ICD; both encode the commands. The folder has the jars of Yamcs, as
for `tests.xtce.yamcs`.
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
_FREE = 2  # value that `Shapes.java` gives to arguments that are not fixed


def main(arguments: list[str]) -> int:
    frames, differences = int(arguments[0]) if arguments else 20, []
    with tempfile.TemporaryDirectory() as folder:
        jars = f"{os.environ['YAMCS_LIB']}/*"
        subprocess.run(["javac", "-cp", jars, "-d", folder, PROGRAM], check=True)
        for root, files in DATABASES.items():
            icd = _imported(files, Path(folder, root))
            values, unlike = _compared(icd, root, files, [jars, folder], frames)
            print(
                f"{root:<12} {values:6} values {len(unlike):4} differences", flush=True
            )
            print(
                "".join(f"    {difference}\n" for difference in unlike[:20]),
                end="",
                flush=True,
            )
            differences += unlike
    return 1 if differences else 0


def _imported(files: list[Path], folder: Path) -> Icd:
    folder.mkdir()
    paths = []
    for read in run.read_set([(path, kinds.reader_of_kind("xtce")) for path in files]):
        for name, tree in read.trees.items():
            paths.append(folder / f"{name}.yaml")
            paths[-1].write_text(emit.canonical_yaml(tree), encoding="utf-8")
    return load(paths).icd


def _compared(
    icd: Icd, root: str, files: list[Path], classes: list[str], frames: int
) -> tuple[int, list[str]]:
    """Return the number of compared values, and the differences."""
    (node,) = icd.nodes
    chance, packets_sent = random.Random(1), []
    telemetry = [
        message for message in icd.messages_of(node) if message.telemetry_id is not None
    ]
    for message in telemetry:
        fixed = {
            field: field.const
            for field in frame_fields(message.layout, node.orders)
            if field.const is not None
        }
        for count in range(frames):
            frame = codec.with_numbers(chance.randbytes(message.length), fixed)
            head = struct.pack(
                ">HHH", message.telemetry_id, 0xC000 | count, len(frame) - 1
            )
            packets_sent.append((message, frame, head + frame))
    text = "".join(f"{packet.hex()}\n" for _, _, packet in packets_sent)
    command = ["java", "-cp", ":".join(classes), "Shapes", root, *map(str, files)]
    printed_lines = subprocess.run(
        command, input=text, capture_output=True, text=True, check=True
    ).stdout.splitlines()
    commands = (
        line.split("\t") for line in printed_lines if line.startswith("command")
    )
    packets = {name: bytes.fromhex(data) for _, name, data in commands}
    printed = [
        line.split("\t")[1:] for line in printed_lines if line.startswith("telemetry")
    ]
    values, differences = 0, []
    for (message, frame, _), parameters in zip(packets_sent, printed, strict=True):
        theirs = dict(parameter.split("=", 1) for parameter in parameters)
        raw = codec.decode(node, message, frame)
        for field in message.fields:
            values += 1
            if not _is_same(field, raw[field.name], theirs.get(field.name, "")):
                differences.append(
                    f"{message.name}: {field.name} is {raw[field.name]}, theirs {theirs.get(field.name)}"
                )
    for message in icd.messages_of(node):
        if message in telemetry:
            continue
        given = {
            field.name: _FREE if field.const is None else field.const
            for field in message.fields
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
            differences.append(f"{message.name} is {ours.hex()}, theirs {packet.hex()}")
    return values, differences


def _is_same(field: NodePlace, ours: object, theirs: str) -> bool:
    if field.type == "float":
        # 32 bits, printed with as many digits as make it unique
        value = codec.float_value(field, int(ours))
        if value != value:
            return theirs == "NaN"
        return struct.pack(">f", float(theirs)) == struct.pack(">f", value)
    return theirs.isdecimal() and int(theirs) == int(ours)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
