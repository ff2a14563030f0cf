"""The link that the calls make has every fact of the ICD, under the same name.

The runtime object is compared with the facts member by member, for all links of the
repository. The runtime has no objects of messages and enumerations, only their ids.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields, is_dataclass, replace
from functools import cache

import icdgen_runtime.wire.link as runtime
import pytest

from icdgen.describe import describe
from icdgen.describe.links import LinkDescription
from icdgen.icd.model import CONFIGURATION, Icd, Message
from icdgen.link_calls import Call, Commented, _plain, link_call, type_name
from icdgen.protocol import facts as protocol_facts
from icdgen.protocol.exchange import Exchange
from icdgen.protocol.facts import Facts
from icdgen.protocol.packet_formats import Check
from icdgen.protocol.procedures import PacketMap, Send
from icdgen.protocol.sections import (
    ChecksumAlgorithm,
    Crc,
    Framing,
    IndexField,
    LogFile,
    LogMessage,
    Report,
)
from icdgen.runtime_objects.links import link_of_node
from tests.conformance import ROOT
from tests.conformance.icds import LINKS, icd_of, shipped

# Members that the runtime does not have: texts and names of documents.
UNUSED = {"name", "seeds", "enum", "is_flag", "summary", "source", "register_names", "effect"}  # fmt: skip


# Sections whose assumptions concern no part of a link.
ELSEWHERE = {"boot", "unsolicited_log.configured_by"}
# Calls that name all of their members, also those with the default of the runtime.
COMPLETE = {"Settings", "TimePart", "PacketForm", "Stream", "Escaping", "Blocks"}


@cache
def icds() -> tuple[Icd, ...]:
    return shipped(), icd_of([ROOT / "examples" / "links", LINKS])


def linked() -> Iterator[tuple[Icd, Facts]]:
    for icd in icds():
        for node in icd.nodes:
            yield icd, protocol_facts.of(icd, node)


def differences(fact: object, part: object, link: object, path: str) -> Iterator[str]:
    """Yield the paths at which a part of the runtime does not have its fact."""
    if isinstance(fact, Exchange) and isinstance(part, int):
        part = link.stream.exchanges[part]
    if isinstance(fact, IndexField):
        fact = (fact.at, fact.bytes)
    if is_dataclass(fact):
        yield from of_members(fact, part, link, path)
    elif isinstance(fact, dict):
        if list(fact) != list(part or {}):
            yield f"{path}: {list(fact)} != {part}"
        for key in fact:
            yield from differences(fact[key], part[key], link, f"{path}.{key}")
    elif isinstance(fact, tuple) and not hasattr(fact, "_fields"):
        if len(fact) != len(part):
            yield f"{path}: {fact} != {part}"
        for each, other in zip(fact, part, strict=False):
            yield from differences(each, other, link, f"{path}[]")
    elif (fact, type(fact)) != (part, type(part)):
        yield f"{path}: {fact!r} != {part!r}"


def of_members(fact: object, part: object, link: object, path: str) -> Iterator[str]:
    """Yield the paths of the members of a dataclass object that differ."""
    expected = {each.name: getattr(fact, each.name) for each in fields(fact)}
    if isinstance(fact, Check):
        algorithm = expected.pop("algorithm")
        expected |= {"kind": algorithm.kind, "crc": algorithm.crc}
    if isinstance(fact, PacketMap):
        messages = expected.pop("messages")
        expected["telecommands"] = tuple(each.telecommand_id for each in messages)
        expected["telemetry"] = tuple(each.telemetry_id for each in messages)
        expected["length"] = messages[0].length
    if isinstance(fact, Report):
        message = expected.pop("message")
        expected["telecommand"] = message.telecommand_id
        expected["telemetry"] = message.telemetry_id
        expected["fields"] = {
            key: name.lower().replace(" ", "_") for key, name in fact.fields.items()
        }
    for name, value in expected.items():
        if name in UNUSED and not hasattr(part, name):
            continue
        own = name
        if isinstance(value, Message):
            is_sent = isinstance(fact, Send)
            value = value.telecommand_id if is_sent else value.telemetry_id
            if name == "message":
                own = "telecommand" if is_sent else "telemetry"
        if isinstance(value, ChecksumAlgorithm):
            own, value = "checksum" if hasattr(part, "checksum") else "name", value.name
        member = getattr(part, own, "missing")
        yield from differences(value, member, link, f"{path}.{own}")


SAME = """
    framing can checksums checksum mask log_file log_message identification statistics
    stream unsolicited bus_exchanges i2c_address i2c_repeated_start longest longest_data
""".split()


def test_a_link_has_the_facts_of_its_node():
    seen = set()
    for icd, facts in linked():
        link, node = link_of_node(icd, facts.node), facts.node
        pairs = {name: (getattr(facts, name), getattr(link, name)) for name in SAME}
        pairs |= {
            "settings": (facts.client, link.settings),
            "index_file": (facts.index, link.index_file),
            "time": (facts.time or None, link.time),
            "boot_time": (facts.boot_ms, link.boot_time),
            "procedures": ({p.name: p for p in facts.procedures}, link.procedures),
            "node": (node.name, link.node),
            "node_type": (node.node_type, link.node_type),
            "interface_version": (node.interface_version, link.interface_version),
            "order": ("little" if facts.little else "big", link.order),
            "acknowledge_bytes": (
                facts.acknowledge and facts.acknowledge.overhead,
                link.acknowledge_bytes,
            ),
        }
        for name, (fact, part) in pairs.items():
            assert list(differences(fact, part, link, f"{node.name}.{name}")) == []
            seen |= {name} if part else set()
        assert (
            facts.telemetry_ids.first,
            facts.telemetry_ids.last,
        ) == link.telemetry_ids
        if facts.stream:
            assert facts.stream.confirming == link.stream.confirming
        for procedure in facts.procedures:
            steps = link.procedures[procedure.name].steps
            assert [type(step).__name__ for step in procedure.steps] == [
                type(step).__name__ for step in steps
            ]
    assert seen == set(pairs), "each part is compared at least once"


def test_a_link_has_the_lengths_and_flags_of_its_messages():
    flags = set()
    for icd, facts in linked():
        link = link_of_node(icd, facts.node)
        if facts.stream:
            assert link.frames == link.commands == {}, "its rows have the lengths"
            continue
        assert link.frames == {id: m.length for id, m in facts.telemetry.items()}
        assert link.commands == {
            id: runtime.Sent(
                message.length, message.acknowledge, message.kind == CONFIGURATION
            )
            for id, message in facts.telecommands.items()
        }
        flags |= {sent[1:] for sent in link.commands.values()}
    assert flags == {(True, False), (True, True), (False, False)}


def test_a_link_has_the_assumptions_of_the_icd_and_its_comments_have_each_once():
    assumed = 0
    for icd, facts in linked():
        link = link_of_node(icd, facts.node)
        assert [tuple(each) for each in link.assumptions] == [
            (each.section, each.key, _plain(each.value), each.why)
            for each in facts.assumptions
        ]
        call = link_call(LinkDescription(describe(icd), facts))
        comments = sorted(comment for part in parts(call) for comment in texts(part))
        whys = sorted(
            each.why for each in facts.assumptions if each.section not in ELSEWHERE
        )
        assert sorted(text.partition(": ")[2] for text in comments) == whys, link.node
        assumed += len(whys)
    assert assumed > 10


def parts(part: object) -> Iterator[object]:
    """Yield a part of a call and all parts in it."""
    yield part
    inner: tuple[object, ...] = ()
    if isinstance(part, Call):
        inner = (*part.positional, *part.keywords.values())
    elif isinstance(part, Commented):
        inner = (part.item,)
    elif isinstance(part, dict):
        inner = tuple(part.values())
    elif isinstance(part, tuple):
        inner = part
    for each in inner:
        yield from parts(each)


def texts(part: object) -> tuple[str, ...]:
    return part.comments if isinstance(part, Commented) else ()


def test_a_zero_is_a_value_and_only_a_separate_read_on_i2c_is_mentioned():
    icd = shipped()
    facts = protocol_facts.of(icd, icd.node("cubeacp"))

    def keywords(**changes: object) -> dict[str, object]:
        changed = replace(facts, **changes)
        return dict(link_call(LinkDescription(describe(icd), changed)).keywords)

    link = keywords(boot_ms=0, i2c_address=0, i2c_repeated_start=False)
    assert (link["boot_time"], link["i2c_address"]) == (0, 0)
    assert link["i2c_repeated_start"] is False
    assert "i2c_repeated_start" not in keywords(i2c_repeated_start=True)
    absent = keywords(boot_ms=None, i2c_address=None, time={}, mask=None)
    assert not {"boot_time", "i2c_address", "time", "mask"} & absent.keys()


def test_calls_omit_members_that_have_the_default_of_the_runtime():
    omitted = set()
    for icd, facts in linked():
        for part in parts(link_call(LinkDescription(describe(icd), facts))):
            if not isinstance(part, Call) or part.name[5:] in COMPLETE:
                continue
            defaults = getattr(runtime, part.name[5:])._field_defaults
            for key, value in part.keywords.items():
                assert key not in defaults or value != defaults[key], part
            if defaults.keys() - part.keywords.keys():
                omitted.add(part.name[5:])
    assert {
        "Input",
        "PacketField",
        "Sent",
        "StreamRow",
        "Exchange",
        "Response",
    } <= omitted


def test_small_calls_are_on_one_line_and_steps_with_fields_on_several():
    flat: dict[str, set[bool]] = {}
    for icd, facts in linked():
        for part in parts(link_call(LinkDescription(describe(icd), facts))):
            if isinstance(part, Call):
                flat.setdefault(part.name[5:], set()).add(part.is_flat)
    rows = (
        "Sent NumberPlace Echo PacketField StreamRow CanPart LogBit TimePart CheckForm"
    )
    assert all(flat[name] == {True} for name in rows.split())
    forms = "Link Settings Framing Can Stream PacketForm Exchange Response Report"
    assert all(flat[name] == {False} for name in forms.split())
    assert flat["Send"] == {True, False}


@pytest.mark.parametrize(
    ("part", "name"),
    [
        (Crc, "CrcForm"),
        (LogFile, "LogFileForm"),
        (LogMessage, "LogMessageForm"),
        (Framing, "Framing"),
    ],
)
def test_a_part_has_the_name_of_its_type_in_the_runtime(part, name):
    assert type_name(part) == name
    assert hasattr(runtime, name)


def test_a_plain_value_has_no_places_and_no_notes():
    class Text(str):
        pass

    class Number(int):
        pass

    given = {Text("a"): [Number(1), True, None, 2.5], "source": 1, "assumptions": {}}
    result = _plain(given | {"b": {"source": 2, "c": (0, "")}, "d": {1}})
    assert result == {"a": (1, True, None, 2.5), "b": {"c": (0, "")}, "d": "{1}"}
    assert [type(each) for each in result["a"]] == [int, bool, type(None), float]
    assert {type(key) for key in result} == {str}
