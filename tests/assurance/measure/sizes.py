"""``python -m tests.assurance.measure.sizes [--out FOLDER]``: code, stack and RAM of
each message, by target.

One object is compiled for each target. Each encoder and decoder is a function of its
own. They share only functions of the support header that the compiler does not inline.
"""

from __future__ import annotations

import argparse
import re
import shutil
import tempfile
from pathlib import Path
from typing import NamedTuple

from icdgen.icd.model import Icd
from tests.assurance.measure.measurement import MeasurementFile, total
from tests.c import harness
from tests.conformance.build import execute
from tests.conformance.icds import icd_of

COMMAND = "python -m tests.assurance.measure.sizes"
_REMARKS = (
    "Bytes of each message's encoder and decoder, of their own stack, and of the struct in RAM. Functions that both call and "
    "that are not inlined are in the facts, once for all messages. Accessors of physical values are not included.",
    "The size of the wire layer is that of the complete icdgen_wire.c; a linker removes functions that a program does not call.",
)


class Target(NamedTuple):
    """A processor with its compiler and flags."""

    name: str
    title: str
    tools: str  # prefix of the names of the tools
    flags: tuple[str, ...]


TARGETS = (
    Target(
        "cortex-m4",
        "Cortex-M4",
        "arm-none-eabi-",
        ("-Os", "-mcpu=cortex-m4", "-mthumb"),
    ),
    Target("avr", "AVR (ATmega2560)", "avr-", ("-Os", "-mmcu=atmega2560")),
)


class Function(NamedTuple):
    """Bytes of code and of stack."""

    code: int
    stack: int


def measure(icd: Icd, target: Target, folder: Path) -> MeasurementFile:
    """Return the sizes for a target. Raises `BuildError`."""
    harness.generate(icd, folder)
    stems = [harness.stem(target_.message) for target_ in harness.targets(icd)]
    text = harness.wrappers(icd) + "".join(
        f"extern const char r_{s}[]; const char r_{s}[sizeof({s}_t)];\n" for s in stems
    )
    (folder / "sizes.c").write_text(text)
    functions, data = compiled(folder, "sizes.c", target)
    rows = []
    for target_message, stem in zip(harness.targets(icd), stems, strict=True):
        decode, encode = functions[f"d_{stem}"], functions[f"e_{stem}"]
        message = target_message.message
        rows.append(
            (message.node.name, message.model.name, message.model.length, data[f"r_{stem}"], decode.code, encode.code,
             decode.stack, encode.stack)
        )  # fmt: skip
    shared = {
        name: function
        for name, function in functions.items()
        if name[:2] not in ("d_", "e_")
    }
    facts = [
        ("All decoders, bytes of code", f"{total(rows, 4):,}"),
        ("All encoders, bytes of code", f"{total(rows, 5):,}"),
        (
            "Called by them, bytes of code",
            f"{sum(function.code for function in shared.values()):,}",
        ),
        ("Deepest stack of a message", f"{max(max(row[6], row[7]) for row in rows):,}"),
    ]
    # ICDs without a link have no wire layer.
    if (folder / "icdgen_wire.c").exists():
        wire, _ = compiled(folder, "icdgen_wire.c", target, "-DICDGEN_SHARED=1")
        facts.append(
            (
                "Wire layer, bytes of code",
                f"{sum(function.code for function in wire.values()):,}",
            )
        )
        facts.append(
            (
                "Wire layer, deepest stack of one function",
                f"{max(function.stack for function in wire.values()):,}",
            )
        )
    columns = (
        "node",
        "message",
        "frame",
        "RAM",
        "decode",
        "encode",
        "stack of decode",
        "stack of encode",
    )
    title = f"Sizes on {target.title}"
    facts.append(("Compiled with", " ".join(target.flags)))
    return MeasurementFile(
        f"sizes-{target.name}",
        title,
        _REMARKS,
        "c",
        COMMAND,
        (f"{target.tools}gcc",),
        columns,
        rows,
        facts,
    )


def compiled(
    folder: Path, source: str, target: Target, *more: str
) -> tuple[dict[str, Function], dict[str, int]]:
    """Compile a source; return the functions of the object by name, and the sizes of
    its data.
    """
    object_file = folder / f"{Path(source).stem}.o"
    flags = (*target.flags, "-std=c99", "-ffunction-sections", "-fstack-usage", *more)
    execute(
        f"{target.tools}gcc",
        *flags,
        f"-I{folder}",
        "-c",
        folder / source,
        "-o",
        object_file,
    )
    stacks: dict[str, int] = {}
    for line in object_file.with_suffix(".su").read_text("utf-8").splitlines():
        where, bytes_, kind = line.split("\t")
        assert kind in (
            "static",
            "dynamic,bounded",
        ), line  # otherwise the size is only known at run time
        # The compiler appends ".constprop.0" and the like to names of copies.
        name = where.rpartition(":")[2].partition(".")[0]
        stacks[name] = max(int(bytes_), stacks.get(name, 0))
    functions, data = {}, {}
    for line in execute(f"{target.tools}nm", "-S", object_file).splitlines():
        if match := re.fullmatch(r"[0-9a-f]+ ([0-9a-f]+) (\w) (\S+)", line):
            size, kind, name = int(match[1], 16), match[2], match[3]
            if kind in "tT":
                functions[name] = Function(size, stacks[name.partition(".")[0]])
            else:
                data[name] = size
    return functions, data


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog=COMMAND, description=__doc__)
    parser.add_argument(
        "--out",
        type=Path,
        default=Path("measured"),
        help="folder to write to (default: %(default)s)",
    )
    parser.add_argument(
        "icds", nargs="*", type=Path, help="ICDs: files or folders (default: icd/)"
    )
    options = parser.parse_args(arguments)
    tools = [f"{target.tools}gcc" for target in TARGETS]
    if missing := [tool for tool in tools if shutil.which(tool) is None]:
        parser.error(f"not installed: {', '.join(missing)}")
    icd = icd_of(options.icds)
    for target in TARGETS:
        with tempfile.TemporaryDirectory() as name:
            file = measure(icd, target, Path(name))
        print(file.write(icd, options.out))
        for key, value in file.facts:
            print(f"  {key}: {value}")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
