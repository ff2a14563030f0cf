"""Messages as containers and commands of XTCE: what they are made of, and where it stands."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

from icdgen import naming
from icdgen.backends.xtce.places import Run, gaps, run_of, run_of_all
from icdgen.backends.xtce.types import Type, Types, is_said, most_first, type_of, unique
from icdgen.describe import FieldDescription, MessageDescription
from icdgen.describe.description import Into, VariablePartDescription
from icdgen.icd.model import TELECOMMAND, Special


class Row(NamedTuple):
    """A parameter or an argument."""

    name: str
    type: str
    alias: str = ""  # what the ICD calls it
    summary: str = ""
    special: tuple[Special, ...] = ()
    constant: int | None = None
    is_reserved: bool = False
    is_view: bool = False
    most: int = 0  # of an open end the elements, or bytes, that there are at most


class Entry(NamedTuple):
    """What stands in a container: a parameter, an argument, or bits that are always the same."""

    name: str
    run: Run
    is_array: bool = False
    needs: tuple[tuple[str, tuple[int, ...]], ...] = ()  # it is there if each of these has one of these raw values
    value: str | None = None  # of bits that are always the same: in hexadecimal
    at: int | None = None  # bits from the beginning of the container, where it does not follow the one before


@dataclass
class Base:
    """What messages of telemetry that share an id begin with: the numbers that tell them."""

    name: str
    id: int
    entries: dict[str, Entry] = field(default_factory=dict)


@dataclass
class Frame:
    """A message in one direction."""

    name: str
    message: MessageDescription
    id: int
    rows: list[Row] = field(default_factory=list)
    entries: list[Entry] = field(default_factory=list)
    size: int = 0  # bits of every frame, where entries that are not always there leave it open
    base: Base | None = None  # of one that shares its id
    told: list[tuple[str, int]] = field(default_factory=list)  # numbers of the base, with their values
    # what is left out, as XTCE has no word for it: such a command cannot be sent
    lacks: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)  # what else is not said
    names: dict[str, str] = field(default_factory=dict)  # of parameters or arguments, by those of fields


_PLAIN: dict[str, Any] = {"terms": (), "points": (), "extrapolates": False, "limits": (), "labels": ()}


def _named(of: Type) -> str:
    """What a type is called of which there is nothing to say but how many bits it has."""
    if of.kind == "Binary":
        return f"bytes{of.bits // 8}"
    return f"{'' if of.is_signed else 'u'}int{of.bits}{'_le' if of.byte_order.startswith('least') else ''}"


def _camel(name: str) -> str:
    """``EstimatedRollAngle``, ``InView1Azimuth``"""
    return naming.camel(filter(None, name.split("_")))


@dataclass
class Frames:
    """Makes the frames of a direction, which begin with ``head`` bits before the data."""

    direction: str
    types: Types
    head: int
    shared: dict[int, int]  # ids of several messages, with bytes that all their frames have
    taken: set[str]  # names of containers or commands, and of parameters
    bases: dict[int, Base] = field(default_factory=dict)  # of those that share an id
    reserved: dict[str, Row] = field(default_factory=dict)

    def frame(self, message: MessageDescription) -> Frame:
        """A message as it is sent in the direction."""
        is_sent = self.direction == TELECOMMAND
        id = message.model.telecommand_id if is_sent else message.model.telemetry_id
        assert id is not None
        made = Frame(unique(_camel(message.name) or "Message", self.taken), message, id)
        if id in self.shared and not is_sent:
            made.base = self.bases.setdefault(id, Base(unique(f"Id{id}", self.taken), id))
        parts = tuple(_parts(message))
        for one in parts:
            self._give_name(made, one)
        needed = {need.field.name for one in parts for need in one.needs}
        found: list[Entry] = []
        for one in parts:
            run = run_of_all(one.model.elements(), message.node) if one.count else run_of(one.model, message.node)
            if one.model.view and (is_sent or made.lacks):  # of bits that are there
                continue
            if run is None:
                made.lacks.append(f"`{one.model.name}` is left out: XTCE has no word for the order of its bits")
            elif is_sent and one.model.const is not None and one.name not in needed:
                found += self._constant(made, one)
            else:
                found.append(self._entry(made, one, run))
        last = message.last_part
        can_stand = not message.earlier_parts and not any(one.needs for one in found)
        behind = self._open(made, last) if last is not None and can_stand else None
        if behind is None:
            made.lacks += (
                f"`{part.name}`, which has no fixed size, is left out" for part in message.model.layout.sequence
            )
        if message.model.may_end_early:
            made.notes.append("it is sent with the zeros that it may be sent without")
        for one in message.derived:
            made.notes.append(f"`{one.model.name}` is left out: it is derived by `{one.model.formula}`")
        self._lay_out(made, found, self.head + message.model.layout.length * 8)
        if behind is not None:
            is_placed = any(one.at is not None for one in made.entries)
            made.entries.append(behind._replace(at=behind.run.at if is_placed else None))
        return made

    def _open(self, made: Frame, last: VariablePartDescription) -> Entry | None:
        """An open end that a field counts; None where XTCE has no word for it, as of structs and of what nothing counts."""
        part, node = last.field, made.message.node
        is_odd = last.counter.model.is_count or part.struct is not None or part.model.const is not None
        if is_odd or last.counter.name not in made.names:
            return None
        run = run_of(part.model, node) if part.model.is_bytes else run_of_all(part.model.elements(), node)
        if run is None:
            return None
        name = self._give_name(made, part)
        type_ = self.types.of_open(last, made.names[last.counter.name], _type_name(made, name), run.is_little)
        _add_row(made, part, type_, last.model.most)
        return Entry(name, run._replace(at=self.head + run.at), is_array=not part.model.is_bytes or bool(part.count))

    def _give_name(self, made: Frame, one: FieldDescription) -> str:
        """Parameters are known to all containers, arguments to their command alone."""
        is_sent = self.direction == TELECOMMAND
        before, taken = ("", set(made.names.values())) if is_sent else (f"{made.name}_", self.taken)
        name = made.names[one.name] = unique(before + (_camel(one.name) or "Field"), taken)
        return name

    def _entry(self, made: Frame, one: FieldDescription, run: Run) -> Entry:
        name = made.names[one.name]
        _add_row(made, one, self.types.of(one, _type_name(made, name), run.is_little))
        if one.model.const is not None and made.base is not None and run.at + run.bits <= 8 * self.shared[made.id]:
            self._tell(made, made.base, one.model.const, one, run)
        return Entry(name, run._replace(at=self.head + run.at), bool(one.count), self._needs(made, one))

    def _tell(self, made: Frame, base: Base, value: int, one: FieldDescription, run: Run) -> None:
        """The container below reads a constant, too: it must be known before a program looks for the message."""
        name = (
            f"{base.name}_{run.at}_{run.bits}{'_le' if run.is_little else ''}{'_signed' if one.model.is_signed else ''}"
        )
        type_ = replace(type_of(one.model, run.is_little), kind="Integer", unit="", enum="", **_PLAIN)
        self.reserved.setdefault(name, Row(name, self.types.name(type_, _named(type_)), is_reserved=True))
        base.entries[name] = Entry(name, run, at=self.head + run.at)
        made.told.append((name, value))

    def _needs(self, made: Frame, one: FieldDescription) -> tuple[tuple[str, tuple[int, ...]], ...]:
        return tuple((made.names[need.field.name], need.values) for need in one.needs)

    def _constant(self, made: Frame, one: FieldDescription) -> Iterator[Entry]:
        """Bits of a command that are always the same, one after the other as far as they are."""
        value = one.model.const or 0
        runs: list[tuple[Run, int]] = []
        for piece in one.pieces:
            run = Run(self.head + 8 * piece.byte + 8 - piece.shift - piece.bits, piece.bits)
            here = value >> piece.at & piece.low_mask
            if runs and runs[-1][0].at + runs[-1][0].bits == run.at:
                before, above = runs.pop()
                run, here = Run(before.at, before.bits + run.bits), above << run.bits | here
            runs.append((run, here))
        needs = self._needs(made, one)
        return (Entry(one.model.name, run, needs=needs, value=_hex(here, run.bits)) for run, here in runs)

    def _lay_out(self, made: Frame, found: list[Entry], end: int) -> None:
        """Gives entries their places, and reserved bits entries: each then follows the one before it, if that can be."""
        is_plain = all(one.run.is_usual and not one.needs for one in found) and not made.message.overlays
        if is_plain and made.base is None and not any("order of its bits" in text for text in made.lacks):
            found += map(self._reserved, gaps((one.run for one in found), self.head, end))
            made.entries = sorted(found, key=lambda one: one.run.at)
            return
        covered = max((one.run.at + one.run.bits for one in found), default=self.head)
        found += map(self._reserved, gaps((), -(-covered // 8) * 8, end))
        found.sort(key=lambda one: bool(one.needs))  # what others depend on is read before them
        made.entries = [one._replace(at=one.run.at) for one in found]
        made.size = end if any(one.needs for one in found) else 0

    def _reserved(self, run: Run) -> Entry:
        if self.direction == TELECOMMAND:
            return Entry("", run, value=_hex(0, run.bits))
        name = f"Reserved{run.bits}"
        is_wide = run.bits > 64
        type_ = Type("Binary", run.bits) if is_wide else Type("Integer", run.bits, "unsigned", most_first(run.bits))
        self.reserved.setdefault(name, Row(name, self.types.name(type_, _named(type_)), is_reserved=True))
        return Entry(name, run)


def _type_name(made: Frame, name: str) -> str:
    """What the type of a parameter or argument is called, if it is its own."""
    return name if name.startswith(made.name) else f"{made.name}_{name}"


def _add_row(made: Frame, one: FieldDescription, type_: str, most: int = 0) -> None:
    """Declares the parameter or argument of a field, and notes what is not said of it."""
    model = one.model
    name, special = made.names[one.name], model.special
    made.rows.append(Row(name, type_, model.name, model.summary, special, model.const, is_view=model.view, most=most))
    if not is_said(model):
        made.notes.append(f"`{model.name}`: beyond its table it has the value of the last point")


def _parts(message: MessageDescription) -> Iterator[FieldDescription]:
    """What has a fixed place: fields of structs, arrays as one where XTCE can have them so, at last views."""
    for one in message.walk(Into.ARRAYS_OF_STRUCTS):
        if one.is_in_last_part or one.is_in_earlier_part or one.model.is_count:
            continue
        is_array = one.model.const is None and one.count and run_of_all(one.model.elements(), message.node) is not None
        yield from (one,) if is_array or not one.count else one.elements
    yield from message.overlays


def _hex(value: int, bits: int) -> str:
    return f"{value:0{-(-bits // 8) * 2}X}"
