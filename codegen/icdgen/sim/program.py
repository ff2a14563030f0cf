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
from icdgen.icd.model import CONFIGURATION, Icd, Message, Node
from icdgen.icd.procedures import nested_steps
from icdgen.procedures.counterpart import Counterpart, Device, Refused
from icdgen.procedures.effects import effect_of
from icdgen.protocol import facts
from icdgen.protocol.exchange import NumberPlace
from icdgen.runtime_objects.links import link_of, responses_on, with_outcome
from icdgen.sim.refusals import refusal_code
from icdgen.sim.settings import SimulationSettings
from icdgen.sim.storage import DeviceStorage
from icdgen.sim.values import Values, number_places
from icdgen.values.frame import violations_of_value

Raw = dict[str, "int | bytes"]


@dataclass(frozen=True, slots=True)
class TelecommandOutcome:
    """Result of a telecommand.

    ``reset`` is the message that restarts the device, which then does not respond.
    """

    code: int
    parameter: int = 0
    acknowledge: bool = True
    reset: Message | None = None


class Program:
    """A program that has just been started."""

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
        self.link = link_of(icd, self.facts)
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
        # Response with the code of a refusal; None without one.
        self.refusal = next((row for row in responses if row.reason), None)
        meanings = self.refusal.meanings if self.refusal else ()
        self.success = next((code for code, says in meanings if says == "ack"), 0)
        self.last = (0, 0, 0)  # id, code and parameter of the last telecommand
        self.free_at = now  # end of processing of the last telecommand
        self.log_at: int | None = None
        self._identify()
        for name, raw in settings.values.items():
            if name in self.values.frames:
                self.values.update(self.values.messages[name], raw)
        self._plan_log(now)

    def count(self, role: str) -> None:
        """Increment a counter of the statistics, or set a flag."""
        self.counts[role] = self.counts.get(role, 0) + 1

    def take(self, now: int, message: bytes, bus: str) -> TelecommandOutcome | None:
        """Process a telecommand, which begins with its id.

        Return None if it is lost because the previous one is still being processed.
        """
        if now < self.free_at:
            self.count("overrun")
            return None
        self.count("telecommands")
        outcome = self._take(now, message, bus)
        self.free_at = now + self.settings.processing_ms
        self.last = (message[0], outcome.code, outcome.parameter)
        return outcome

    def refuse(self, message: bytes, reason: str | None = None) -> TelecommandOutcome:
        """Reject a telecommand without processing it.

        ``reason`` is the name or number of a code; None for that of a wrong parameter.
        """
        self.count("telecommands")
        telecommand = self.facts.telecommands.get(message[0])
        is_acknowledged = telecommand is None or telecommand.acknowledge
        outcome = self._refusal("value", acknowledge=is_acknowledged)
        if reason is not None and self.refusal:
            code = refusal_code(self.refusal, reason)
            outcome = replace(outcome, code=outcome.code if code is None else code)
        self.last = (message[0], outcome.code, outcome.parameter)
        return outcome

    def frame(self, now: int, id: int) -> bytes | None:
        """Return the frame with this id, or None."""
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
            id, code, parameter = self.last
            is_processed = now >= self.free_at
            data = with_outcome(self.link, data, id, is_processed, code, parameter)
        return data

    def log_due(self, now: int) -> bytes | None:
        """Return an unsolicited log message if it is due."""
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
        for slot in layout.selected(setting[0]):
            message = self.facts.telemetry.get(slot.id) if slot.id is not None else None
            data = self.current(now, message) if message else b""
            frames.append(data[: slot.length].ljust(slot.length, fill))
        return LogMessage.encode(self.link, setting[0], frames)

    def first_invalid(
        self, message: Message, raw: Mapping[str, int | bytes]
    ) -> int | None:
        """Return the index of the first field with an invalid value, or None."""
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

    def _take(self, now: int, message: bytes, bus: str) -> TelecommandOutcome:
        telecommand = self.facts.telecommands.get(message[0])
        if telecommand is None or telecommand.name in self.unsupported:
            return self._refusal(
                "unknown_id", acknowledge=telecommand is None or telecommand.acknowledge
            )
        data, form = message[1:], self.facts.checksum
        # The checksum is optional unless `telecommand_always` has the bus: the length
        # shows whether it is there.
        if form and bus in form.telecommand_buses:
            if len(data) == telecommand.length + form.bytes:
                data = data[: telecommand.length]
                if message != i2c_write(self.link, message[0], data, crc=True):
                    return self._refusal("checksum")
            elif bus in form.telecommand_always and len(data) == telecommand.length:
                return self._refusal("checksum")
        if len(data) != telecommand.length:
            return self._refusal("length")
        raw = codec.decode(self.icd.node(telecommand.node), telecommand, data)
        if (index := self.first_invalid(telecommand, raw)) is not None:
            return self._refusal("value", index)
        if telecommand.kind == CONFIGURATION:
            self.values.put(telecommand, data)
        try:
            self.counterpart.telecommand(now, telecommand, data)
        except Refused as refused:
            return self._refusal("value", self._index(telecommand, refused.place))
        if telecommand.name == self._log_role().get("message"):
            self._plan_log(now)
        reset = telecommand if telecommand.expects_reset else None
        is_acknowledged = telecommand.acknowledge and not reset
        return TelecommandOutcome(
            self.success, acknowledge=is_acknowledged, reset=reset
        )

    def _index(self, message: Message, place: NumberPlace | None) -> int:
        """Return the index of the field at a place; 0 without one."""
        places = number_places(self.icd, message)
        return places.index(place) if place in places else 0

    def _unsupported(self) -> set[str]:
        """Return the telecommands of procedures that only other nodes have."""
        every = self.icd.protocol_of(self.node).get("procedures", {})
        return _sent(every) - _sent(self.icd.procedures_of(self.node))

    def _refusal(
        self, reason: str, parameter: int = 0, acknowledge: bool = True
    ) -> TelecommandOutcome:
        return TelecommandOutcome(
            self.facts.reasons.get(reason, 1), parameter, acknowledge
        )

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

    def _statistics(self, message: Message) -> Raw:
        """Return the counters in a message; a flag is 1 after any event."""
        report = self.facts.statistics
        if report is None or report.message.name != message.name:
            return {}
        bits = {
            field.name: field.bits for field in self.icd.longest_frame(report.message)
        }
        result: Raw = {}
        for role, name in report.fields.items():
            count = self.counts.get(role, 0)
            is_flag = bits[name] == 1
            result[name] = int(count > 0) if is_flag else count % (1 << bits[name])
        return result

    def _log_role(self) -> dict[str, Any]:
        role: dict[str, Any] = (
            self.icd.protocol_of(self.node)
            .get("unsolicited_log", {})
            .get("configured_by", {})
        )
        return role

    def _log_setting(self) -> tuple[bytes, int] | None:
        """Return mask and period in milliseconds, or None."""
        role = self._log_role()
        message = self.values.messages.get(role.get("message", ""))
        if message is None or not self.facts.log_message:
            return None
        raw, fields = self.values.raw(message), role["fields"]
        return (
            bytes(raw[fields["mask"]]),
            int(raw[fields["period"]]) * role["period_unit_ms"],
        )

    def _plan_log(self, now: int) -> None:
        setting = self._log_setting()
        self.log_at = now + setting[1] if setting and setting[1] else None


def _sent(procedures: Mapping[str, dict[str, Any]]) -> set[str]:
    """Return the telecommands of procedures of an ICD."""
    names: set[str] = set()
    for section in procedures.values():
        steps = nested_steps(section["steps"])
        names.update(step["send"] for step in steps if "send" in step)
    return names
