"""The ``LINK`` of a node, as its generated package has it, of the objects of the runtime."""

from __future__ import annotations

from collections.abc import Mapping

from icdgen_runtime.wire import link as types
from icdgen_runtime.wire.link import Link

from icdgen.backends.python.links import call
from icdgen.backends.python.literals import Call, Noted, Verbatim
from icdgen.backends.python.objects.messages import ModelMessages
from icdgen.describe import describe
from icdgen.describe.links import LinkDescription
from icdgen.icd.model import Icd
from icdgen.protocol.facts import Facts


def link_of(icd: Icd, known: Facts) -> Link:
    """What the wire layer has to know of a node, ``known`` being the facts of it."""
    node, description = known.node.name, describe(icd)
    names = {
        "TELECOMMANDS": ModelMessages(node, "telecommand", known.telecommands, description),
        "TELEMETRY": ModelMessages(node, "telemetry", known.telemetry, description),
    }
    made = _object(call(LinkDescription(description, known)), names)
    assert isinstance(made, Link)
    return made


def _object(value: object, names: Mapping[str, object]) -> object:
    """The object that an expression of the Python backend stands for."""
    if isinstance(value, Noted):
        return _object(value.item, names)
    if isinstance(value, Verbatim):
        return names[value.text]
    if isinstance(value, Call):
        positional = (_object(one, names) for one in value.positional)
        keywords = {key: _object(one, names) for key, one in value.keywords.items()}
        return getattr(types, value.name.rpartition(".")[2])(*positional, **keywords)
    if isinstance(value, Mapping):
        return {_object(key, names): _object(one, names) for key, one in value.items()}
    if isinstance(value, tuple | list):
        return tuple(_object(one, names) for one in value)
    return value
