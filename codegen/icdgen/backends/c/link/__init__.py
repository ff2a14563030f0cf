"""The link of a node: its protocol facts as tables of the wire layer."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

from icdgen.backends.c.constants import Macro
from icdgen.backends.c.link.base import Table
from icdgen.backends.c.link.buses import BusTables
from icdgen.backends.c.link.files import FileTables
from icdgen.backends.c.link.logs import LogTables
from icdgen.backends.c.link.rows import boolean, or_none, row_of, short, wrapped
from icdgen.backends.c.names import constant
from icdgen.backends.c.text import comment, plain
from icdgen.describe import MessageDescription
from icdgen.icd.model import CONFIGURATION, Message
from icdgen.protocol.facts import Facts
from icdgen.protocol.sections import PROCEDURES

_REASONS = {"none", "unknown_id", "length", "parameter", "checksum"}


class Alias(NamedTuple):
    """A macro that stands for a message that can be requested: whose it is, and its id."""

    name: str
    value: str


def step_bytes(all_facts: Iterable[Facts]) -> int:
    """Bytes of the longest message that takes part in a procedure."""
    sizes = [1]
    for known in all_facts:
        sizes += [step.message.length for step in (known.files.steps.values() if known.files else ())]
        operations = [one for one in (known.program_copy, known.program_information) if one]
        sizes += [step.message.length for one in operations for step in (one.request, one.progress)]
        sizes += [message.length for message in (known.hole_map.messages if known.hole_map else ())]
    return max(sizes)


def sizes(known: Facts) -> list[Macro]:
    """Sizes of buffers."""
    upper, packet = known.node.name.upper(), known.can and known.can.extended
    rows = [("LONGEST", known.longest, "Bytes of the longest message of either direction, with id and checksum.")]
    slot = 0
    if known.can:
        slot = 1 + (-(-known.longest_data // packet.data_bytes) * packet.data_bytes if packet else 0)
        rows.append(("CAN_SLOT_BYTES", slot, "Bytes that joining CAN packets takes for each sender at once."))
    rows.append(("CLIENT_BYTES", known.longest_telecommand + max(slot, known.longest), "Bytes of a client's buffer."))
    if known.log_file and known.mask:
        most = known.mask.size + known.log_file.frames_at + known.mask.size * 8 * known.mask.slot_bytes
        rows.append(("LOG_BYTES", max(most, known.log_file.header_bytes), "Bytes of a log reader's buffer."))
    if known.files:
        files = known.files
        packets = known.packets_of(files.block_bytes)
        rows.append(("BLOCK_BYTES", packets * files.packet_bytes, "Bytes of the largest block of a file."))
        rows.append(("BLOCK_BITMAP_BYTES", -(-packets // 8), "Bytes of a bit for each packet of such a block."))
    found = [Macro(comment([text]), f"{upper}_{end}", f"{value}u") for end, value, text in rows]
    return [Macro(comment(["The node whose messages these are."]), f"{upper}_NODE", f'"{known.node.name}"'), *found]


def aliases(messages: Iterable[MessageDescription]) -> list[Alias]:
    """``DEMO_ANGLES_TELEMETRY``: how a message is requested, whatever its kind."""
    return [
        Alias(constant(one, "telemetry"), f"{one.model.node.upper()}_NODE, {one.model.telemetry_id}u")
        for one in messages
        if one.model.telemetry_id is not None
    ]


class LinkTables(BusTables, LogTables, FileTables):
    """The tables of one node, in the order in which they are declared."""

    def all(self) -> list[Table]:
        """Those of the parts, then the link itself."""
        known = self.known
        parts = [
            (self.owners(), ""),
            (f"{len(known.owners)}u", "how many"),
            (boolean(known.little), "byte order: little"),
            (boolean(known.node.bit_order == "msb0"), "bit 0 is the most significant one"),
            (f"{known.telemetry_ids.first}u, {known.telemetry_ids.last}u", "ids of telemetry"),
            (self.messages("telecommands", known.telecommands), ""),
            (self.messages("telemetry", known.telemetry), ""),
            (f"{len(short(known.telecommands))}u, {len(short(known.telemetry))}u", "how many"),
            (
                f"{known.longest_telecommand}u, {known.longest_reply}u, {known.longest}u",
                "longest telecommand, reply, any",
            ),
            (f"{known.longest_data}u", "longest without id and checksum"),
            (or_none(known.node.node_type), "node type"),
            (or_none(known.node.interface_version), "interface version"),
            (self.client(), ""),
            (self.errors(), ""),
            (f"{len(self.reasons())}u, {known.errors.get('none', 0)}u", "how many; no error"),
            (self.part("framing", known.framing, "uart.framing"), ""),
            (self.part("acknowledge", known.acknowledge, "uart.acknowledge"), ""),
            (or_none(known.i2c_address), "I2C address"),
            (self.polled(), ""),
            (self.can(), ""),
            (self.checksum(), ""),
            (self.crc16(), ""),
            (self.log_mask(), ""),
            (self.part("log_file", known.log_file, "telemetry_log"), ""),
            (self.log_message(), ""),
            (self.time(), ""),
            (self.index(), ""),
            (self.hole_map(), ""),
            (self.files(), ""),
            *((self.procedure(name), name) for name in PROCEDURES),
            (self.part("program_copy", known.program_copy, "program_copy"), "program copy"),
            (self.part("program_information", known.program_information, "program_information"), "program information"),
            (self.identification(), "identification"),
        ]
        self.add("link", "icd_link_t", [row_of(value, text) for value, text in parts], self.other_notes())
        return self.tables

    def owners(self) -> str:
        return self.add("nodes[]", "char *const", [f'"{name}",' for name in self.known.owners])

    def messages(self, name: str, known: dict[int, Message]) -> str:
        rows = []
        for id, message in sorted(short(known).items()):
            flags = []
            if name == "telecommands":
                flags += ["ICD_ACKNOWLEDGED"] if message.acknowledge else []
                flags += ["ICD_EXPECTS_RESET"] if message.expects_reset else []
                flags += ["ICD_SETTING"] if message.kind == CONFIGURATION else []
            text = plain(message.name)
            why = self.why.get((f"message {message.name}", "acknowledge"))
            text += f". Assumed acknowledge: {plain(why)}" if why and name == "telecommands" else ""
            rows += wrapped(f"{{{id}u, {' | '.join(flags) or '0u'}, {message.length}u}},", text)
        return self.add(f"{name}[]", "icd_message_t", rows) if rows else "NULL"

    def client(self) -> str:
        facts = (row.partition(", /*")[0] for row in self.facts("client", self.known.client))
        return f"{{{', '.join(facts)}}}"

    def reasons(self) -> list[tuple[str, int]]:
        return [(key, code) for key, code in self.known.errors.items() if key in _REASONS]

    def errors(self) -> str:
        rows = [f"{{ICD_REASON_{key.upper()}, {code}u}}," for key, code in self.reasons()]
        return self.add("errors[]", "icd_error_code_t", rows) if rows else "NULL"

    def identification(self) -> str:
        one = self.known.identification
        if one is None:
            return "NULL"
        return self.add("identification", "icd_step_t", [self.step("identification", one, braces=False)])
