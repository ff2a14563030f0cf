"""A program of the simulated device: it processes telecommands and requests.

It checks telecommands as a device would, stores configuration, and answers requests
with the current values; procedures are in `icdgen.procedures`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import chain
from typing import Any

from icdgen_runtime.wire.i2c import i2c_write
from icdgen_runtime.wire.logs import LogMessage

from icdgen import codec
from icdgen.frozen import NamedTuple
from icdgen.icd.model import CONFIGURATION, Icd, Message, Node
from icdgen.icd.procedures import nested_steps
from icdgen.procedures.counterpart import Counterpart, Device, Refused
from icdgen.procedures.effects import effect_of
from icdgen.protocol import facts
from icdgen.protocol.exchange import NumberPlace
from icdgen.runtime_objects.links import link_of_node, responses_on, with_outcome
from icdgen.sim.refusals import refusal_code
from icdgen.sim.settings import SimulationSettings
from icdgen.sim.storage import DeviceStorage
from icdgen.sim.values import Values, number_places
from icdgen.values.frame import violations_of_value

RawValues = dict[str, "int | bytes"]


@dataclass(frozen=True, slots=True)
class TelecommandOutcome:
    """Result of a telecommand.

    ``field_index`` is the index of the first invalid field; 0 also if no field is
    invalid. ``is_answered``: the device sends an ACK or a NAK. ``reset`` is the message
    that restarts the device, which then does not respond.
    """

    code: int
    field_index: int = 0
    is_answered: bool = True
    reset: Message | None = None


class LogSetting(NamedTuple):
    """Configuration of the unsolicited log messages."""

    mask: bytes
    period_ms: int  # 0: no messages


class Program:
    """Firmware of the device, boot program or application: its values, statistics and
    procedures, from its start on.

    `take`, `refuse` and `requested_frame` are for buses. `icdgen.sim.framed_line`
    processes the packets of framed links itself.
    """

    def __init__(
        self,
        icd: Icd,
        node: Node,
        storage: DeviceStorage,
        settings: SimulationSettings,
        now: int,
    ) -> None:
        self.icd, self.node, self.settings = icd, node, settings
        self.facts = facts.of(icd, node)
        self.link = link_of_node(icd, node)
        self.values = Values(icd, node)
        procedures = [(each, effect_of(each)) for each in self.facts.procedures]
        checksum = self.facts.checksum_of_files
        device = Device(storage, settings.busy_ms, checksum)
        self.counterpart = Counterpart(procedures, device)
        kinds = (effect.kind for _, effect in procedures if effect.verb == "read")
        storage.provide_index(self.link, next(kinds, None), checksum)
        self.unsupported = self._unsupported()
        self.counts: dict[str, int] = {}  # statistics by role
        responses = chain.from_iterable(
            responses_on(self.link, bus) for bus in self.link.bus_exchanges
        )
        # Response with a field for the reason of a refusal; None if there is none.
        self.refusing_response = next((row for row in responses if row.reason), None)
        response = self.refusing_response
        meanings = response.meanings if response else ()
        self.success = next((code for code, says in meanings if says == "ack"), 0)
        self.last = (0, 0, 0)  # id, code and index of the field of the last telecommand
        self.free_at = now  # end of processing of the last telecommand
        self.log_at: int | None = None  # time of the next log message
        self._identify()
        for name, raw in settings.values.items():
            if name in self.values.frames:
                self.values.update(self.values.messages[name], raw)
        self._plan_log(now)

    def count(self, role: str) -> None:
        """Increment a counter of the statistics, or set a flag."""
        self.counts[role] = self.counts.get(role, 0) + 1

    def take(self, now: int, received: bytes, bus: str) -> TelecommandOutcome | None:
        """Process a telecommand; ``received`` begins with its id.

        Return None if it is lost because the previous one is still being processed.
        """
        if now < self.free_at:
            self.count("overrun")
            return None
        self.count("telecommands")
        outcome = self._processed(now, received, bus)
        self.free_at = now + self.settings.processing_ms
        self.last = (received[0], outcome.code, outcome.field_index)
        return outcome

    def refuse(self, received: bytes, reason: str | None = None) -> TelecommandOutcome:
        """Reject a telecommand without processing it, for an injected fault.

        ``reason`` is the name or number of a code. The code of an invalid value is sent
        instead if it is None or no code of the response.
        """
        self.count("telecommands")
        telecommand = self.facts.telecommands.get(received[0])
        is_answered = telecommand is None or telecommand.acknowledge
        outcome = self._refused("value", is_answered=is_answered)
        if reason is not None and self.refusing_response:
            code = refusal_code(self.refusing_response, reason)
            outcome = replace(outcome, code=outcome.code if code is None else code)
        self.last = (received[0], outcome.code, outcome.field_index)
        return outcome

    def requested_frame(self, now: int, id: int) -> bytes | None:
        """Count a request and return the current frame of its id.

        Return None for an unknown id, which is not counted.
        """
        message = self.facts.telemetry.get(id)
        if message is None:
            return None
        self.count("requests")
        return self.current(now, message)

    def current(self, now: int, message: Message) -> bytes:
        """Return the current frame of a message."""
        statistics = self._statistics(message)
        if statistics:
            raw = {**self.values.raw(message), **statistics}
            data = self.values.encode(message, raw)
        else:
            data = self.values.frame(message)
        data = self.counterpart.frame(now, message, data)
        if (
            message == self.facts.polled
        ):  # it reports the outcome of the last telecommand
            id, code, field_index = self.last
            is_processed = now >= self.free_at
            data = with_outcome(self.link, data, id, is_processed, code, field_index)
        return data

    def take_due_log(self, now: int) -> bytes | None:
        """Return an unsolicited log message if it is due, and schedule the next."""
        if self.log_at is None or now < self.log_at:
            return None
        self._plan_log(now)
        return self.log_message(now)

    def log_message(self, now: int) -> bytes | None:
        """Return an unsolicited log message with the selected frames.

        Return None if the ICD has no such messages.
        """
        setting, layout = self._log_setting(), self.facts.mask
        if setting is None or layout is None:
            return None
        frames = []
        fill = bytes([layout.fill])
        for slot in layout.selected(setting.mask):
            message = self.facts.telemetry.get(slot.id) if slot.id is not None else None
            data = self.current(now, message) if message else b""
            frames.append(data[: slot.length].ljust(slot.length, fill))
        return LogMessage.encode(self.link, setting.mask, frames)

    def first_invalid(
        self, message: Message, raw: Mapping[str, int | bytes]
    ) -> int | None:
        """Return the index of the first field with an invalid value, or None.

        With `strict` of the settings, the device also checks ranges and enumerations;
        otherwise only constants.
        """
        for index, field in enumerate(self.icd.longest_frame(message)):
            value = raw.get(field.name)
            if not isinstance(value, int):
                continue  # bytes, or an absent optional field
            if self.settings.strict:
                is_special = codec.special_of(field, value) is not None
                is_invalid = bool(violations_of_value(field, value)) and not is_special
            else:
                is_invalid = field.const is not None and value != field.const
            if is_invalid:
                return index
        return None

    def _processed(self, now: int, received: bytes, bus: str) -> TelecommandOutcome:
        telecommand = self.facts.telecommands.get(received[0])
        if telecommand is None or telecommand.name in self.unsupported:
            is_answered = telecommand is None or telecommand.acknowledge
            return self._refused("unknown_id", is_answered=is_answered)
        data, form = received[1:], self.facts.checksum
        # The checksum is optional unless `telecommand_always` has the bus: the length
        # shows whether it is there.
        if form and bus in form.telecommand_buses:
            if len(data) == telecommand.length + form.bytes:
                data = data[: telecommand.length]
                # `i2c_write` builds id, data and checksum, as they are sent on a UART
                # as well.
                if received != i2c_write(self.link, received[0], data, crc=True):
                    return self._refused("checksum")
            elif bus in form.telecommand_always and len(data) == telecommand.length:
                return self._refused("checksum")
        if len(data) != telecommand.length:
            return self._refused("length")
        raw = codec.decode(self.icd.node(telecommand.node), telecommand, data)
        if (index := self.first_invalid(telecommand, raw)) is not None:
            return self._refused("value", index)
        if telecommand.kind == CONFIGURATION:
            self.values.put(telecommand, data)
        try:
            self.counterpart.telecommand(now, telecommand, data)
        except Refused as refused:
            return self._refused("value", self._index(telecommand, refused.place))
        if telecommand.name == self._log_configuration().get("message"):
            self._plan_log(now)
        reset = telecommand if telecommand.expects_reset else None
        is_answered = telecommand.acknowledge and not reset
        return TelecommandOutcome(self.success, is_answered=is_answered, reset=reset)

    def _index(self, message: Message, place: NumberPlace | None) -> int:
        """Return the index of the field at a place; 0 without one."""
        places = number_places(self.icd, message)
        return places.index(place) if place in places else 0

    def _unsupported(self) -> set[str]:
        """Return the telecommands of procedures that only other nodes have."""
        procedures = self.icd.protocol_of(self.node).get("procedures", {})
        own = self.icd.procedures_of(self.node)
        return _sent_telecommands(procedures) - _sent_telecommands(own)

    def _refused(
        self, cause: str, field_index: int = 0, is_answered: bool = True
    ) -> TelecommandOutcome:
        """Return the outcome of a refusal; the code is 1 if the ICD has none for the
        cause.
        """
        code = self.facts.reasons.get(cause, 1)
        return TelecommandOutcome(code, field_index, is_answered)

    def _identify(self) -> None:
        """Set the numbers of the ICD in the telemetry that identifies the node."""
        report = self.facts.identification
        if report:
            values = {
                "node_type": self.node.node_type,
                "interface_version": self.node.interface_version,
            }
            raw = {
                field_name: values[role] or 0
                for role, field_name in report.fields.items()
                if role in values
            }
            self.values.update(report.message, raw)

    def _statistics(self, message: Message) -> RawValues:
        """Return the counters in a message; a flag is 1 after any event."""
        report = self.facts.statistics
        if report is None or report.message.name != message.name:
            return {}
        bits = {
            field.name: field.bits for field in self.icd.longest_frame(report.message)
        }
        result: RawValues = {}
        for role, name in report.fields.items():
            count = self.counts.get(role, 0)
            is_flag = bits[name] == 1
            result[name] = int(count > 0) if is_flag else count % (1 << bits[name])
        return result

    def _log_configuration(self) -> dict[str, Any]:
        """Return the section of the ICD that names the message and the fields with mask
        and period.
        """
        protocol = self.icd.protocol_of(self.node)
        section: dict[str, Any] = protocol.get("unsolicited_log", {})
        configured_by: dict[str, Any] = section.get("configured_by", {})
        return configured_by

    def _log_setting(self) -> LogSetting | None:
        """Return the current setting; None without unsolicited log messages."""
        section = self._log_configuration()
        message = self.values.messages.get(section.get("message", ""))
        if message is None or not self.facts.log_message:
            return None
        raw, fields = self.values.raw(message), section["fields"]
        period_ms = int(raw[fields["period"]]) * section["period_unit_ms"]
        return LogSetting(bytes(raw[fields["mask"]]), period_ms)

    def _plan_log(self, now: int) -> None:
        setting = self._log_setting()
        self.log_at = None
        if setting and setting.period_ms:
            self.log_at = now + setting.period_ms


def _sent_telecommands(procedures: Mapping[str, dict[str, Any]]) -> set[str]:
    """Return the names of the telecommands that these procedures send."""
    names: set[str] = set()
    for section in procedures.values():
        steps = nested_steps(section["steps"])
        names.update(step["send"] for step in steps if "send" in step)
    return names
