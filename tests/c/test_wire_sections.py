"""The link of a node in C contains exactly the sections of the protocol in its ICD.

The tests generate nodes without each section and with each section alone.
"""

from __future__ import annotations

import copy
import dataclasses
import subprocess

import pytest

from icdgen.icd.model import Icd, buses_of
from tests.c import harness

PARTS = {
    "link.ids": [],
    "link.commands": [],
    "link.client": [],
    "identification": ["identification"],
    "statistics": [],
    "statistics_reset": [],
    "boot_status": [],
    "program_start": [],
    "link.buses.uart": [
        "framing",
        "acknowledge_bytes",
        "unsolicited",
        "reasons",
        "exchanges[ICD_BUS_UART]",
    ],
    "link.buses.i2c": ["reasons", "exchanges[ICD_BUS_I2C]"],
    "link.buses.can": ["can", "exchanges[ICD_BUS_CAN]"],
    "procedures": [],
    "link.checksums": [],
    "index_file": ["index"],
    "msdos_time": ["time"],
    "boot": [],
    "link.packets": ["checksum"],
    "log_mask": ["log_mask"],
    "telemetry_log": ["log_file"],
    "unsolicited_log": ["log_message"],
}
"""Members of a link that each section of a protocol sets."""

MEMBERS = sorted({member for members in PARTS.values() for member in members})


def sections_of(protocol: dict, path: str = "") -> dict:
    """Return the sections of a protocol; parts of a link and buses are sections."""
    sections = {}
    for name, part in protocol.items():
        if f"{path}{name}" in ("link", "link.buses"):
            sections |= sections_of(part, f"{path}{name}.")
        else:
            sections[f"{path}{name}"] = part
    return sections


def protocol_of_sections(sections: dict) -> dict:
    """Build the protocol with some sections."""
    protocol: dict = {}
    for path, part in sections.items():
        *owners, name = path.split(".")
        owner = protocol
        for key in owners:
            owner = owner.setdefault(key, {})
        owner[name] = part
    return protocol


@pytest.fixture(scope="module")
def icd() -> Icd:
    """Nodes with the messages of both programs and different sections of the protocol.

    One node has all sections, some have all but one, and some have one with the
    sections that it needs.
    """
    shipped = harness.shipped()
    acp, bootloader = shipped.node("cubeacp"), shipped.node("bootloader")
    complete = copy.deepcopy(
        {**shipped.protocol_of(bootloader), **shipped.protocol_of(acp)}
    )
    complete["procedures"] |= bootloader.protocol["procedures"]
    for procedure in complete["procedures"].values():
        procedure.pop("nodes", None)
    protocols = {"complete": complete}
    sections = sections_of(complete)
    # Sections that other sections need.
    needed = {key: {"link.checksums"} for key in ("procedures", "link.packets")}
    for bus in ("uart", "can"):
        needed[f"link.buses.{bus}"] = {"link.packets", "link.checksums"}
    for section in sections:
        title = section.replace(".", "_")
        protocols[f"without_{title}"] = protocol_of_sections(
            {
                name: part
                for name, part in sections.items()
                if name != section and section not in needed.get(name, ())
            }
        )
        protocols[f"only_{title}"] = protocol_of_sections(
            {name: sections[name] for name in (section, *needed.get(section, ()))}
        )
    taken = {id for message in bootloader.messages for id in message.ids}
    # Both programs have a message `State`; the variant uses its long name.
    names = {message.identifier for message in bootloader.messages}
    left = (message for message in acp.messages if not taken & set(message.ids))
    left = (
        dataclasses.replace(m, identifier=m.name) if m.identifier in names else m
        for m in left
    )
    acp = dataclasses.replace(acp, messages=tuple(left))
    bases = [
        dataclasses.replace(node, protocol={})
        for node in (*shipped.included(acp), bootloader, acp)
    ]
    includes = tuple(node.name for node in bases)
    variant = dataclasses.replace(acp, messages=(), enums=(), includes=includes)
    return Icd(
        (
            *bases,
            *(
                dataclasses.replace(variant, name=n, protocol=p)
                for n, p in protocols.items()
            ),
        )
    )


@pytest.fixture(scope="module")
def nodes(icd) -> list:
    return [node for node in icd.nodes if node.protocol]


@pytest.fixture(scope="module")
def headers(icd, tmp_path_factory):
    return harness.generate(icd, tmp_path_factory.mktemp("headers"))


@pytest.mark.parametrize(
    ("compiler", "standard"), [("gcc", "c99"), ("clang", "c99"), ("g++", "c++17")]
)
def test_every_selection_of_sections_compiles_without_a_warning(
    icd, headers, compiler, standard
):
    harness.compile_all(icd, headers, compiler, standard, "-fsyntax-only")


def test_the_link_has_the_sections_of_the_icd(nodes, headers, tmp_path):
    source = tmp_path / "parts.c"
    source.write_text(
        "#include <stdio.h>\n"
        + "".join(f'#include "{node.name}/link.h"\n' for node in nodes)
        + "static void tell(const char *name, const icd_link_t *link)\n{\n    fputs(name, stdout);\n"
        + "".join(
            f'    if (link->{member} != 0) fputs(" {member}", stdout);\n'
            for member in MEMBERS
        )
        + '    puts(link->i2c_address >= 0 ? " at an address" : "");\n}\nint main(void)\n{\n'
        + "".join(f'    tell("{node.name}", {node.name}_link());\n' for node in nodes)
        + "    return 0;\n}\n"
    )
    flags = ("-std=c99", *harness.WARNINGS, f"-I{headers}")
    program = harness.compile(source, *flags, output=tmp_path / "parts")
    lines = subprocess.run(
        [program], capture_output=True, text=True, check=True
    ).stdout.splitlines()
    assert lines == [" ".join([node.name, *parts(node.protocol)]) for node in nodes]


CLIENTS = """
#include <stdio.h>
#include <stdlib.h>
{includes}

static void on_event(void *context, const icd_event_t *event)
{{
    (void)context;
    (void)event;
}}

/* The status of a client and of its request, after which it is told of input. */
static void try_on(const icd_link_t *link, icd_bus_t bus, size_t size)
{{
    static const uint8_t bytes[] = {{1, 2, 3}};
    uint8_t *const buffer = (uint8_t *)malloc(size);
    icd_can_packet_t packet;
    icd_client_t client;
    icd_slot_t slot;
    icd_uart_line_t uart;
    icd_i2c_line_t i2c;
    icd_can_line_t can;
    memset(&packet, 0, sizeof packet);
    printf(" %d", (int)(bus == ICD_BUS_UART ? icd_client_uart(&client, link, &uart, &slot, 1, buffer, size)
                        : bus == ICD_BUS_I2C ? icd_client_i2c(&client, link, &i2c, &slot, 1, buffer, size)
                                             : icd_client_can(&client, link, &can, 2, &slot, 1, buffer, size)));
    printf("%d", (int)icd_client_request(&client, 0, link->telemetry[0].id));
    if (bus == ICD_BUS_CAN) {{
        icd_client_packet(&client, 1, &packet, on_event, NULL);
    }} else if (bus == ICD_BUS_UART) {{
        icd_client_received(&client, 1, bytes, sizeof bytes, on_event, NULL);
    }} else {{
        icd_client_transferred(&client, 1, bytes, sizeof bytes, on_event, NULL);
    }}
    free(buffer);
}}

int main(void)
{{
    static const icd_link_t *(*const links[])(void) = {{{links}}};
    for (size_t i = 0; i < sizeof links / sizeof links[0]; ++i) {{
        const icd_link_t *const link = links[i]();
        const size_t size = icd_client_bytes(link, 1);
        try_on(link, ICD_BUS_UART, size);
        try_on(link, ICD_BUS_I2C, size);
        try_on(link, ICD_BUS_CAN, size);
        try_on(link, ICD_BUS_UART, size - 1u);
        puts("");
    }}
    return 0;
}}
"""


def test_a_client_on_a_bus_missing_in_the_icd_refuses_every_request(
    nodes, headers, tmp_path
):
    source = tmp_path / "clients.c"
    includes = "\n".join(f'#include "{node.name}/link.h"' for node in nodes)
    source.write_text(
        CLIENTS.format(
            includes=includes, links=", ".join(f"{node.name}_link" for node in nodes)
        )
    )
    flags = ("-std=c99", *harness.WARNINGS, *harness.SANITIZERS, f"-I{headers}")
    program = harness.compile(source, *flags, output=tmp_path / "clients")
    lines = subprocess.run(
        [program], capture_output=True, text=True, check=True
    ).stdout.splitlines()
    ok, length, unsupported = "00", "14", "44"  # of the client and of the request
    buses = [
        [bus in buses_of(node.protocol) for bus in ("uart", "i2c", "can")]
        for node in nodes
    ]
    assert lines == [
        " ".join(
            [
                "",
                *(ok if bus else unsupported for bus in three),
                length if three[0] else unsupported,
            ]
        )
        for three in buses
    ]


def parts(protocol: dict) -> list[str]:
    """Members that the program of the test prints for the link of a protocol."""
    # Logs cannot be read without the mask.
    logs = {"telemetry_log", "unsolicited_log"}
    sections = sections_of(protocol).keys() - (
        logs if "log_mask" not in protocol else set()
    )
    members = sorted({member for section in sections for member in PARTS[section]})
    return [*members, *(["at an address"] if "i2c" in buses_of(protocol) else [])]
