"""Link of a node as an object of the runtime, equal to ``LINK`` in generated code.

`icdgen.link_calls` describes the object as constructor calls; `link_of` evaluates them.
`link_of_node` keeps the objects of the nodes of the most recent ICD.
"""

from __future__ import annotations

from collections.abc import Mapping

from icdgen_runtime.wire import link as types
from icdgen_runtime.wire.errors import need
from icdgen_runtime.wire.link import Link
from icdgen_runtime.wire.packet_formats import Response

from icdgen.describe import describe
from icdgen.describe.links import LinkDescription
from icdgen.icd.buses import I2C, UART
from icdgen.icd.model import Icd, Node
from icdgen.icd.node_cache import cached_by_node
from icdgen.link_calls import Call, Commented, Verbatim, link_call
from icdgen.protocol import facts as protocol_facts
from icdgen.protocol.facts import Facts
from icdgen.runtime_objects.messages import ModelMessages


def link_of(icd: Icd, facts: Facts) -> Link:
    """Return the link of the node that the facts belong to."""
    node, description = facts.node.name, describe(icd)
    # Names that the calls refer to; in generated code, these are module variables.
    names = {
        "TELECOMMANDS": ModelMessages(
            node, "telecommand", facts.telecommands, description
        ),
        "TELEMETRY": ModelMessages(node, "telemetry", facts.telemetry, description),
    }
    link = _evaluate(link_call(LinkDescription(description, facts)), names)
    assert isinstance(link, Link)
    return link


@cached_by_node
def link_of_node(icd: Icd, node: Node) -> Link:
    """Return the link of a node."""
    return link_of(icd, protocol_facts.of(icd, node))


def responses_on(link: Link, bus: str) -> tuple[Response, ...]:
    """Return the responses to telecommands on UART, I2C or CAN."""
    exchanges = link.bus_exchanges.get(bus)
    return exchanges.command.responses if exchanges and exchanges.command else ()


def acknowledge_of(link: Link, id: int, code: int) -> bytes:
    """Return the acknowledge of a telecommand on the UART."""
    response, data = responses_on(link, UART)[0], bytearray(link.acknowledge_bytes or 0)
    response.echoes[0].place.put(id, data)
    need(response.status, "status").put(code, data)
    return bytes(data)


def with_outcome(
    link: Link, frame: bytes, id: int, is_processed: bool, code: int, parameter: int
) -> bytes:
    """Return the telemetry that is polled on I2C with the outcome of a telecommand.

    ``parameter``: index of a wrong parameter, which is limited to what its field can
    hold.
    """
    command = link.bus_exchanges[I2C].command
    assert command and command.poll
    (response,), data = command.responses, bytearray(frame)
    response.echoes[0].place.put(id, data)
    command.poll.until.put(int(is_processed), data)
    if response.status:
        response.status.put(code, data)
    if response.detail:
        most = (1 << response.detail.bits) - 1
        response.detail.put(min(parameter, most), data)
    return bytes(data)


def _evaluate(value: object, names: Mapping[str, object]) -> object:
    """Return the object that an expression of `icdgen.link_calls` describes."""
    if isinstance(value, Commented):
        return _evaluate(value.item, names)
    if isinstance(value, Verbatim):
        return names[value.text]
    if isinstance(value, Call):
        positional = (_evaluate(item, names) for item in value.positional)
        keywords = {key: _evaluate(item, names) for key, item in value.keywords.items()}
        return getattr(types, value.name.rpartition(".")[2])(*positional, **keywords)
    if isinstance(value, Mapping):
        return {
            _evaluate(key, names): _evaluate(item, names) for key, item in value.items()
        }
    if isinstance(value, tuple | list):
        return tuple(_evaluate(item, names) for item in value)
    return value
