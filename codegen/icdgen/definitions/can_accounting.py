"""Account for the parts of SYM, KCD and ARXML files that cantools ignores without a
warning.

The tables list the parts that cantools reads and `can` uses, and parts without meaning
for an ICD. All other parts are counted.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import cast
from xml.etree.ElementTree import Element

from icdgen.definitions.accounting import Account, AccountedElement

# KCD: the attributes and child elements of each element.
_KCD: Mapping[str, frozenset[str]] = {
    "NetworkDefinition": frozenset(
        {"Bus", "Node", "Document", "schemaLocation", "noNamespaceSchemaLocation"}
    ),
    "Document": frozenset({"name", "author", "company", "date", "version", "text"}),
    "Node": frozenset({"id", "name"}),
    "Bus": frozenset({"name", "Message"}),
    "Message": frozenset(
        {
            "name",
            "id",
            "format",
            "length",
            "interval",
            "triggered",
            "Notes",
            "Producer",
            "Multiplex",
            "Signal",
        }
    ),
    "Producer": frozenset({"NodeRef"}),
    "Consumer": frozenset({"NodeRef"}),
    "NodeRef": frozenset({"id"}),
    "Multiplex": frozenset(
        {
            "name",
            "offset",
            "length",
            "endianess",
            "MuxGroup",
            "Value",
            "Notes",
            "LabelSet",
            "Consumer",
        }
    ),
    "MuxGroup": frozenset({"count", "Signal"}),
    "Signal": frozenset(
        {
            "name",
            "offset",
            "length",
            "endianess",
            "Value",
            "Notes",
            "LabelSet",
            "Consumer",
        }
    ),
    "Value": frozenset({"min", "max", "slope", "intercept", "unit", "type"}),
    "LabelSet": frozenset({"Label"}),
    "Label": frozenset({"name", "value", "type"}),
    "Notes": frozenset({"text"}),
}

# SYM: keys of the head and of symbols, and attributes of signals.
_SYM_KEYS = frozenset(
    {"FormatVersion", "Enum", "Sig", "Var", "Mux", "ID", "Len", "CycleTime", "Type"}
)
_SYM_WITHOUT_MEANING = frozenset(
    {"Title", "UniqueVariables", "FloatDecimalPlaces", "BRS", "Color"}
)
_SYM_ATTRIBUTES = frozenset({"u", "f", "o", "min", "max", "e", "spn"})
_SYM_LINE = re.compile(r"\s*(\w+)\s*=")
_SYM_TOKEN = re.compile(r'"(?:\\"|[^"])*"|//.*|/(\w+):')
_SYM_NUMBERED = re.compile(r'(?:Sig|Var)\s*=\s*(?:"[^"]*"|\w+)\s+(string|raw|char)\b')

# ARXML: the elements of packages that cantools reads, that these refer to by name, or
# that have no meaning for an ICD.
_ARXML = frozenset(
    {
        "BASE-TYPE", "SW-BASE-TYPE", "CAN-CLUSTER", "CAN-FRAME", "COMPU-METHOD", "CONSTANT-SPECIFICATION", "ECU-INSTANCE",
        "I-SIGNAL", "I-SIGNAL-GROUP", "I-SIGNAL-I-PDU", "ISIGNAL-I-PDU", "MULTIPLEXED-I-PDU", "N-PDU", "NM-PDU",
        "GENERAL-PURPOSE-PDU", "SYSTEM", "SYSTEM-SIGNAL", "SYSTEM-SIGNAL-GROUP", "UNIT", "CONTAINER-I-PDU", "SECURED-I-PDU",
        "I-SIGNAL-I-PDU-GROUP", "PHYSICAL-DIMENSION", "DATA-CONSTR",
    }
)  # fmt: skip


def account_for_kcd(root: Element, account: Account) -> None:
    """Count attributes and elements of a KCD file that are not used."""
    stack = [root]
    while stack:
        element = stack.pop()
        owner = _local(element.tag)
        used = _KCD.get(owner, frozenset())
        place = f"`{element.get('name')}`" if element.get("name") else ""
        for key in element.attrib:
            if _local(key) not in used:
                account.add(
                    owner, _local(key), place, cast(AccountedElement, element).line
                )
        for child in reversed(element):
            if not isinstance(child.tag, str):
                continue  # a comment
            if _local(child.tag) in used:
                stack.append(child)
            else:
                account.add(
                    owner, _local(child.tag), place, cast(AccountedElement, child).line
                )


def account_for_sym(text: str, account: Account) -> None:
    """Count unused keys and attributes of a symbol file, and types that are imported as
    numbers.
    """
    symbol = ""
    for number, line in enumerate(text.splitlines(), 1):
        if begin := re.match(r'\s*\["?([^"\]]*)"?\]', line):
            symbol = f"`{begin[1]}`"
        key = _SYM_LINE.match(line)
        if key is None or key[1].isdigit():
            continue
        if key[1] not in _SYM_KEYS | _SYM_WITHOUT_MEANING:
            account.add("", key[1], symbol, number)
        for token in _SYM_TOKEN.finditer(line):
            if token[1] and token[1] not in _SYM_ATTRIBUTES:
                account.add(key[1], f"/{token[1]}:", symbol, number)
        if numbered := _SYM_NUMBERED.search(line):
            account.add(key[1], f"type {numbered[1]}", symbol, number)


def account_for_arxml(root: Element, account: Account) -> None:
    """Count package elements of ARXML kinds that do not describe frames, PDUs or
    signals on CAN.
    """
    for element in root.iter():
        if isinstance(element.tag, str) and _local(element.tag) == "ELEMENTS":
            for child in element:
                if (
                    isinstance(child.tag, str)
                    and (kind := _local(child.tag)) not in _ARXML
                ):
                    name = next(
                        (
                            inner.text
                            for inner in child
                            if _local(inner.tag) == "SHORT-NAME"
                        ),
                        None,
                    )
                    account.add(
                        "ELEMENTS",
                        kind,
                        f"`{name}`" if name else "",
                        cast(AccountedElement, child).line,
                    )


def _local(name: str) -> str:
    return name.rpartition("}")[2]
