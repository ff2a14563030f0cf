"""A node need not describe every part of a protocol: what its ICD has is in its link, and nothing else."""

from __future__ import annotations

import dataclasses
import subprocess

import pytest

from icdgen.icd.model import Icd
from tests.c import harness

PARTS = {
    "message_id": [],
    "errors": ["errors"],
    "client": [],
    "identification": ["identification"],
    "statistics": [],
    "uart": ["framing", "acknowledge"],
    "i2c": ["polled"],
    "can": ["can"],
    "file_transfer": ["hole_map", "files", "list", "download", "upload", "erase", "format"],
    "crc16": ["crc16"],
    "index_file": ["index"],
    "msdos_time": ["time"],
    "boot": [],
    "crc8": ["checksum"],
    "log_mask": ["log_mask"],
    "telemetry_log": ["log_file"],
    "unsolicited_log": ["log_message"],
}
"""The pointers of a link that each section of a protocol gives."""

MEMBERS = sorted(member for members in PARTS.values() for member in members)


@pytest.fixture(scope="module")
def icd() -> Icd:
    """Nodes with the messages of the CubeACP: with its whole protocol, without each section, with each alone."""
    shipped = harness.shipped()
    acp = shipped.node("cubeacp")
    whole = shipped.protocol_of(acp)
    protocols = {"whole": whole}
    for section in whole:
        protocols[f"without_{section}"] = {name: part for name, part in whole.items() if name != section}
        protocols[f"only_{section}"] = {section: whole[section]}
    bases = [dataclasses.replace(node, protocol={}) for node in (*shipped.included(acp), acp)]
    includes = tuple(node.name for node in bases)
    variant = dataclasses.replace(acp, messages=(), enums=(), includes=includes)
    return Icd((*bases, *(dataclasses.replace(variant, name=n, protocol=p) for n, p in protocols.items())))


@pytest.fixture(scope="module")
def nodes(icd) -> list:
    return [node for node in icd.nodes if node.protocol]


@pytest.fixture(scope="module")
def headers(icd, tmp_path_factory):
    return harness.generate(icd, tmp_path_factory.mktemp("headers"))


@pytest.mark.parametrize(("compiler", "standard"), [("gcc", "c99"), ("clang", "c99"), ("g++", "c++17")])
def test_every_choice_of_sections_compiles_without_a_warning(icd, headers, compiler, standard):
    harness.compile_all(icd, headers, compiler, standard, "-fsyntax-only")


def test_the_sections_of_the_icd_are_those_of_the_link(nodes, headers, tmp_path):
    source = tmp_path / "parts.c"
    source.write_text(
        "#include <stdio.h>\n"
        + "".join(f'#include "{node.name}/link.h"\n' for node in nodes)
        + "static void tell(const char *name, const icd_link_t *link)\n{\n    fputs(name, stdout);\n"
        + "".join(f'    if (link->{member} != NULL) fputs(" {member}", stdout);\n' for member in MEMBERS)
        + '    puts(link->i2c_address >= 0 ? " at an address" : "");\n}\nint main(void)\n{\n'
        + "".join(f'    tell("{node.name}", {node.name}_link());\n' for node in nodes)
        + "    return 0;\n}\n"
    )
    flags = ("-std=c99", *harness.WARNINGS, f"-I{headers}")
    program = harness.compile(source, *flags, output=tmp_path / "parts")
    told = subprocess.run([program], capture_output=True, text=True, check=True).stdout.splitlines()
    assert told == [" ".join([node.name, *parts(node.protocol)]) for node in nodes]


def parts(protocol: dict) -> list[str]:
    """What the program above tells of a link for this protocol."""
    logs = {"telemetry_log", "unsolicited_log"}  # which nobody can read without the mask
    sections = protocol.keys() - (logs if "log_mask" not in protocol else set())
    found = sorted(member for section in sections for member in PARTS[section])
    return [*found, *(["at an address"] if "i2c" in protocol else [])]
