"""``python -m tests.fuzz LANG [--seconds N] [ICD ...]``: builds a fuzz harness and runs
it.

The exit status is 0 if the harness finds no error.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from itertools import product
from pathlib import Path

from icdgen.describe import describe
from icdgen.icd.model import Icd, Message, Node
from icdgen.vectors import protocol
from icdgen.vectors.make import make_vectors
from tests.conformance import odd
from tests.conformance.build import BuildError, cache_folder, execute, generated
from tests.conformance.icds import icd_of
from tests.conformance.languages import Language
from tests.conftest import ROOT

HERE = Path(__file__).parent
LONGEST = 1024
DIRECTION = 1

_MANIFEST = """\
[package]
name = "fuzz"
version = "0.0.0"
edition = "2021"
publish = false

[package.metadata]
cargo-fuzz = true

[dependencies]
libfuzzer-sys = "0.4"
icd = {{ package = "{package}", path = "../source/rust" }}

[[bin]]
name = "{target}"
path = "{target}.rs"
test = false
doc = false

[workspace]
"""


def sources(language: Language, icd: Icd, folder: Path) -> Path:
    """Return a new folder of generated code."""
    source = folder / "source"
    shutil.rmtree(source, ignore_errors=True)
    for name, data in generated(language, icd).items():
        (source / name).parent.mkdir(parents=True, exist_ok=True)
        (source / name).write_bytes(data)
    return source


def routes(icd: Icd, node: Node) -> dict[int, list[tuple[int, Message]]]:
    """Return the id and message of each number in the input of a harness, by direction.

    They have the order of the dispatchers of C.
    """
    described = describe(icd).node(node.name)
    return {
        0: [
            (m.model.telecommand_id, m.model)
            for m in described.telecommands
            if m.model.telecommand_id is not None
        ],
        DIRECTION: [
            (m.model.telemetry_id, m.model)
            for m in described.telemetry
            if m.model.telemetry_id is not None
        ],
    }


def seeds(icd: Icd) -> Iterator[bytes]:
    """Yield an input for every frame of the golden vectors.

    Harnesses number the nodes in the order of the ICDs or of their names.
    """
    names = [node.name for node in icd.nodes]
    for node in icd.nodes:
        ways = routes(icd, node)
        for vectors in make_vectors(icd, node).messages:
            for flag, routes_of_flag in ways.items():
                ids = sorted({id for id, _ in routes_of_flag})
                numbers = {
                    place
                    for place, (_, message) in enumerate(routes_of_flag)
                    if message == vectors.message
                }
                numbers |= {ids.index(routes_of_flag[place][0]) for place in numbers}
                for row, number in product(vectors.rows, numbers):
                    for index in {
                        names.index(node.name),
                        sorted(names).index(node.name),
                    }:
                        yield bytes((index, flag, number & 0xFF)) + row.frame


def c_wire_seeds(icd: Icd) -> Iterator[bytes]:
    """Yield an input for every stream, row of packets and log in the golden vectors of
    the protocol, for the harness `c_wire`.
    """
    for index, node in enumerate(icd.nodes):
        for case in protocol.cases(icd, node) if node in protocol.nodes(icd) else ():
            match case.request:
                case {"op": "uart_decode", "bytes": stream}:
                    yield bytes((index, 0, 255, 7)) + bytes.fromhex(stream)
                    yield bytes((index, 3, 0, 3, 255)) + bytes.fromhex(stream)
                case {"op": "can_join", "packets": packets}:
                    yield bytes((index, 1, 3)) + b"".join(
                        _packet(packet) for packet in packets
                    )
                case {"op": "log_decode", "bytes": file}:
                    yield bytes((index, 2, 5)) + bytes.fromhex(file)


def c_stream_seeds(icd: Icd) -> Iterator[bytes]:
    """Yield an input for every stream of a framed link in the golden vectors of the
    protocol, for the harness `c_stream`.
    """
    for index, node in enumerate(icd.nodes):
        for case in protocol.cases(icd, node) if node in protocol.nodes(icd) else ():
            if case.request["op"] == "stream_events":
                head = bytes((index, case.request["direction"] == "telemetry", 0, 7))
                yield head + bytes.fromhex("".join(case.request["chunks"]))[:LONGEST]


def _packet(packet: dict) -> bytes:
    # The harness has few bits of an identifier, so that packets often belong together.
    id, data = packet["id"], bytes.fromhex(packet["bytes"])
    return (
        bytes((id >> 24 & 31, id >> 16 & 255, (id >> 8 & 3) | (id & 3) << 2))
        + data.ljust(8, b"\0")
        + b"\0"
    )


def rust_wire_seeds(icd: Icd) -> Iterator[bytes]:
    """Yield an input for every stream, log and set of packets in the golden vectors of
    the protocol layer.
    """
    for index, node in enumerate(
        json.loads(protocol.protocol_vectors_text(icd) or '{"nodes": []}')["nodes"]
    ):
        for case in node["cases"]:
            request, head = case["request"], bytes((index, 0, 3, 128))
            if request["op"] == "uart_events":
                stream = bytes.fromhex("".join(request["chunks"]))[:LONGEST]
                yield head + stream
                yield bytes((index, 3, 3, 128)) + stream
            elif request["op"] == "can_join":
                rows = (
                    packet["id"].to_bytes(4, "big")
                    + b"\0"
                    + bytes.fromhex(packet["bytes"]).ljust(9, b"\0")
                    for packet in request["packets"]
                )
                yield bytes((index, 1, 3, 128)) + b"".join(rows)[:LONGEST]
            elif request["op"] in ("log_decode", "log_message_decode"):
                yield (
                    bytes((index, 2, 3, 128))
                    + bytes.fromhex(request["bytes"])[:LONGEST]
                )


def c(icd: Icd, folder: Path) -> tuple[list[str], dict[str, str]]:
    """Build libFuzzer with the address and the undefined-behaviour sanitizer, on the
    dispatchers.
    """
    return _c(icd, folder, "c_target.c")


def c_wire(icd: Icd, folder: Path) -> tuple[list[str], dict[str, str]]:
    """Build the harness on the stream decoders and state machines of the wire layer."""
    return _c(icd, folder, "c_wire_target.c")


def c_stream(icd: Icd, folder: Path) -> tuple[list[str], dict[str, str]]:
    """Build the harness on the decoders of framed links."""
    return _c(icd, folder, "c_stream_target.c")


def _c(icd: Icd, folder: Path, target: str) -> tuple[list[str], dict[str, str]]:
    source = sources(
        Language("c", ("c", "c-testee"), (), lambda source, out: []), icd, folder
    )
    testee = source / "c-testee"
    files = [
        HERE / target,
        testee / "testee_nodes.c",
        *sorted(testee.glob("nodes/*.c")),
    ]
    flags = [
        "-O1",
        "-g",
        "-fsanitize=fuzzer,address,undefined",
        "-fno-sanitize-recover=all",
    ]
    execute(
        "clang",
        "-std=c99",
        *flags,
        "-I",
        source / "c",
        "-I",
        testee,
        *files,
        "-o",
        folder / "dispatch",
    )
    return [str(folder / "dispatch")], {}


def rust(icd: Icd, folder: Path) -> tuple[list[str], dict[str, str]]:
    """Build cargo-fuzz: libFuzzer with the address sanitizer and checks of integer
    overflow.
    """
    arms = []
    for index, node in enumerate(icd.nodes):
        for flag, name in ((0, "Telecommand"), (DIRECTION, "Telemetry")):
            ids = ", ".join(str(id) for id, _ in routes(icd, node)[flag])
            arguments = f"icd::{node.name}::{name}, [{ids}], flags, number, data"
            arms += (
                [
                    f"    ({index}, {'true' if flag else 'false'}) => exercise!({arguments}),\n"
                ]
                if ids
                else []
            )
    text = f"match (node % {len(icd.nodes)}, telemetry) {{\n{''.join(arms)}    _ => {{}}\n}}\n"
    return _cargo_fuzz(
        icd, folder, "dispatch", HERE / "rust_target.rs", {"nodes.rs": text}
    )


def rust_wire(icd: Icd, folder: Path) -> tuple[list[str], dict[str, str]]:
    """Build the harness on the stream decoders and the client of the wire layer."""
    return _rust_links(icd, folder, "wire")


def rust_stream(icd: Icd, folder: Path) -> tuple[list[str], dict[str, str]]:
    """Build the harness on the decoders of framed links."""
    return _rust_links(icd, folder, "stream")


def _rust_links(
    icd: Icd, folder: Path, target: str
) -> tuple[list[str], dict[str, str]]:
    nodes = [node.name for node in icd.nodes if icd.protocol_of(node)]
    longest = "".join(
        f" if icd::{name}::LONGEST > longest {{ longest = icd::{name}::LONGEST; }}"
        for name in nodes
    )
    links = ", ".join(f"&icd::{name}::LINK" for name in nodes)
    text = f"fn link_of(node: usize) -> Option<&'static Link> {{\n    let all: [&Link; {len(nodes)}] = [{links}];\n"
    text += "    all.get(node.checked_rem(all.len())?).copied()\n}\n"
    text += f"const LONGEST: usize = {{ let mut longest = 0;{longest} longest }};\n"
    return _cargo_fuzz(
        icd, folder, target, HERE / f"rust_{target}_target.rs", {"links.rs": text}
    )


def _cargo_fuzz(
    icd: Icd, folder: Path, target: str, harness: Path, included: dict[str, str]
) -> tuple[list[str], dict[str, str]]:
    import tomllib

    source = sources(
        Language("rust", ("rust",), (), lambda source, out: []), icd, folder
    )
    fuzz = folder / "fuzz"
    fuzz.mkdir(exist_ok=True)
    package = tomllib.loads((source / "rust" / "Cargo.toml").read_text())["package"][
        "name"
    ]
    (fuzz / "Cargo.toml").write_text(_MANIFEST.format(package=package, target=target))
    shutil.copy(harness, fuzz / f"{target}.rs")
    for name, text in included.items():
        (fuzz / name).write_text(text)
    options = ["--fuzz-dir", str(fuzz), "--dev"]
    execute("cargo", "+nightly", "fuzz", "build", *options, target, cwd=fuzz)
    programs = sorted(fuzz.glob(f"target/*/debug/{target}"))
    if not programs:
        raise BuildError("cargo fuzz built nothing")
    return [str(programs[0])], {}


def stream_seeds(icd: Icd) -> Iterator[bytes]:
    """Yield inputs of the harnesses on stream decoders, from the golden vectors of the
    protocol.
    """
    for index, node in enumerate(protocol.nodes(icd)):
        for case in protocol.cases(icd, node):
            request = case.request
            if request["op"] in ("uart_decode", "log_decode"):
                part = 0 if request["op"] == "uart_decode" else 2
                yield bytes((part, index + 1, len(case.why))) + bytes.fromhex(
                    request["bytes"]
                )
            elif request["op"] == "uart_events":
                yield bytes((0, index + 1, 7)) + bytes.fromhex(
                    "".join(request["chunks"])
                )
            elif request["op"] == "stream_events":
                head = bytes((7, index, request["direction"] == "telemetry"))
                yield head + bytes.fromhex("".join(request["chunks"]))[:LONGEST]
            elif request["op"] == "client":
                part = 3 + ("uart", "can", "i2c").index(request["bus"])
                received = [
                    row["receive"]
                    for row in request["script"]
                    if isinstance(row.get("receive"), str)
                ]
                yield bytes((part, index + 1, len(received))) + bytes.fromhex(
                    "".join(received)
                )


def python(icd: Icd, folder: Path) -> tuple[list[str], dict[str, str]]:
    """Build atheris on the dispatchers."""
    return atheris(icd, folder, "python_target.py")


def python_streams(icd: Icd, folder: Path) -> tuple[list[str], dict[str, str]]:
    """Build atheris on the stream decoders."""
    return atheris(icd, folder, "python_streams_target.py")


def atheris(icd: Icd, folder: Path, target: str) -> tuple[list[str], dict[str, str]]:
    source = sources(
        Language("python", ("python",), (), lambda source, out: []), icd, folder
    )
    package = sorted((source / "python").glob("*/__init__.py"))[0].parent
    command = [sys.executable, str(HERE / target), package.name]
    return command, {"PYTHONPATH": str(package.parent)}


SEEDS = {
    "c-wire": c_wire_seeds,
    "c-stream": c_stream_seeds,
    "rust-wire": rust_wire_seeds,
    "rust-stream": c_stream_seeds,
    "python-wire": stream_seeds,
}
HARNESSES = {
    "c": c,
    "c-wire": c_wire,
    "c-stream": c_stream,
    "rust": rust,
    "rust-wire": rust_wire,
    "rust-stream": rust_stream,
    "python": python,
    "python-wire": python_streams,
}


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="python -m tests.fuzz", description=__doc__)
    parser.add_argument("lang", choices=HARNESSES)
    parser.add_argument(
        "--seconds", type=int, default=60, help="how long (default: %(default)s)"
    )
    parser.add_argument(
        "--jobs", type=int, default=1, help="processes (default: %(default)s)"
    )
    parser.add_argument(
        "--odd", action="store_true", help="the odd ICDs of the conformance tests"
    )
    parser.add_argument(
        "icds",
        nargs="*",
        type=Path,
        help="ICDs: files or folders (default: icd/, for framed links examples/links/)",
    )
    options = parser.parse_intermixed_args(arguments)
    folder = cache_folder().resolve() / f"fuzz-{options.lang}"
    corpus = folder / "corpus"
    # Inputs are valid for these ICDs only.
    shutil.rmtree(corpus, ignore_errors=True)
    corpus.mkdir(parents=True)
    if options.odd:
        (folder / "odd").mkdir(exist_ok=True)
        options.icds.append(odd.write(folder / "odd"))
    icd = icd_of(
        options.icds or [ROOT / "examples" / "links"] * options.lang.endswith("-stream")
    )
    for number, seed in enumerate(SEEDS.get(options.lang, seeds)(icd)):
        (corpus / f"seed-{number:05}").write_bytes(seed)
    if not any(corpus.iterdir()):
        print(
            "the vectors of these ICDs have no input for the harness: name other ICDs",
            file=sys.stderr,
        )
        return 2
    try:
        command, more = HARNESSES[options.lang](icd, folder)
    except BuildError as error:
        print(error, file=sys.stderr)
        return 2
    command += [
        f"-max_total_time={options.seconds}",
        f"-max_len={LONGEST}",
        "-timeout=20",
        "-print_final_stats=1",
    ]
    if options.jobs > 1:
        command += [f"-fork={options.jobs}"]
    command += [f"-artifact_prefix={folder}/", str(corpus)]
    print(" ".join(command), flush=True)
    return (
        1
        if subprocess.run(command, cwd=folder, env={**os.environ, **more}).returncode
        else 0
    )


if __name__ == "__main__":
    sys.exit(main())
