"""Protocol section: keys without effect, and roles that a message or field cannot have.

ICD115 looks at `unsolicited_log`. ICD116 checks that fields named by `field` or
`fields` have a type for their role (`icdgen.icd.roles`) and only one role. ICD118
checks the types and roles of rows in log formats. `buses`, `packets` and `escapes`
report keys of `link` without effect.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from icdgen.icd.buses import BUSES, UART
from icdgen.icd.fault import Fault
from icdgen.icd.located import Map, Seq
from icdgen.icd.model import Node
from icdgen.icd.places import NodePlace, scalars_in
from icdgen.icd.roles import INTEGERS, PROTOCOL, Role, reasons_against
from icdgen.icd.rules.context import Context, section_of
from icdgen.icd.rules.protocol import sections
from icdgen.icd.rules.protocol_limits import roles_occur_once
from icdgen.icd.rules.protocol_names import FIELDS
from icdgen.icd.rules.rule import rule
from icdgen.icd.trees import mappings, named
from icdgen.wording import quote

INDEX_ROLES = ("type", "counter", "checksum", "size", "time", "meta")
ROWS = (("index_file", "entry"), ("telemetry_log", "header"), ("telemetry_log", "entry"),
    ("unsolicited_log", "message"))  # fmt: skip
ROWS_AS_BYTES = ("mask", "meta")


@rule("ICD115")
def keys_have_an_effect(ctx: Context) -> Iterator[Fault]:
    for node in ctx.icd.nodes:
        yield from _faults_of_unsolicited_log(node)


def _faults_of_unsolicited_log(node: Node) -> Iterator[Fault]:
    """Yield the faults of an unsolicited log that states `framed: false`, which has no
    effect, or another bus than the UART.
    """
    log = section_of(node, "unsolicited_log")
    if log is None:
        return
    if log.get("framed") is False:
        message = "framing is removed from unsolicited logs as from other messages, whatever this key says"
        yield Fault.at(log, "framed", message, "remove it, or `unsolicited_log`")
    buses = log.get("buses")
    for bus, place in buses.placed() if isinstance(buses, Seq) else ():
        if bus in BUSES and bus != UART:
            yield Fault(
                log,
                place,
                "unsolicited logs are received on the UART only",
                f"remove `{bus}`",
            )


@rule("ICD116", needs_complete=True)
def fields_can_have_their_roles(ctx: Context) -> Iterator[Fault]:
    for node in ctx.icd.nodes:
        messages = {message.name: message for message in ctx.messages_of(node)}
        for section in sections(node):
            message = named(messages, section.get("message"))
            if message is not None:
                fields = section.get("fields")
                owner, keys = (section, FIELDS) if fields is None else (fields, fields)
                yield from _fields(owner, keys, scalars_in(message.layout))


def _fields(
    owner: Map, keys: Iterable[str], fields: Iterable[NodePlace]
) -> Iterator[Fault]:
    """Yield the faults of fields that have two roles, or a role that they cannot have."""
    by_name = {field.name: field for field in fields if not field.is_read_only}
    seen: dict[str, str] = {}
    for key in keys:
        field = named(by_name, owner.get(key))
        if field is None:
            continue
        first_role = seen.setdefault(field.name, key)
        if first_role != key:
            yield Fault.at(
                owner,
                key,
                f"{quote(field.name)} is `{first_role}` already",
                "name the field of each part",
            )
        elif reasons := reasons_against(
            field.scalar, PROTOCOL.get(key, Role(INTEGERS))
        ):
            text = f"{quote(field.name)} cannot be `{key}`: it {reasons[0]}"
            yield Fault.at(owner, key, text, "name another field")


@rule("ICD118")
def rows_have_readable_types(ctx: Context) -> Iterator[Fault]:
    for path in ROWS:
        for section in ctx.sections(*path[:-1]):
            for row in mappings(section.get(path[-1])):
                role, type = row.get("role"), row.get("type")
                if isinstance(role, str) and isinstance(type, str):
                    wanted = ("bytes",) if role in ROWS_AS_BYTES else ("uint", "enum")
                    if type not in wanted:
                        message = f"the {role} is read as {' or '.join(wanted)}, not as {type}"
                        yield Fault.at(row, "type", message, "correct `type` or `role`")
    for index in ctx.sections("index_file"):
        if any("role" in row for row in mappings(index.get("entry"))):
            yield from roles_occur_once(
                index, "entry", INDEX_ROLES, "an entry of the index has no part for"
            )
