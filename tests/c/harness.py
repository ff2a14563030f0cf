"""Generate C from ICDs, compile it, and build test programs that use it.

`frames_source` writes a program that decodes and encodes frames of all messages.
"""

from __future__ import annotations

import subprocess
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import jinja2

from icdgen.backends.c import CBackend
from icdgen.backends.c.names import stem
from icdgen.backends.c.types import type_of
from icdgen.describe import MessageDescription, describe
from icdgen.icd.model import Icd
from icdgen.render import Renderer
from tests.conformance.icds import (  # noqa: F401
    SHIPPED,
    read_unchecked,
    shipped,
)

HERE = Path(__file__).parent
WARNINGS = (
    "-Wall -Wextra -Wpedantic -Wconversion -Wsign-conversion -Wshadow -Wcast-align -Wundef -Wdouble-promotion "
    "-Wfloat-equal -Werror"
).split()
LANGUAGES = [
    (compiler, standard)
    for compiler in ("gcc", "clang")
    for standard in ("c99", "c11", "c2x")
]
LANGUAGES += [("g++", "c++17"), ("clang++", "c++17")]
SANITIZERS = "-fsanitize=address,undefined -fno-sanitize-recover=all".split()

_TYPES = {
    "uint": "UNSIGNED",
    "enum": "UNSIGNED",
    "int": "SIGNED",
    "bool": "FLAG",
    "float": "BITS",
    "bytes": "BYTES",
    "text": "BYTES",
}


@cache
def _renderer() -> Renderer:
    return Renderer("c")


def generate(icd: Icd, folder: Path) -> Path:
    """Write the generated files to ``folder`` and return it."""
    for path, text in CBackend().files(icd, _renderer()):
        target = folder / path
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(text, encoding="utf-8")
    return folder


def compile(
    source: Path,
    *options: str | Path,
    compiler: str = "gcc",
    output: str | Path = "/dev/null",
) -> Path:
    """Compile and link a source; fail with the messages of the compiler."""
    command = [compiler, *map(str, options), str(source), "-o", str(output)]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, f"{' '.join(command)}\n{done.stderr[:4000]}"
    return Path(output)


def compile_all(
    icd: Icd, folder: Path, compiler: str, standard: str, *options: str
) -> None:
    """Compile a program that includes every header of the folder, with all warnings."""
    cpp = standard.startswith("c++")
    source = folder / ("all.cpp" if cpp else "all.c")
    headers = [
        *(f"{node.name}.h" for node in icd.nodes),
        *sorted(p.relative_to(folder) for p in folder.rglob("*.h")),
    ]
    source.write_text(
        "".join(f'#include "{header}"\n' for header in headers)
        + "int main(void) { return 0; }\n"
    )
    of_language = (
        ("-Wold-style-cast",)
        if cpp
        else ("-Wstrict-prototypes", "-Wmissing-prototypes")
    )
    compile(
        source,
        f"-std={standard}",
        *WARNINGS,
        *of_language,
        *options,
        f"-I{folder}",
        compiler=compiler,
    )


def wrappers(icd: Icd) -> str:
    """Return a source in which every decode and encode function has its own caller."""
    text = "".join(f'#include "{node.name}.h"\n' for node in icd.nodes)
    for name in (stem(target.message) for target in targets(icd)):
        for head, call in (
            (
                f"d_{name}({name}_t *m, const uint8_t *b, size_t n)",
                f"{name}_decode(m, b, n)",
            ),
            (
                f"e_{name}(const {name}_t *m, uint8_t *b, size_t n)",
                f"{name}_encode(m, b, n)",
            ),
        ):
            text += f"icd_status_t {head};\nicd_status_t {head} {{ return {call}; }}\n"
    return text


@dataclass(frozen=True)
class Target:
    """A message, and the layout of the record that the test program reads and writes.

    ``places`` are the offsets of the raw values in the record, in bytes. ``size`` is
    the size of the record.
    """

    message: MessageDescription
    places: tuple[int, ...]
    size: int


def targets(icd: Icd) -> list[Target]:
    """Return all messages in the order of the test program."""
    result = []
    for node in describe(icd).nodes:
        for message in node.messages:
            places, at = [], 0
            for field in message.model.fields:
                places.append(at)
                at += field.bits // 8 if field.is_bytes else 8
            result.append(Target(message, tuple(places), at))
    return result


def frames_source(icd: Icd) -> str:
    """Return the test program, rendered from ``frames.c.j2``."""
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(HERE), trim_blocks=True, lstrip_blocks=True
    )
    return environment.get_template("frames.c.j2").render(
        nodes=[node.name for node in icd.nodes],
        messages=[_row(target) for target in targets(icd)],
    )


def _row(target: Target) -> dict[str, object]:
    message = target.message
    collect, assign, fields = [], [], []
    for description, place in zip(message.fields, target.places, strict=True):
        field, name = description.model, description.name
        fields.append(
            {
                "at": field.at,
                "bits": field.bits,
                "type": _TYPES[field.type],
                "place": place,
            }
        )
        if field.is_bytes:
            collect.append(
                f"memcpy(record + {place}, message.{name}, {field.bits // 8});"
            )
            assign.append(
                f"memcpy(message.{name}, record + {place}, {field.bits // 8});"
            )
        elif field.type == "float":
            word = f"uint{field.bits}_t"
            collect.append(
                f"{{ {word} b; memcpy(&b, &message.{name}, sizeof b); record_put(record, {place}, b); }}"
            )
            get = f"const {word} b = ({word})record_get(record, {place});"
            assign.append(f"{{ {get} memcpy(&message.{name}, &b, sizeof b); }}")
        else:
            collect.append(f"record_put(record, {place}, (uint64_t)message.{name});")
            assign.append(
                f"message.{name} = ({type_of(description)})record_get(record, {place});"
            )
    return {
        "stem": stem(message),
        "big_endian": str(message.node.byte_order == "big").lower(),
        "msb_first": str(message.node.bit_order == "msb0").lower(),
        "length": message.model.length,
        "record": target.size,
        "misfit": message.is_narrow,
        "fields": fields,
        "collect": collect,
        "assign": assign,
    }
