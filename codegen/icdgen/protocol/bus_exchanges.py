"""Responses on UART, I2C and CAN, in the classes of framed links
(`icdgen.protocol.exchange`), so that one client serves all links.

A packet without a message is an arrival with an index: `ACKNOWLEDGE`, `REFUSAL` or
`REQUEST_REFUSAL`. Its bytes, in which places count, are the id, as one byte, and the
data; on the UART these are the bytes of the message.
"""

from __future__ import annotations

from icdgen.frozen import dataclass
from icdgen.icd.buses import CAN, I2C, UART
from icdgen.icd.model import Node
from icdgen.icd.responses import ACK, AGAIN, ID_BYTES, NAK, REPLY, field_of
from icdgen.protocol.exchange import Echo, Exchange, NumberPlace, Poll, Response
from icdgen.protocol.responding import place_of
from icdgen.protocol.sections import Acknowledge, Can, Framing, Polled

ACKNOWLEDGE, REFUSAL, REQUEST_REFUSAL = range(3)

# The id as one number. An id on these buses is a byte, so that one byte of a response
# can repeat it.
_ID = NumberPlace(0, ID_BYTES, 0, 8 * ID_BYTES, False)  # in `Exchange.sources`
_ECHO = Echo(NumberPlace(0, 1, 0, 8, False), 0)  # the first byte of a packet
_REQUESTED = Response(None, REPLY, (), None, (), None, ())


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class BusExchanges:
    """Exchanges on a bus.

    ``command``: of all telecommands that are acknowledged; None if the bus brings no
    acknowledge. ``request``: of telemetry.
    """

    command: Exchange | None
    request: Exchange


def bus_exchanges(
    node: Node,
    errors: dict[str, int],
    framing: Framing | None,
    acknowledge: Acknowledge | None,
    i2c_address: int | None,
    polled: Polled | None,
    can: Can | None,
) -> dict[str, BusExchanges]:
    """Return the exchanges on each bus of a node that is not on a framed link."""
    buses = {}
    if framing:
        buses[UART] = _exchanges(
            _acknowledged(acknowledge, errors) if acknowledge else ()
        )
    if i2c_address is not None:
        # The ACK bit of I2C (UM10204, 3.1.6) confirms a byte on the bus, and not that
        # the node accepts a telecommand.
        if polled:
            response, poll = _polled(node, polled, errors)
            buses[I2C] = _exchanges((response,), poll=poll)
        else:
            buses[I2C] = _exchanges(())
    if can:
        buses[CAN] = _exchanges(
            _packets(can, {"acknowledge": ACKNOWLEDGE, "refusal": REFUSAL}),
            _packets(can, {"request_refusal": REQUEST_REFUSAL}),
        )
    return buses


def _exchanges(
    to_command: tuple[Response, ...],
    to_request: tuple[Response, ...] = (),
    poll: Poll | None = None,
) -> BusExchanges:
    command = Exchange((_ID,), to_command, 0, poll=poll) if to_command else None
    return BusExchanges(command, Exchange((_ID,), (_REQUESTED, *to_request), 0))


def _acknowledged(
    acknowledge: Acknowledge, errors: dict[str, int]
) -> tuple[Response, ...]:
    """Return the acknowledge on the UART, whose code can also refuse."""
    status = NumberPlace(acknowledge.error_at, 1, 0, 8, False)
    echo = Echo(NumberPlace(acknowledge.id_at, 1, 0, 8, False), 0)
    return (_with_code(None, ACKNOWLEDGE, echo, status, acknowledge.success, errors),)


def _polled(
    node: Node, polled: Polled, errors: dict[str, int]
) -> tuple[Response, Poll]:
    """Return the telemetry that is polled on I2C for the outcome of a telecommand."""
    names = (polled.id, polled.processed, polled.error, polled.parameter)
    places = [place_of(node, field_of(polled.message, name)) for name in names]
    id, processed, error, parameter = places
    assert id and processed and error, "a field that a client compares is one number"
    # Of a set id and a get id, the last one is the get id.
    telemetry = polled.message.ids[-1]
    response = _with_code(
        telemetry, None, Echo(id, 0), error, polled.success, errors, parameter
    )
    return response, Poll(telemetry, processed)


def _with_code(
    telemetry: int | None,
    packet: int | None,
    echo: Echo,
    code: NumberPlace,
    success: tuple[int, ...],
    errors: dict[str, int],
    detail: NumberPlace | None = None,
) -> Response:
    """Return a response with an error code.

    After a wrong checksum, the telecommand was damaged on the line and is sent again.
    """
    meanings = [(number, ACK) for number in success]
    if "checksum" in errors:
        meanings.append((errors["checksum"], AGAIN))
    return Response(
        telemetry,
        NAK,
        (echo,),
        code,
        tuple(meanings),
        code,
        tuple((number, role) for role, number in errors.items() if role != "none"),
        packet,
        detail=detail,
    )


def _packets(can: Can, indices: dict[str, int]) -> tuple[Response, ...]:
    """Return the CAN packets without data that respond."""
    return tuple(
        Response(
            None,
            ACK if index == ACKNOWLEDGE else NAK,
            (_ECHO,),
            None,
            (),
            None,
            (),
            index,
        )
        for kind, index in indices.items()
        if kind in can.types
    )
