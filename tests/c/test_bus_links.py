"""The link of a node on buses in C has its members in the order of the runtime."""

from __future__ import annotations

from icdgen.backends.c.links import link_code
from icdgen.describe import describe
from icdgen.describe.links import Assumptions, links_of
from icdgen.loading import load
from tests.icd.files import write

BUSES = """\
icdgen: 1
node: {name: demo, title: Demo, byte_order: big, bit_order: msb0, node_type: 0}
protocol:
  link:
    buses:
      uart:
        framing: {by: escape, escape: 16, start: 2, end: 3, data: 16}
      i2c: {write: {address_8bit: 0xAE}}
messages:
  - {name: First, kind: telecommand, id: 0, length: 0}
  - {name: Last, kind: telecommand, id: 255, length: 3}
  - {name: Early, kind: telemetry, id: 0, length: 1}
"""


def test_a_link_has_its_members_in_the_order_of_the_runtime(tmp_path):
    icd = load([write(tmp_path, BUSES)], check=False).icd
    (link,) = links_of(describe(icd)).values()
    code = link_code(link, Assumptions(link.facts))
    assert [(each.function, each.bus) for each in code.links] == [
        ("link", None),
        ("uart_link", "uart"),
        ("i2c_link", "i2c"),
    ]
    of_node, of_uart, of_i2c = (list(each.table.rows) for each in code.links)
    node = "icdgen_node_demo_"
    exchanges = f"{{&{node}on_uart,\n            &{node}on_i2c,\n            NULL}}"
    assert of_node == [
        f"{node}nodes, /* whose messages */",
        "1u, /* how many */",
        "false, /* byte order: little */",
        "true, /* bit 0 is the most significant one */",
        "0u, 0u, /* ids of telemetry */",
        "0u, /* how many codes of refusals */",
        "0u, /* how many unsolicited */",
        f"ICDGEN_ROWS({node}telecommands), /* how many can be sent */",
        f"ICDGEN_ROWS({node}telemetry), /* how many can be requested */",
        f"{node}telecommands, /* what can be sent */",
        f"{node}telemetry, /* what can be requested */",
        "4u, 2u, 4u, /* longest telecommand, reply, any */",
        "3u, /* longest without id and checksum */",
        "4u, /* buffer for what is received */",
        "NULL, /* framing */",
        f"{exchanges}, /* exchanges on UART, I2C, CAN */",
        "NULL, /* checksums of messages */",
        "NULL, /* codes of refusals */",
        f"&{node}framing, /* framing of the UART */",
        "0u, /* bytes of an acknowledge */",
        "NULL, /* unsolicited */",
        "NULL, /* unsolicited logs */",
        "NULL, /* CAN */",
        "{1000u, 3u, 20u, 5000u, 1000u, 100u, 0u, 1u, 60000u}, "
        "/* times and limits: icd_client_settings_t */",
        "0, /* node type */",
        "-1, /* interface version */",
        "87, /* I2C address */",
        "true, /* I2C: a read may follow its write without a stop */",
        "-1, /* boot time in ms */",
        "NULL, /* mask of logs */",
        "NULL, /* log files */",
        "NULL, /* packed times */",
        "NULL, /* index of files */",
        "NULL, /* identification */",
    ]
    # Clients on a bus need only its exchanges and its framing.
    on_i2c = {f"&{node}on_uart": "NULL", f"&{node}framing": "NULL"}
    assert of_i2c == [_replaced(row, on_i2c) for row in of_node]
    assert of_uart == [_replaced(row, {f"&{node}on_i2c": "NULL"}) for row in of_node]
    assert [table.name.removeprefix(node) for table in code.tables] == [
        "uart_exchanges[]",
        "on_uart",
        "i2c_exchanges[]",
        "on_i2c",
        "telecommands[]",
        "telemetry[]",
        "nodes[]",
        "framing",
    ]


def _replaced(row, changes):
    for old, new in changes.items():
        row = row.replace(old, new)
    return row


def test_assumptions_without_a_table_of_their_own_are_explained_at_the_link(tmp_path):
    text = BUSES.replace(
        "data: 16}\n", "data: 16}\n        assumptions: {framing: Usual.}\n"
    )
    icd = load([write(tmp_path, text)], check=False).icd
    (link,) = links_of(describe(icd)).values()
    code = link_code(link, Assumptions(link.facts))
    comments = [each.table.comment for each in code.links]
    assert comments == ["    /** Assumed framing: Usual. */", "", ""]
