"""Sessions of `icdgen monitor` and `icdgen send`: limits, settings and identity."""

from __future__ import annotations

from contextlib import ExitStack
from types import SimpleNamespace

import pytest
from icdgen_runtime.wire.awaited import Request
from icdgen_runtime.wire.events import Done, Timeout

from icdgen import codec
from icdgen.errors import UserError
from icdgen.icd.model import Icd
from icdgen.link import options, ports
from icdgen.link.options import identity_problem, open_session
from icdgen.protocol import facts
from icdgen.protocol.facts import Facts
from icdgen.runtime_objects.links import link_of_node
from tests.conformance.icds import icd_of
from tests.conftest import ROOT
from tests.limits import assert_limits

ICD = icd_of()
WHEEL = icd_of([ROOT / "examples" / "links" / "wheel.yaml"])


class MemoryPort:
    """A port that records what is written and whether it was closed."""

    def __init__(self) -> None:
        self.written: list[bytes] = []
        self.is_closed = False

    def write(self, data: bytes) -> None:
        self.written.append(data)

    def read(self, seconds: float) -> bytes:
        return b""

    def close(self) -> None:
        self.is_closed = True


@pytest.fixture
def opened(monkeypatch):
    """Return the ports that were opened, with their names."""
    result: list[tuple[str, MemoryPort]] = []

    def open_port(name: str, protocol: object) -> MemoryPort:
        result.append((name, MemoryPort()))
        return result[-1][1]

    monkeypatch.setattr(ports, "open_port", open_port)
    return result


def client_of(icd: Icd, node: str, *arguments: object, **more: object):
    """Open a session, and return its client after the session has ended."""
    given = (
        [False, 0, None, None, *arguments][-4:] if arguments else [False, 0, None, None]
    )
    node_facts = facts.of(icd, icd.node(node))
    with open_session(icd, node_facts, "tcp://a:1", *given, **more) as session:
        return session.client


def test_without_options_the_settings_are_those_of_the_icd(opened):
    link = link_of_node(ICD, ICD.node("cubeacp"))
    client = client_of(ICD, "cubeacp")
    assert client.settings == link.settings
    assert [(name, port.is_closed) for name, port in opened] == [("tcp://a:1", True)]


@pytest.mark.parametrize(
    ("timeout", "retries", "changed"),
    [
        (7, None, {"reply_timeout": 7}),
        (None, 0, {"retries": 0}),
        (9, 255, {"reply_timeout": 9, "retries": 255}),
    ],
)
def test_a_time_out_and_a_number_of_repetitions_replace_those_of_the_icd(
    opened, timeout, retries, changed
):
    link = link_of_node(ICD, ICD.node("cubeacp"))
    client = client_of(ICD, "cubeacp", False, 0, timeout, retries)
    assert client.settings == link.settings._replace(**changed)


def test_a_time_out_also_replaces_those_of_single_telecommands(opened):
    own = [
        row.timeout for row in link_of_node(WHEEL, WHEEL.node("wheel")).stream.exchanges
    ]
    assert 3000 in own
    for timeout, expected in ((None, own), (5, [0] * len(own))):
        client = client_of(WHEEL, "wheel", False, 0, timeout, None)
        assert [row.timeout for row in client.link.stream.exchanges] == expected
    again = link_of_node(WHEEL, WHEEL.node("wheel")).stream.exchanges
    assert [row.timeout for row in again] == own


def test_an_address_has_the_bits_of_the_identifier(opened):
    bits = facts.of(ICD, ICD.node("cubeacp")).can.parts["source"].bits
    assert bits == 8

    def is_accepted(address: int) -> bool:
        try:
            client_of(ICD, "cubeacp", False, address, None, None)
        except UserError as error:
            assert str(error) == f"--address {address} does not fit"
            assert error.help == "8 bits hold it"
            return False
        return True

    assert_limits(is_accepted, least=0, most=255)
    # Without CAN, the option has no limit.
    assert client_of(WHEEL, "wheel", False, 256, None, None)


@pytest.mark.parametrize(
    ("icd", "node", "port", "what"),
    [
        (WHEEL, "wheel", "can://socketcan/can0", "CAN"),
        (ICD, "cubemag", "tcp://a:1", "a stream of bytes"),
        (ICD, "cubemag", "can://socketcan/can0", "CAN"),
    ],
)
def test_a_bus_that_the_icd_does_not_describe_is_an_error(
    opened, icd, node, port, what
):
    node_facts = facts.of(icd, icd.node(node))
    with pytest.raises(UserError) as error, ExitStack() as stack:
        stack.enter_context(open_session(icd, node_facts, port, False, 0, None, None))
    assert str(error.value) == f"the ICD does not say how to talk to {node} over {what}"
    assert error.value.help == "see docs/reference/protocol.md"
    assert opened == []


def test_values_of_header_fields_are_checked_before_the_port_is_opened(opened):
    with pytest.raises(UserError, match="no packet of wheel has a field `source`"):
        client_of(WHEEL, "wheel", chosen=["source=1"])
    assert opened == []


class Session:
    """A session in which each request ends with the same outcome."""

    def __init__(self, outcome: object, node: str = "cubeacp") -> None:
        self.outcome, self.requests = outcome, []
        self.client = SimpleNamespace(link=link_of_node(ICD, ICD.node(node)))

    def start(self, request: Request) -> object:
        self.requests.append(request)
        return self.outcome


def identification(node_facts: Facts, node_type: int, version: int) -> bytes:
    report = node_facts.identification
    owner = ICD.node(report.message.node)
    raw = codec.initial_values(owner, report.message)
    raw |= {
        report.fields["node_type"]: node_type,
        report.fields["interface_version"]: version,
    }
    return codec.encode(owner, report.message, raw)


def test_the_identity_of_the_node_is_compared_with_the_icd():
    node = ICD.node("cubeacp")
    node_facts = facts.of(ICD, node)
    own = node.node_type, node.interface_version
    id = node_facts.identification.message.telemetry_id
    for numbers in (own, (own[0] + 1, own[1]), (own[0], own[1] + 1)):
        session = Session(Done(id, 1, identification(node_facts, *numbers)))
        expected = (
            f"the device says node type {numbers[0]}, interface version {numbers[1]}; "
            f"the ICD is that of node type {own[0]}, interface version {own[1]}"
        )
        problem = identity_problem(session, {})
        assert problem == (None if numbers == own else expected)
        assert session.requests == [Request("telemetry", id)]


def test_a_device_that_does_not_answer_is_reported_with_its_last_error():
    id = facts.of(ICD, ICD.node("cubeacp")).identification.message.telemetry_id
    for faults, text in (
        ({}, "the device does not answer"),
        ({id + 1: "wrong checksum"}, "the device does not answer"),
        ({id: "wrong checksum"}, "the device answers, but: wrong checksum"),
    ):
        assert identity_problem(Session(Timeout(id, 1)), faults) == text


def test_a_node_without_an_identification_is_not_asked():
    session = Session(None)
    session.client.link = link_of_node(WHEEL, WHEEL.node("wheel"))
    assert identity_problem(session, {}) is None
    assert session.requests == []


def test_options_are_in_a_fixed_order_in_the_help():
    @options.session_options
    def command() -> None:
        """Do nothing."""

    names = [option.name for option in reversed(command.__click_params__)]
    assert names == ["port", "crc", "address", "chosen", "timeout", "retries"]
