"""Control of the simulated device: values, faults, logs and restarts.

They are given by options, by a script, or while it runs.
"""

from __future__ import annotations

import dataclasses
import math
import shlex
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import yaml

from icdgen import codec
from icdgen.errors import UserError, unreadable
from icdgen.icd.frames import FrameField
from icdgen.icd.layout import LayoutNode
from icdgen.icd.model import Icd, Message, Node
from icdgen.sim import faults
from icdgen.sim.device_line import DeviceLine
from icdgen.sim.values import raw_of
from icdgen.values.encode import texts_of_elements
from icdgen.values.entry import parse_value
from icdgen.values.errors import BadValue, NotFound
from icdgen.values.find import find_array, find_field, find_message, items_by_name

Wave = Mapping[str, Any]  # keys of a script
WAVES = ("sine", "ramp", "steps", "noise")
HELP = "a script is a list of steps such as `- {at: 2.5, set: {Message: {field: value}}}`; see docs/guides/simulator.md"


@dataclasses.dataclass
class ScriptStep:
    """A step of a script, ``at`` milliseconds after the start."""

    at: int
    set: dict[str, dict[str, object]] = dataclasses.field(default_factory=dict)
    faults: list[faults.InjectedFault] | None = None
    log: bool = False
    restart: bool = False


class Control:
    """Execute the steps of a script, and commands of the user, on a line."""

    def __init__(
        self, icd: Icd, node: Node, line: DeviceLine, steps: list[ScriptStep]
    ) -> None:
        self.icd, self.node, self.line = icd, node, line
        self.steps = sorted(steps, key=lambda step: step.at)
        self.moving: list[tuple[Message, FrameField, Wave]] = []

    @property
    def deadline(self) -> int | None:
        """Time of the next step, or None.

        Waves do not count: requests update their values.
        """
        return self.steps[0].at if self.steps else None

    def tick(self, now: int) -> None:
        """Execute all steps that are due, and update the values of waves."""
        while self.steps and now >= self.steps[0].at:
            self.do(now, self.steps.pop(0))
        values = self.line.computer.program.values
        random = self.line.faults.random.random
        for message, field, wave in self.moving:
            if message.name in values.frames:
                raw = raw_of(field, value_of_wave(wave, now / 1000, random))
                values.update(message, {field.name: raw})

    def do(self, now: int, step: ScriptStep) -> None:
        """Execute a step."""
        for name, fields in step.set.items():
            for key, value in fields.items():
                self.set(name, key, value)
        if step.faults is not None:
            self.line.faults.faults = step.faults
        if step.log:
            self.line.log(now)
        if step.restart:
            self.line.computer.restart(now)

    def set(self, name: str, key: str, value: object) -> None:
        """Set a field of a frame now and at each start.

        Raise `icdgen.errors.UserError`.
        """
        for message, field, element_value in fields_of(
            self.icd, self.node, name, key, value
        ):
            self._set(message, field, element_value)

    def _set(self, message: Message, field: FrameField, value: object) -> None:
        self.moving = [
            m
            for m in self.moving
            if (m[0].name, m[1].name) != (message.name, field.name)
        ]
        if isinstance(value, Mapping):
            self.moving.append((message, field, value))
            return
        raw = {field.name: raw_value_of(message, field, value)}
        values = self.line.computer.program.values
        if message.name in values.frames:
            try:
                raw = values.update(message, raw)
            except codec.CodecError as error:
                raise BadValue(f"{message.name}: {error}") from None
        self.line.computer.settings.values.setdefault(message.name, {}).update(raw)

    def assign(self, name: str, text: str) -> None:
        """Set a field from a text ``FIELD=VALUE``. Raise `icdgen.errors.UserError`."""
        key, equals, value = text.partition("=")
        if not equals:
            help = "for instance --set 'Message' speed=100 mode=Run"
            raise BadValue(f"`{text}` is not of the form field=value", help)
        self.set(name, key, value)

    def execute(self, now: int, text: str) -> str:
        """Execute a command line and return its response.

        Raise `icdgen.errors.UserError`.
        """
        try:
            words = shlex.split(text)
        except ValueError as error:
            raise UserError(f"`{text}`: {error}", "close the quotes") from None
        if not words:
            return ""
        command, arguments = words[0], words[1:]
        if command == "set" and len(arguments) >= 2:
            for argument in arguments[1:]:
                self.assign(arguments[0], argument)
        elif command == "fault":
            self.line.faults.faults = [
                self.line.fault(argument) for argument in arguments
            ]
        elif command == "log" and not arguments:
            self.line.log(now)
        elif command == "restart" and not arguments:
            self.line.computer.restart(now)
        else:
            help = (
                "set MESSAGE FIELD=VALUE ..., fault KIND=SHARE[:DETAIL][@WHAT] ..., "
                "log, restart"
            )
            raise UserError(f"`{text}` is no order", help)
        return "ok"


def fields_of(
    icd: Icd, node: Node, name: str, key: str, value: object
) -> list[tuple[Message, FrameField, object]]:
    """Return a field of a frame and its value, or all elements of an array with their
    values.

    The values of an array are a list, or its text. A variable-length array may have a
    shorter list; the result then begins with its counter. Raise
    `icdgen.errors.UserError`.
    """
    message = locate_message(icd, node, name)
    vocabulary = icd.node(message.node).vocabulary
    fields = icd.longest_frame(message)
    elements = find_array(fields, key, vocabulary)
    nodes = items_by_name(message.layout.sequence, key, vocabulary)
    node_of_array: LayoutNode | None = None
    if nodes:
        node_of_array = nodes[0]
    elif elements:
        node_of_array = elements[0].steps[-1].node
    part = next(
        (part for part in message.layout.counted_parts if part.node is node_of_array),
        None,
    )
    is_none = part is not None and str(value).strip() == "[]"
    if not elements and not is_none:
        return [(message, find_field(message, fields, key, vocabulary), value)]
    if isinstance(value, Mapping):
        return [(message, element, value) for element in elements]
    texts = (
        []
        if is_none
        else texts_of_elements(key, str(value), len(elements), part is not None)
    )
    result: list[tuple[Message, FrameField, object]] = [
        (message, element, text) for element, text in zip(elements, texts, strict=False)
    ]
    if part is None:
        return result
    counter = next(field for field in fields if field.name == part.counter)
    return [(message, counter, len(texts) - part.plus), *result]


def locate_message(icd: Icd, node: Node, name: str) -> Message:
    """Return the frame of the node, or of a program that it starts.

    Raise `icdgen.errors.UserError`.
    """
    errors = []
    for candidate in (node, *(n for n in icd.nodes if n is not node)):
        try:
            return find_message(icd, candidate.name, name, "telemetry")
        except NotFound as error:
            errors.append(error)
    # That of the simulated node: its help suggests the messages of that node.
    raise errors[0]


def raw_value_of(message: Message, field: FrameField, value: object) -> int | bytes:
    """Return the raw value of a user's value. Raise `icdgen.errors.UserError`."""
    if field.role in ("overlay", "derived"):
        raise UserError(
            f"{message.name}, {field.name}: an overlay field has no bits of its own",
            "set the fields that have them",
        )
    text = str(value)
    if isinstance(value, bool):
        text = text.lower()  # `True` and `False` are no values of an ICD
    raw = parse_value(field, text)
    if (
        isinstance(raw, int)
        and field.type != "float"
        and not field.raw_min <= raw <= field.raw_max
    ):
        raise UserError(
            f"{message.name}, {field.name}: {value} does not fit",
            f"{field.bits} bits hold the raw value",
        )
    return raw


def value_of_wave(wave: Wave, seconds: float, random: Callable[[], float]) -> float:
    """Return the physical value of a wave at a time."""
    low, high = float(wave.get("min", -1)), float(wave.get("max", 1))
    period = float(wave.get("period", 60))
    part = seconds / period % 1
    kind = wave.get("wave", "sine")
    if kind == "sine":
        return (low + high) / 2 + (high - low) / 2 * math.sin(2 * math.pi * part)
    if kind == "steps":
        return low if part < 0.5 else high
    if kind == "noise":
        return low + (high - low) * random()
    return low + (high - low) * part  # ramp


def read_script(path: Path, icd: Icd, node: Node, line: DeviceLine) -> list[ScriptStep]:
    """Return the steps of a script. Raise `icdgen.errors.UserError`."""
    try:
        data = yaml.safe_load(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise unreadable(path, error) from None
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        place = getattr(error, "problem_mark", None)
        where = f":{place.line + 1}:{place.column + 1}" if place else ""
        raise UserError(f"{path}{where}: this is no YAML", HELP) from None
    if not isinstance(data, list):
        raise UserError(f"{path}: this is no list", HELP)
    return [
        _step(path, number, row, icd, node, line) for number, row in enumerate(data, 1)
    ]


def _step(
    path: Path, number: int, row: object, icd: Icd, node: Node, line: DeviceLine
) -> ScriptStep:
    """Return a checked step of a script. Raise `icdgen.errors.UserError`."""
    where = f"{path}: step {number}"
    keys = {"at", "set", "faults", "log", "restart"}
    if not isinstance(row, dict) or set(row) - keys:
        raise UserError(f"{where}: there is no such step", HELP)
    seconds, values = row.get("at", 0), row.get("set", {})
    if type(seconds) not in (int, float) or not 0 <= seconds < 1e9:
        raise UserError(f"{where}: `at` is no time in seconds", HELP)
    if not isinstance(values, dict) or not all(
        isinstance(fields, dict) for fields in values.values()
    ):
        raise UserError(f"{where}: `set` is no mapping of messages to fields", HELP)
    for name, fields in values.items():
        for key, value in fields.items():
            for message, field, element_value in fields_of(
                icd, node, str(name), str(key), value
            ):
                if isinstance(element_value, Mapping):
                    _check_wave(f"{where}, {name}, {key}", field, element_value)
                else:
                    raw_value_of(message, field, element_value)
    fault_texts = row.get("faults")
    if fault_texts is not None and not (
        isinstance(fault_texts, list)
        and all(isinstance(field, str) for field in fault_texts)
    ):
        raise UserError(f"{where}: `faults` is no list of texts", HELP)
    step_faults = None
    if fault_texts is not None:
        step_faults = [line.fault(text) for text in fault_texts]
    return ScriptStep(
        at=round(seconds * 1000),
        set={
            str(name): {str(key): value for key, value in fields.items()}
            for name, fields in values.items()
        },
        faults=step_faults,
        log=bool(row.get("log", False)),
        restart=bool(row.get("restart", False)),
    )


def _check_wave(where: str, field: FrameField, wave: Wave) -> None:
    """Check the keys and numbers of a wave. Raise `icdgen.errors.UserError`."""
    if field.role in ("overlay", "derived"):
        raise UserError(
            f"{where}: an overlay field has no bits of its own",
            "let the fields move that have them",
        )
    numbers = [wave.get(key, 1) for key in ("min", "max", "period")]
    if (
        set(wave) - {"wave", "min", "max", "period"}
        or wave.get("wave", "sine") not in WAVES
        or field.is_bytes
    ):
        raise UserError(
            f"{where}: there is no such wave",
            f"{{wave: {'|'.join(WAVES)}, min: -1, max: 1, period: 60}}",
        )
    if (
        not all(type(n) in (int, float) and math.isfinite(n) for n in numbers)
        or numbers[2] <= 0
    ):
        raise UserError(
            f"{where}: `min`, `max` and `period` are numbers, the last above 0"
        )
