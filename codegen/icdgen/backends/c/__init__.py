"""C99 headers: one a message, one a node, one of the enumerations of a node, and one for support."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import PurePosixPath
from typing import TYPE_CHECKING

from icdgen import __version__
from icdgen.backends import Identifier
from icdgen.backends.c import about, accessors, constants, decoding, encoding, rows
from icdgen.backends.c.declared import declared
from icdgen.backends.c.dispatch import dispatchers
from icdgen.backends.c.plan import Plan, Planner
from icdgen.backends.c.statement import STEP
from icdgen.backends.c.text import comment, literal, plain
from icdgen.backends.c.words import RESERVED
from icdgen.icd.model import Enum, Icd, Node

if TYPE_CHECKING:
    from icdgen.protocol.facts import Facts

_MAX_ENUMERATOR = 32767
"""What every `int` can hold."""


class CBackend:
    """``--lang c``"""

    name = "c"
    reserved = RESERVED

    def files(self, icd: Icd, render) -> Iterator[tuple[PurePosixPath, str]]:
        """Every header, the support header first, then node by node."""
        planner = Planner(icd)
        yield PurePosixPath("icdgen.h"), render("icdgen.h.j2", version=__version__)
        links = {node.name: _facts(icd, node) for node in icd.nodes if icd.protocol_of(node)}
        if links:
            from icdgen.backends.c.link import step_bytes

            values = {"version": __version__, "step_bytes": step_bytes(links.values())}
            yield PurePosixPath("icdgen_wire.h"), render("icdgen_wire.h.j2", **values)
        for node in icd.nodes:
            folder = PurePosixPath(node.name)
            if node.enums:
                yield folder / "enums.h", render("enums.h.j2", **_enums(node, planner))
            plans = [planner.plan(message) for message in node.messages]
            loggable = {row.id: row.bit for row in node.loggable}
            for plan in plans:
                yield folder / f"{plan.file}.h", render("message.h.j2", **_message(plan, loggable))
            if node.name in links:
                yield folder / "link.h", render("link.h.j2", **_link(node, plans, links[node.name]))
            yield PurePosixPath(f"{node.name}.h"), render("node.h.j2", **_node(node, plans, planner))

    def identifiers(self, icd: Icd) -> Iterator[Identifier]:
        """Every name that the headers declare."""
        return declared(icd)


def _guard(*parts: str) -> str:
    return "_".join((*parts, "h")).upper()


def _message(plan: Plan, loggable: dict[int, int]) -> dict[str, object]:
    folders = sorted({m.field.enum.node for m in plan.members if m.field.enum is not None})
    enums = ("enums.h" if folder == plan.node.name else f"../{folder}/enums.h" for folder in folders)
    return {
        "version": __version__,
        "node": plan.node.name,
        "guard": _guard(plan.stem),
        "about": comment(["@file", *about.message(plan.message, loggable)]),
        "includes": ["../icdgen.h", *enums],
        "name": plan.stem,
        "upper": plan.stem.upper(),
        "length": plan.message.length,
        "ids": constants.ids(plan),
        "constants": constants.constants(plan),
        "members": rows.declarations(plan),
        "initial": constants.initial(plan),
        "decode": decoding.statements(plan),
        "misfits": rows.misfits(plan),
        "excess_type": rows.excess_type(plan),
        "encode": encoding.statements(plan),
        "whole_accessors": accessors.whole_accessors(plan),
        "accessors": accessors.accessors(plan),
        **rows.heads(plan),
    }


def _facts(icd: Icd, node: Node) -> Facts:
    from icdgen.protocol import facts

    return facts.of(icd, node)


def _link(node: Node, plans: list[Plan], known: Facts) -> dict[str, object]:
    from icdgen.backends.c.link import LinkTables, aliases, sizes

    return {
        "version": __version__,
        "node": node.name,
        "guard": _guard(node.name, "link"),
        "about": comment(["@file", f"{plain(node.title)}: how its messages travel."]),
        "title": plain(node.title),
        "constants": sizes(known),
        "aliases": aliases(plans),
        "tables": LinkTables(known).all(),
    }


def _enums(node: Node, planner: Planner) -> dict[str, object]:
    return {
        "version": __version__,
        "node": node.name,
        "guard": _guard(node.name, "enums"),
        "title": plain(node.title),
        "enums": [_enum(enum, planner) for enum in node.enums],
    }


def _enum(enum: Enum, planner: Planner) -> dict[str, object]:
    bits = planner.storages.enum_bits(enum)
    macros = any(member.value > _MAX_ENUMERATOR for member in enum.members)
    return {
        "name": planner.names.enum(enum),
        "bits": bits,
        "macros": macros,
        "comment": comment([about.enum(enum), about.sentence(enum.summary), *about.notes(enum.errata)]),
        "members": [
            {
                "name": planner.names.member(enum, member),
                "value": f"UINT64_C({member.value})" if bits == 64 else f"{member.value}u" if macros else member.value,
                "comment": comment(
                    [about.member(member), *about.notes(member.errata)],
                    "" if macros else STEP,
                ),
                "text": literal(member.name),
            }
            for member in enum.members
        ],
    }


def _node(node: Node, plans: list[Plan], planner: Planner) -> dict[str, object]:
    headers = [f"{name}.h" for name in node.includes]
    headers += [f"{node.name}/enums.h"] if node.enums else []
    headers += [f"{node.name}/{plan.file}.h" for plan in plans]
    headers += [f"{node.name}/link.h"] if planner.icd.protocol_of(node) else []
    return {
        "version": __version__,
        "node": node.name,
        "guard": _guard(node.name),
        "about": comment(["@file", f"{plain(node.title)}: all messages.", about.sentence(node.summary)]),
        "includes": ["icdgen.h", *headers],
        "title": plain(node.title),
        "upper": node.name.upper(),
        "digest": node.digest[:16],
        "constants": constants.of_node(node),
        "dispatchers": dispatchers(node, planner),
    }
