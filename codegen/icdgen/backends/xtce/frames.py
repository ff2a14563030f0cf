"""Messages as containers and commands of XTCE, with their entries and positions.

`ContainerBuilder.frame` turns a message of one direction into a `MessageContainer`.
What XTCE cannot represent is left out and noted in ``lacks``, which the file lists in a
comment.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import Any

from icdgen import naming
from icdgen.backends.xtce.places import BitRun, gaps, run_of, run_of_all
from icdgen.backends.xtce.types import (
    GeneratedType,
    TypeBuilder,
    is_complete,
    most_first,
    type_of,
    unique,
)
from icdgen.describe import FieldDescription, MessageDescription
from icdgen.describe.description import Into, VariablePartDescription
from icdgen.frozen import NamedTuple
from icdgen.icd.layout import is_variable
from icdgen.icd.model import TELECOMMAND, Special


class XtceParameter(NamedTuple):
    """Parameter or argument of XTCE."""

    name: str
    type: str
    alias: str = ""  # name in the ICD
    summary: str = ""
    special: tuple[Special, ...] = ()
    constant: int | None = None
    is_reserved: bool = False
    is_view: bool = False
    most: int = 0  # of a variable-length field: maximum number of elements or bytes


class ContainerEntry(NamedTuple):
    """Entry of a container: a parameter, an argument, or a fixed value."""

    name: str
    run: BitRun
    is_array: bool = False
    # Condition of presence: raw values of other fields
    needs: tuple[tuple[str, tuple[int, ...]], ...] = ()
    value: str | None = None  # of a fixed value: hexadecimal
    # Bits from the start of the container; None: after the previous entry
    at: int | None = None


@dataclass
class BaseContainer:
    """Base container of telemetry messages that share an id: the constants that
    distinguish them.
    """

    name: str
    id: int
    entries: dict[str, ContainerEntry] = field(default_factory=dict)


@dataclass
class MessageContainer:
    """Message in one direction."""

    name: str
    message: MessageDescription
    id: int
    rows: list[XtceParameter] = field(default_factory=list)
    entries: list[ContainerEntry] = field(default_factory=list)
    size: int = 0  # bits of each frame, if optional entries leave it undefined
    base: BaseContainer | None = None  # of a message that shares its id
    # Constants of the base and their values
    discriminators: list[tuple[str, int]] = field(default_factory=list)
    # omitted content that XTCE cannot represent; a command with omissions is not
    # exported
    lacks: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)  # other limitations
    # Field -> parameter or argument
    names: dict[str, str] = field(default_factory=dict)


_PLAIN: dict[str, Any] = {
    "terms": (),
    "points": (),
    "extrapolates": False,
    "limits": (),
    "labels": (),
}


def _encoding_name(of: GeneratedType) -> str:
    """Return the name of a type that has only an encoding."""
    if of.kind == "Binary":
        return f"bytes{of.bits // 8}"
    return f"{'' if of.is_signed else 'u'}int{of.bits}{'_le' if of.byte_order.startswith('least') else ''}"


def _camel(name: str) -> str:
    """Return a name in camel case: ``EstimatedRollAngle``, ``InView1Azimuth``."""
    return naming.camel(filter(None, name.split("_")))


@dataclass
class ContainerBuilder:
    """Builder of the frames of a direction.

    Each begins with ``head`` bits before the data.
    """

    direction: str
    types: TypeBuilder
    head: int
    shared: dict[int, int]  # shared id -> number of bytes that all its frames have
    taken: set[str]  # names of containers or commands, and of parameters
    # Base containers of shared ids
    bases: dict[int, BaseContainer] = field(default_factory=dict)
    reserved: dict[str, XtceParameter] = field(default_factory=dict)

    def frame(self, message: MessageDescription) -> MessageContainer:
        """Return a message as a frame of the direction."""
        is_sent = self.direction == TELECOMMAND
        id = message.model.telecommand_id if is_sent else message.model.telemetry_id
        assert id is not None
        frame = MessageContainer(
            unique(_camel(message.name) or "Message", self.taken), message, id
        )
        if id in self.shared and not is_sent:
            frame.base = self.bases.setdefault(
                id, BaseContainer(unique(f"Id{id}", self.taken), id)
            )
        parts = tuple(_placed_parts(message))
        for part in parts:
            self._give_name(frame, part)
        needed = {need.field.name for part in parts for need in part.needs}
        entries: list[ContainerEntry] = []
        for part in parts:
            run = (
                run_of_all(part.model.elements(), message.node)
                if part.count
                else run_of(part.model, message.node)
            )
            # Overlays of existing bits: a command sets only the fields themselves.
            if part.model.is_read_only and (is_sent or frame.lacks):
                continue
            if run is None:
                frame.lacks.append(
                    f"`{part.model.name}` is left out: XTCE has no word for the order of its bits"
                )
            elif is_sent and part.model.const is not None and part.name not in needed:
                entries += self._constant(frame, part)
            else:
                entries.append(self._entry(frame, part, run))
        last = message.last_part
        can_stand = not message.has_inner_gaps and not any(
            entry.needs for entry in entries
        )
        behind = (
            self._variable_entry(frame, last)
            if last is not None and can_stand
            else None
        )
        if behind is None:
            frame.lacks += (
                f"`{node.name}`, which has no fixed {'size' if is_variable(node) else 'place'}, is left out"
                for node in message.model.layout.sequence
            )
        if message.model.may_end_early:
            frame.notes.append("it is sent with the zeros that it may be sent without")
        for value in message.derived:
            frame.notes.append(
                f"`{value.model.name}` is left out: it is derived by `{value.model.formula}`"
            )
        self._lay_out(frame, entries, self.head + message.model.layout.length * 8)
        if behind is not None:
            is_placed = any(entry.at is not None for entry in frame.entries)
            frame.entries.append(
                behind._replace(at=behind.run.at if is_placed else None)
            )
        return frame

    def _variable_entry(
        self, frame: MessageContainer, last: VariablePartDescription
    ) -> ContainerEntry | None:
        """Return the entry of a variable-length field with a counter.

        None if XTCE cannot represent it: structs, or no counting field.
        """
        part, node = last.field, frame.message.node
        is_unsupported = (
            last.counter.model.is_count
            or part.struct is not None
            or part.model.const is not None
        )
        if is_unsupported or last.counter.name not in frame.names:
            return None
        run = (
            run_of(part.model, node)
            if part.model.is_bytes
            else run_of_all(part.model.elements(), node)
        )
        if run is None:
            return None
        name = self._give_name(frame, part)
        type_ = self.types.type_of_variable_part(
            last, frame.names[last.counter.name], _type_name(frame, name), run.is_little
        )
        _add_parameter(frame, part, type_, last.model.most)
        return ContainerEntry(
            name,
            run._replace(at=self.head + run.at),
            is_array=not part.model.is_bytes or bool(part.count),
        )

    def _give_name(self, frame: MessageContainer, part: FieldDescription) -> str:
        """Assign a name to a parameter or argument.

        Parameter names are global; argument names belong to their command.
        """
        is_sent = self.direction == TELECOMMAND
        before, taken = (
            ("", set(frame.names.values()))
            if is_sent
            else (f"{frame.name}_", self.taken)
        )
        name = frame.names[part.name] = unique(
            before + (_camel(part.name) or "Field"), taken
        )
        return name

    def _entry(
        self, frame: MessageContainer, part: FieldDescription, run: BitRun
    ) -> ContainerEntry:
        name = frame.names[part.name]
        _add_parameter(
            frame,
            part,
            self.types.type_of_field(part, _type_name(frame, name), run.is_little),
        )
        if (
            part.model.const is not None
            and frame.base is not None
            and run.at + run.bits <= 8 * self.shared[frame.id]
        ):
            self._add_discriminator(frame, frame.base, part.model.const, part, run)
        return ContainerEntry(
            name,
            run._replace(at=self.head + run.at),
            bool(part.count),
            self._needs(frame, part),
        )

    def _add_discriminator(
        self,
        frame: MessageContainer,
        base: BaseContainer,
        value: int,
        part: FieldDescription,
        run: BitRun,
    ) -> None:
        """Add a constant to the base container, where consumers read it before they
        select the message.
        """
        name = f"{base.name}_{run.at}_{run.bits}{'_le' if run.is_little else ''}{'_signed' if part.model.is_signed else ''}"
        type_ = replace(
            type_of(part.model, run.is_little),
            kind="Integer",
            unit="",
            enum="",
            **_PLAIN,
        )
        self.reserved.setdefault(
            name,
            XtceParameter(
                name,
                self.types.name_of_type(type_, _encoding_name(type_)),
                is_reserved=True,
            ),
        )
        base.entries[name] = ContainerEntry(name, run, at=self.head + run.at)
        frame.discriminators.append((name, value))

    def _needs(
        self, frame: MessageContainer, part: FieldDescription
    ) -> tuple[tuple[str, tuple[int, ...]], ...]:
        return tuple((frame.names[need.field.name], need.values) for need in part.needs)

    def _constant(
        self, frame: MessageContainer, part: FieldDescription
    ) -> Iterator[ContainerEntry]:
        """Yield fixed values for the bits of a constant of a command, adjacent bits
        joined.
        """
        value = part.model.const or 0
        runs: list[tuple[BitRun, int]] = []
        for piece in part.pieces:
            run = BitRun(
                self.head + 8 * piece.byte + 8 - piece.shift - piece.bits, piece.bits
            )
            here = value >> piece.at & piece.low_mask
            if runs and runs[-1][0].at + runs[-1][0].bits == run.at:
                before, above = runs.pop()
                run, here = (
                    BitRun(before.at, before.bits + run.bits),
                    above << run.bits | here,
                )
            runs.append((run, here))
        needs = self._needs(frame, part)
        return (
            ContainerEntry(
                part.model.name, run, needs=needs, value=_hex_text(here, run.bits)
            )
            for run, here in runs
        )

    def _lay_out(
        self, frame: MessageContainer, entries: list[ContainerEntry], end: int
    ) -> None:
        """Assign positions to entries, and add entries for reserved bits.

        If possible, each entry follows the previous one.
        """
        is_plain = (
            all(entry.run.is_usual and not entry.needs for entry in entries)
            and not frame.message.overlays
        )
        if (
            is_plain
            and frame.base is None
            and not any("order of its bits" in text for text in frame.lacks)
        ):
            entries += map(
                self._reserved, gaps((entry.run for entry in entries), self.head, end)
            )
            frame.entries = sorted(entries, key=lambda entry: entry.run.at)
            return
        covered = max(
            (entry.run.at + entry.run.bits for entry in entries), default=self.head
        )
        entries += map(self._reserved, gaps((), -(-covered // 8) * 8, end))
        # Unconditional entries first: conditions refer to them
        entries.sort(key=lambda entry: bool(entry.needs))
        frame.entries = [entry._replace(at=entry.run.at) for entry in entries]
        frame.size = end if any(entry.needs for entry in entries) else 0

    def _reserved(self, run: BitRun) -> ContainerEntry:
        if self.direction == TELECOMMAND:
            return ContainerEntry("", run, value=_hex_text(0, run.bits))
        name = f"Reserved{run.bits}"
        is_wide = run.bits > 64
        type_ = (
            GeneratedType("Binary", run.bits)
            if is_wide
            else GeneratedType("Integer", run.bits, "unsigned", most_first(run.bits))
        )
        self.reserved.setdefault(
            name,
            XtceParameter(
                name,
                self.types.name_of_type(type_, _encoding_name(type_)),
                is_reserved=True,
            ),
        )
        return ContainerEntry(name, run)


def _type_name(frame: MessageContainer, name: str) -> str:
    """Return the name of a type that only one parameter or argument uses."""
    return name if name.startswith(frame.name) else f"{frame.name}_{name}"


def _add_parameter(
    frame: MessageContainer, part: FieldDescription, type_: str, most: int = 0
) -> None:
    """Declare the parameter or argument of a field, and note its omissions."""
    model = part.model
    name, special = frame.names[part.name], model.special
    frame.rows.append(
        XtceParameter(
            name,
            type_,
            model.name,
            model.summary,
            special,
            model.const,
            is_view=model.is_read_only,
            most=most,
        )
    )
    if not is_complete(model):
        frame.notes.append(
            f"`{model.name}`: beyond its table it has the value of the last point"
        )


def _placed_parts(message: MessageDescription) -> Iterator[FieldDescription]:
    """Yield the parts with a fixed position: fields of structs, arrays (as one part if
    XTCE permits it), and finally overlays.
    """
    for part in message.walk(Into.ARRAYS_OF_STRUCTS):
        if part.is_in_sequence or part.model.is_count:
            continue
        is_array = (
            part.model.const is None
            and part.count
            and run_of_all(part.model.elements(), message.node) is not None
        )
        yield from (part,) if is_array or not part.count else part.elements
    yield from message.overlays


def _hex_text(value: int, bits: int) -> str:
    return f"{value:0{-(-bits // 8) * 2}X}"
