"""Programs of several translation units can share one wire layer.

Without `ICDGEN_SHARED`, each unit has its own copy. The tests link programs and inspect
their symbols.
"""

from __future__ import annotations

import subprocess

import pytest

from icdgen.describe import describe
from icdgen.describe.links import links_of
from tests.c import harness

UNIT = """\
#include "cubeacp.h"
#include "bootloader.h"
int {name}(void);
int {name}(void)
{{
    static {node}_client_t client;
    static uint8_t buffer[CUBEACP_CLIENT_BYTES];
    static icd_slot_t slots[1];
    uint8_t bytes[16];
    size_t count;
    if ({node}_client_uart(&client, slots, 1, buffer, sizeof buffer) != ICD_OK) {{
        return -1;
    }}
    if ({node}_request_identification(&client, 0) != ICD_OK || 
        !icd_client_output(&client.client, bytes, sizeof bytes, &count)) {{
        return -2;
    }}
    return bytes[2];
}}
"""
MAIN = """\
int first(void);
int second(void);
int main(void)
{
    return first() == 128 && second() == 128 ? 0 : 1;
}
"""
SHARED = ["icdgen_wire.c", "cubeacp/link.c", "bootloader/link.c"]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    generated = harness.generate(harness.shipped(), tmp_path_factory.mktemp("units"))
    (generated / "first.c").write_text(UNIT.format(name="first", node="cubeacp"))
    (generated / "second.c").write_text(UNIT.format(name="second", node="bootloader"))
    (generated / "main.c").write_text(MAIN)
    return generated


def objects(folder, sources, compiler, standard, *options):
    paths = []
    for source in sources:
        target = folder / f"{source.replace('/', '_')}.o"
        command = [*options, *harness.WARNINGS, f"-std={standard}", "-c", f"-I{folder}"]
        if compiler.endswith("++"):
            command += ["-xc++"]
        paths.append(
            harness.compile(folder / source, *command, compiler=compiler, output=target)
        )
    return paths


def symbols(path, kinds):
    done = subprocess.run(["nm", path], capture_output=True, text=True, check=True)
    rows = (line.split() for line in done.stdout.splitlines())
    return {row[-1] for row in rows if row[-2] in kinds and row[-1].startswith("icd")}


def undefined(path):
    """Return the undefined symbols of an object."""
    done = subprocess.run(
        ["nm", "-u", path], capture_output=True, text=True, check=True
    )
    return {line.split()[-1] for line in done.stdout.splitlines()}


@pytest.mark.parametrize(
    ("compiler", "standard"), [("gcc", "c99"), ("clang", "c99"), ("g++", "c++17")]
)
def test_units_that_share_the_wire_layer_do_not_define_its_symbols(
    folder, compiler, standard
):
    units = objects(
        folder,
        ["first.c", "second.c", "main.c"],
        compiler,
        standard,
        "-O1",
        "-DICDGEN_SHARED",
    )
    # The layer is compiled as C, also for programs in C++.
    layer = objects(folder, SHARED, "gcc", "c99", "-O1", "-Wmissing-prototypes")
    linker = {"g++": "g++"}.get(compiler, compiler)
    subprocess.run([linker, *units, *layer, "-o", folder / "shared"], check=True)
    subprocess.run([folder / "shared"], check=True)
    assert symbols(units[0], "tT") == set() and symbols(units[0], "U") >= {
        "icd_client_uart",
        "icd_client_output",
    }
    assert "icd_client_start" in symbols(layer[0], "T")
    assert undefined(layer[0]) <= {
        "memcpy",
        "memset",
        "memmove",
        "memcmp",
        "strlen",
    }  # nothing is allocated


@pytest.mark.parametrize(
    ("compiler", "standard"), [("gcc", "c99"), ("clang", "c99"), ("g++", "c++17")]
)
def test_units_with_their_own_copy_need_no_other_source(folder, compiler, standard):
    units = objects(
        folder, ["first.c", "second.c", "main.c"], compiler, standard, "-O1"
    )
    subprocess.run([compiler, *units, "-o", folder / "alone"], check=True)
    subprocess.run([folder / "alone"], check=True)
    assert symbols(units[0], "U") == set()


def test_external_names_differ_in_the_31_characters_that_c_guarantees(folder):
    layer = objects(folder, SHARED, "gcc", "c99", "-O1")
    names = [name for path in layer for name in symbols(path, "T")]
    assert len(names) > 50 and len({name[:31] for name in names}) == len(names)


CLIENT = """\
#include "cubeacp.h"
int main(void);
int main(void)
{{
    static cubeacp_client_t acp;
    static icd_slot_t slots[1];
    static uint8_t buffer[CUBEACP_CLIENT_BYTES];
    return cubeacp_client_{bus}(&acp, {address}slots, 1, buffer, sizeof buffer) == ICD_OK &&
            cubeacp_request_identification(&acp, 0) == ICD_OK
        ? 0
        : 1;
}}
"""


def linked(folder, bus, *options):
    """Link a program with a client on one bus, run it, and return its symbols.

    The linker removes unused sections.
    """
    (folder / "client.c").write_text(
        CLIENT.format(bus=bus, address="1, " if bus == "can" else "")
    )
    flags = [
        "-std=c99",
        "-Os",
        "-ffunction-sections",
        "-fdata-sections",
        "-DICDGEN_SHARED",
        *options,
    ]
    object_files = [
        harness.compile(
            folder / name,
            *flags,
            *harness.WARNINGS,
            "-c",
            f"-I{folder}",
            output=folder / f"{place}.o",
        )
        for place, name in enumerate(("client.c", "icdgen_wire.c", "cubeacp/link.c"))
    ]
    subprocess.run(
        ["gcc", *object_files, "-Wl,--gc-sections", "-o", folder / "client"], check=True
    )
    subprocess.run([folder / "client"], check=True)
    lines = subprocess.run(
        ["nm", folder / "client"], capture_output=True, text=True, check=True
    ).stdout.splitlines()
    return {line.split()[-1] for line in lines}


def test_a_program_contains_no_code_of_unused_buses(folder):
    uart, can = linked(folder, "uart"), linked(folder, "can")
    assert (
        "icd_uart_decoder_init" in uart
        and "icd_can_split" not in uart
        and "icd_can_joiner_init" not in uart
    )
    assert "icd_can_split" in can and "icd_uart_decoder_init" not in can
    for bus in BUSES:
        tables = tables_of(linked(folder, bus))
        unused = {f"{other}_exchanges" for other in BUSES if other != bus}
        assert f"{bus}_exchanges" in tables and not tables & unused
        assert not tables & {"checksum_crc16", "log_bits", "packed_time", "index_entry"}


BUSES = ("uart", "i2c", "can")


def tables_of(names):
    """Return the names of tables of CubeACP, without its prefix."""
    prefix = "icdgen_node_cubeacp_"
    return {name.removeprefix(prefix) for name in names if name.startswith(prefix)}


def test_a_program_optimized_for_size_has_no_tables_of_checksums(folder):
    """A program that is optimized for size has tables only with `ICDGEN_TABLES`."""
    with_tables = tables_of(linked(folder, "uart", "-DICDGEN_TABLES"))
    without = tables_of(linked(folder, "uart"))
    at_all = tables_of(linked(folder, "uart", "-O1", "-DICDGEN_NO_TABLES"))
    assert (
        with_tables - without == {"checksum_crc8_table"} and "crc8_table" not in at_all
    )


CHOSEN = ("-DCUBEACP_CHOSEN", "-DCUBEACP_WITH_IDENTIFICATION")


def test_a_program_can_select_the_messages_of_its_tables(folder):
    """Calls for other messages do not compile.

    The tables always include messages that the wire layer needs.
    """
    rows = []
    for options in (
        (),
        CHOSEN,
        (*CHOSEN, "-DICDGEN_NO_FILES"),
        (*CHOSEN, "-DICDGEN_NO_FILES", "-DICDGEN_NO_LOGS"),
    ):
        linked(folder, "uart", *options)  # the program runs
        done = subprocess.run(
            ["nm", "-S", folder / "client"], capture_output=True, text=True, check=True
        )
        prefix = "icdgen_node_cubeacp_"
        sizes = {
            line.split()[3].removeprefix(prefix): int(line.split()[1], 16)
            for line in done.stdout.splitlines()
            if len(line.split()) == 4
        }
        ends = (
            sizes["telecommands"] // 4 - 1,
            sizes["telemetry"] // 4 - 1,
        )  # the last entry of a table marks its end
        rows.append((*ends, "log_message" in sizes))
    link = links_of(describe(harness.shipped()))["cubeacp"]
    needed = [message.name for message in (*link.always_needed, *link.in_procedures)]
    few = [
        sum(sent.message.name in needed for sent in sents)
        for sents in (link.telecommands, link.telemetry)
    ]
    own = [
        sum(sent.message in link.always_needed for sent in sents)
        for sents in (link.telecommands, link.telemetry)
    ]
    assert own == [0, 2] and few > own
    assert rows == [
        (len(link.telecommands), len(link.telemetry), True),
        (*few, True),
        (*own, True),
        (*own, False),
    ]
    with pytest.raises(AssertionError, match="cubeacp_request_identification"):
        linked(folder, "uart", "-DCUBEACP_CHOSEN")


@pytest.mark.parametrize(
    ("compiler", "standard"), [("gcc", "c99"), ("clang", "c99"), ("g++", "c++17")]
)
@pytest.mark.parametrize(
    "shared", [(), ("-DICDGEN_SHARED",)], ids=["header only", "shared"]
)
def test_selected_messages_compile_without_a_warning(
    folder, compiler, standard, shared
):
    options = (
        *CHOSEN,
        "-DBOOTLOADER_CHOSEN",
        "-DICDGEN_NO_FILES",
        "-DICDGEN_NO_LOGS",
        *shared,
    )
    objects(
        folder, ["first.c", *(SHARED if shared else ())], compiler, standard, *options
    )


def test_excluded_features_are_reported_as_unsupported(folder):
    (folder / "left.c").write_text("""\
#include "cubeacp.h"
int main(void)
{
    icd_procedure_t procedure;
    icd_log_reader_t reader;
    uint8_t buffer[CUBEACP_LOG_BYTES];
    if (cubeacp_list(&procedure, NULL, NULL) != ICD_ERROR_UNSUPPORTED) {
        return 1;
    }
    return icd_log_reader_init(&reader, cubeacp_link(), buffer, sizeof buffer) == ICD_ERROR_UNSUPPORTED ? 0 : 2;
}
""")
    options = (
        "-std=c99",
        *harness.WARNINGS,
        *harness.SANITIZERS,
        "-DICDGEN_NO_FILES",
        "-DICDGEN_NO_LOGS",
        f"-I{folder}",
    )
    program = harness.compile(folder / "left.c", *options, output=folder / "left")
    assert subprocess.run([program]).returncode == 0
