"""The wire layer in C documents its assumptions and calls only functions of memory.

`tests/conformance/test_wire.py` tests its behaviour.
"""

from __future__ import annotations

import re
import subprocess

import pytest

from icdgen.protocol import facts
from tests import links
from tests.c import harness

TABLE_FREE = "-DICDGEN_NO_TABLES"


@pytest.fixture(scope="module")
def headers(tmp_path_factory):
    return harness.generate(harness.shipped(), tmp_path_factory.mktemp("headers"))


def test_a_node_without_a_protocol_has_no_link(demo, tmp_path, headers):
    folder = harness.generate(harness.read_unchecked(demo), tmp_path)
    assert not list(folder.rglob("icdgen_wire.*")) and not list(folder.rglob("link.*"))
    assert (headers / "icdgen_wire.h").is_file()
    protocols = {
        node.name
        for node in harness.shipped().nodes
        if harness.shipped().protocol_of(node)
    }
    assert (
        {path.parent.name for path in headers.rglob("link.h")}
        == protocols
        < {n.name for n in harness.shipped().nodes}
    )


def test_every_assumption_has_its_reason_above_its_value(headers):
    icd = harness.shipped()
    for node in icd.nodes:
        if not icd.protocol_of(node):
            continue
        text = re.sub(r"\s+(?:\* )?", " ", (headers / node.name / "link.c").read_text())
        # The wire layer does not send the message that enables logs, so its sources do
        # not document assumptions about it.
        elsewhere = ("message ", "unsolicited_log.configured_by")
        assumed = [
            a
            for a in facts.of(icd, node).assumptions
            if not a.section.startswith(elsewhere)
        ]
        assert assumed
        for assumption in assumed:
            assert f"{assumption.key}: {' '.join(assumption.why.split())}" in text, (
                assumption
            )


def test_the_wire_layer_calls_only_functions_that_copy_and_compare_memory(
    headers, tmp_path
):
    text = (headers / "icdgen_wire.h").read_text()
    names = re.findall(r"^ICDGEN_API [^;{]*?\b(icd_\w+)\(", text, re.MULTILINE)
    assert len(names) > 50 and "icd_client_start" in names
    source = tmp_path / "all.c"
    nodes = [path.parent.name for path in headers.rglob("link.h")]
    source.write_text(
        "".join(f'#include "{node}.h"\n' for node in nodes)
        + "typedef void any(void);\nany *const used[] = {"
        + ", ".join(
            f"(any *){name}" for name in [*names, *(f"{node}_link" for node in nodes)]
        )
        + "};\n"
    )
    harness.compile(
        source, "-std=c99", "-O2", "-c", f"-I{headers}", output=tmp_path / "all.o"
    )
    done = subprocess.run(
        ["nm", "-u", tmp_path / "all.o"], capture_output=True, text=True, check=True
    )
    called = {line.split()[-1] for line in done.stdout.splitlines()}
    assert called - {"_GLOBAL_OFFSET_TABLE_", "__stack_chk_fail"} <= {
        "memcpy",
        "memset",
        "memcmp",
        "memmove",
    }


PROGRAM = """
#include "cubeacp.h"
#include <stdio.h>
int main(void)
{
    static const uint8_t bytes[] = "123456789 and so on";
    for (size_t length = 0; length < sizeof bytes; ++length) {
        const uint32_t one = icd_checksum(cubeacp_crc8_checksum(), bytes, length);
        const uint32_t two = icd_checksum(cubeacp_crc16_checksum(), bytes, length);
        printf("%u %u\\n", (unsigned)one, (unsigned)two);
    }
    return 0;
}
"""


@pytest.mark.parametrize("option", [TABLE_FREE, "-DWITH_TABLES"])
def test_checksums_are_the_same_with_tables_and_without(headers, tmp_path, option):
    source = tmp_path / "crc.c"
    source.write_text(PROGRAM)
    flags = ("-std=c99", *harness.WARNINGS, *harness.SANITIZERS, option, f"-I{headers}")
    program = harness.compile(source, *flags, output=tmp_path / "crc")
    done = subprocess.run([program], capture_output=True, text=True, check=True)
    icd = harness.shipped()
    protocol = facts.of(icd, icd.node("cubeacp"))
    data = b"123456789 and so on\0"
    expected = [
        (
            *(
                links.crc(protocol.checksums[name].crc, data[:n])
                for name in ("crc8", "crc16")
            ),
        )
        for n in range(len(data))
    ]
    assert [
        tuple(map(int, line.split())) for line in done.stdout.splitlines()
    ] == expected
