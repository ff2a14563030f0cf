"""``python -m tests.assurance.measure.sizes [--out FOLDER]``: code, stack and RAM of
each message, by target, from the compilers.

One object is compiled a target, in which each encoder and decoder is a function of its
own that nothing can be shared with but the functions of the support header that the
compiler does not inline.
"""

from __future__ import annotations

import argparse
import re
import shutil
import tempfile
from pathlib import Path
from typing import NamedTuple

from icdgen.icd.model import Icd
from tests.assurance.measure.measurement import Measured, total
from tests.c import harness
from tests.conformance.build import execute
from tests.conformance.icds import icd_of

COMMAND = "python -m tests.assurance.measure.sizes"
_SAYS = (
    "Bytes of each message's encoder and decoder, of the stack that each takes itself, and of its struct in RAM. What both "
    "call and the compiler does not inline stands in the facts, once for all messages. Values are raw: accessors of "
    "physical values are not in it.",
    "The wire layer is what icdgen_wire.c takes as a whole; a linker leaves out what a program does not call.",
)


class Target(NamedTuple):
    """What is compiled for."""

    name: str
    title: str
    tools: str  # what their names begin with
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


def measure(icd: Icd, target: Target, folder: Path) -> Measured:
    """The sizes for a target. Raises `BuildError`."""
    harness.generate(icd, folder)
    stems = [harness.stem(one.message) for one in harness.targets(icd)]
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
        name: one for name, one in functions.items() if name[:2] not in ("d_", "e_")
    }
    facts = [
        ("All decoders, bytes of code", f"{total(rows, 4):,}"),
        ("All encoders, bytes of code", f"{total(rows, 5):,}"),
        (
            "Called by them, bytes of code",
            f"{sum(one.code for one in shared.values()):,}",
        ),
        ("Deepest stack of a message", f"{max(max(row[6], row[7]) for row in rows):,}"),
    ]
    if (folder / "icdgen_wire.c").exists():
        wire, _ = compiled(folder, "icdgen_wire.c", target, "-DICDGEN_SHARED=1")
        facts.append(
            ("Wire layer, bytes of code", f"{sum(one.code for one in wire.values()):,}")
        )
        facts.append(
            (
                "Wire layer, deepest stack of one function",
                f"{max(one.stack for one in wire.values()):,}",
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
    return Measured(
        f"sizes-{target.name}",
        title,
        _SAYS,
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
    """The functions of an object by name, and the bytes of its data."""
    made = folder / f"{Path(source).stem}.o"
    flags = (*target.flags, "-std=c99", "-ffunction-sections", "-fstack-usage", *more)
    execute(
        f"{target.tools}gcc", *flags, f"-I{folder}", "-c", folder / source, "-o", made
    )
    stacks: dict[str, int] = {}
    for line in made.with_suffix(".su").read_text("utf-8").splitlines():
        where, bytes_, kind = line.split("\t")
        assert kind in (
            "static",
            "dynamic,bounded",
        ), line  # else its size is known when it runs only
        name = where.rpartition(":")[2].partition(".")[
            0
        ]  # without what the compiler calls a copy of it
        stacks[name] = max(int(bytes_), stacks.get(name, 0))
    functions, data = {}, {}
    for line in execute(f"{target.tools}nm", "-S", made).splitlines():
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
            found = measure(icd, target, Path(name))
        print(found.write(icd, options.out))
        for key, value in found.facts:
            print(f"  {key}: {value}")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
