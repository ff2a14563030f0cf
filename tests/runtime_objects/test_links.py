"""Acknowledges and polled outcomes have their numbers at the places of the ICD."""

from __future__ import annotations

import pytest
from icdgen_runtime._errors import LengthError, RangeError, UnknownIdError
from icdgen_runtime.wire.errors import UnsupportedError

from icdgen import codec
from icdgen.describe import describe
from icdgen.icd.buses import I2C, UART
from icdgen.protocol import facts
from icdgen.runtime_objects.links import (
    acknowledge_of,
    link_of,
    link_of_node,
    responses_on,
    with_outcome,
)
from icdgen.runtime_objects.messages import ModelMessages
from tests.conformance.icds import icd_of

ICD = icd_of()
NODE = ICD.node("cubeacp")
FACTS = facts.of(ICD, NODE)
LINK = link_of_node(ICD, NODE)
CLASSES = ModelMessages(NODE.name, "telemetry", FACTS.telemetry, describe(ICD))


def test_a_link_is_made_once_for_each_node():
    made = link_of_node(ICD, NODE)
    assert link_of_node(ICD, NODE) is made
    assert link_of(ICD, FACTS) is not made
    assert link_of_node(ICD, ICD.node("bootloader")) is not made


@pytest.mark.parametrize("code", [0, 1, 3])
def test_an_acknowledge_has_the_id_and_the_code(code):
    data = acknowledge_of(LINK, 55, code)
    (response, *_) = responses_on(LINK, UART)
    assert len(data) == LINK.acknowledge_bytes
    assert response.echoes[0].place.of(data) == 55
    assert response.status.of(data) == code
    assert sum(byte != 0 for byte in data) == 1 + (code != 0)


def test_a_bus_without_an_exchange_has_no_responses():
    assert responses_on(LINK, "other") == ()
    assert responses_on(LINK, I2C) != ()


def test_an_outcome_changes_only_its_numbers_and_limits_the_parameter():
    polled = FACTS.polled
    frame = codec.encode(NODE, polled, codec.initial_values(NODE, polled))
    command = LINK.bus_exchanges[I2C].command
    (response,) = command.responses
    most = (1 << response.detail.bits) - 1
    for parameter in (0, most - 1, most, most + 1, 1 << 20):
        data = with_outcome(LINK, frame, 55, True, 2, parameter)
        assert len(data) == len(frame)
        assert response.echoes[0].place.of(data) == 55
        assert command.poll.until.of(data) == 1
        assert response.status.of(data) == 2
        assert response.detail.of(data) == min(parameter, most)
    assert with_outcome(LINK, frame, 0, False, 0, 0) == frame
    assert command.poll.until.of(with_outcome(LINK, frame, 55, False, 2, 0)) == 0


def test_messages_are_found_by_id_and_decode_and_encode_all_bytes():
    ids = [id for id, m in FACTS.telemetry.items() if m.length][:20]
    for id in ids:
        message_class = CLASSES[id]
        message = FACTS.telemetry[id]
        assert message_class is CLASSES[id]
        assert message.name == message_class.NAME
        assert message.length == message_class.LENGTH
        initial = codec.encode(NODE, message, codec.initial_values(NODE, message))
        assert message_class().to_bytes() == initial
        assert message_class.from_bytes(initial).to_bytes() == initial
        with pytest.raises(LengthError) as error:
            message_class.from_bytes(initial + b"\0")
        assert (error.value.expected, error.value.actual) == (
            message.length,
            message.length + 1,
        )
    with pytest.raises(UnknownIdError):
        CLASSES[max(FACTS.telemetry) + 1]


def test_a_value_out_of_range_is_an_error_with_the_attribute():
    for id in FACTS.telemetry:
        message = CLASSES[id]()
        for field in message.description.fields:
            if field.model.type == "uint" and field.model.bits < 32:
                setattr(message, field.name, 1 << field.model.bits)
                with pytest.raises(RangeError) as error:
                    message.to_bytes()
                assert error.value.field == field.name
                setattr(message, field.name, (1 << field.model.bits) - 1)
                break


def test_an_acknowledge_of_a_link_without_a_status_is_not_supported():
    (response, *_) = responses_on(LINK, UART)
    exchanges = LINK.bus_exchanges[UART]
    command = exchanges.command._replace(responses=(response._replace(status=None),))
    link = LINK._replace(bus_exchanges={UART: exchanges._replace(command=command)})
    with pytest.raises(UnsupportedError, match="status"):
        acknowledge_of(link, 55, 0)
