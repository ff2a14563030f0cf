"""What each output says of an ICD.

It has a feature if it works on the example and says something else when that is
changed.
"""

from __future__ import annotations

import io
import json
import tempfile
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import count, takewhile
from pathlib import Path
from typing import Any

import yaml

from icdgen import backends, codec
from icdgen.backends.html import guide
from icdgen.diff.compare import compare
from icdgen.errors import UserError
from icdgen.icd.fmt import format_text
from icdgen.icd.model import Icd, Message, Node
from icdgen.icd.variants import ids_of
from icdgen.loading import load
from icdgen.logfile import text
from icdgen.logfile.log import open_log
from icdgen.protocol import facts
from icdgen.recognize import recognize
from icdgen.show import machine, people
from icdgen.sim.control import fields_of, raw_value_of
from icdgen.sim.program import Program
from icdgen.sim.settings import SimulationSettings
from icdgen.sim.storage import DeviceStorage
from icdgen.values import text as values_text
from icdgen.values.encode import encode
from icdgen.values.frame import decoded_frame
from icdgen.vectors.make import make_vectors
from tests import links
from tests.conformance.build import renderer
from tests.features import framed
from tests.features.data import Feature
from tests.features.link import LINK, framed_link
from tests.python import packages
from tests.xtce import readback

FRAMES = 10  # of the vectors of each message
WORDS = 8  # of them
_names = (f"features_{number}" for number in count())


class Refused(ValueError):
    """`icdgen check` does not take the ICD; the text is the codes."""


@dataclass(frozen=True)
class Subject:
    """An ICD that is tried, frames of its messages, and what a user writes to get
    these; all of the example.
    """

    feature: Feature
    content: str
    folder: Path
    frames: dict[str, list[bytes]]
    words: dict[str, list[list[str]]]

    @cached_property
    def icd(self) -> Icd:
        return icd_of(self.content, self.folder)

    @property
    def node(self) -> Node:
        return self.icd.nodes[-1]

    def sharing(self, message: Message) -> list[Message]:
        """The messages that have an id of its, in its direction: itself alone, if it
        has its own.
        """
        found = ids_of(self.icd, self.node)
        known = (
            found.telecommand if message.telecommand_id is not None else found.telemetry
        )
        return [one.message for one in known[message.ids[0]]]

    def messages(self) -> Iterator[tuple[Message, bytes]]:
        """Each message and each of its frames."""
        for message in self.node.messages:
            for data in self.frames.get(message.name, ()):
                yield message, data

    @cached_property
    def linked(self) -> tuple[Icd, str]:
        """The ICD with a link on which it is spoken: its own; else a line and a log;
        else one with a framed link. Raises `Refused`.
        """
        tree = yaml.safe_load(self.content)
        if "protocol" in tree:
            return self.icd, tree["node"]["name"]
        with suppress(Refused):
            return self._with_log(tree)
        tree |= framed_link(tree["node"].get("id_bits", 8))
        return icd_of(json.dumps(tree), self.folder), tree["node"]["name"]

    @cached_property
    def has_framed_link(self) -> bool:
        """Whether that link has."""
        icd, name = self.linked
        return facts.of(icd, icd.node(name)).stream is not None

    @cached_property
    def recordings(self) -> tuple[object, object]:
        """What is made of a recording as CSV, and as Parquet."""
        return _recordings(self)

    def _with_log(self, tree: dict[str, Any]) -> tuple[Icd, str]:
        """With a line and a log; what does not fit these is not in the log.

        Raises `Refused`.
        """
        tree, link = dict(tree), yaml.safe_load(LINK)
        spoken = [one for one in tree["messages"] if one["kind"] != "telecommand"]
        size = next(
            (
                one["length"]
                for one in spoken
                if self.feature.places({"messages": [one]})
            ),
            None,
        )
        size = size or next((one["length"] for one in spoken), 1)
        logged = [one for one in spoken if one["length"] == size]
        link["protocol"]["log_mask"]["frame_bytes"] = size
        link["loggable"] = [
            {"bit": bit, "id": one.get("id", one.get("get_id")), "name": one["name"]}
            for bit, one in enumerate(logged)
        ]
        for key, value in link.items():
            tree[key] = (
                [*tree.get(key, ()), *value] if isinstance(value, list) else value
            )
        return icd_of(json.dumps(tree), self.folder), tree["node"]["name"]


def icd_of(content: str, folder: Path) -> Icd:
    """The checked ICD. Raises `Refused`."""
    file = Path(tempfile.mkdtemp(dir=folder)) / "example.yaml"
    file.write_text(content, encoding="utf-8")
    loaded = load([file])
    codes = sorted({one.code for one in loaded.findings if one.severity == "error"})
    if codes:
        raise Refused(", ".join(codes))
    return loaded.icd


def frames_of(icd: Icd) -> dict[str, list[bytes]]:
    """Some frames of each message, those of the golden vectors, spread over them."""
    found = {}
    for one in make_vectors(icd, icd.nodes[-1]).messages:
        frames = [row.frame for row in one.rows]
        found[one.message.name] = _some(frames, FRAMES)
    return found


def _some(frames: list[bytes], count: int) -> list[bytes]:
    return frames[:: max(1, len(frames) // count)]


def generated(name: str) -> Callable[[Subject], object]:
    """What a backend makes of the ICD; the site ends with what is the same on each."""

    def files(subject: Subject) -> object:
        made = backends.get(name).files(subject.icd, renderer(name))
        return list(
            takewhile(lambda file: not str(file[0]).startswith(guide.FOLDER), made)
        )

    return files


def _codec(subject: Subject) -> object:
    said = []
    for message, data in subject.messages():
        try:
            raw = codec.decode(subject.node, message, data)
            assert (
                codec.decode(
                    subject.node, message, codec.encode(subject.node, message, raw)
                )
                == raw
            )
            scaled = [
                field
                for field in message.fields
                if field.has_formula and field.name in raw
            ]
            physical = {
                field.name: codec.physical_double(field, raw[field.name])
                for field in scaled
            }
            known = subject.sharing(message)
            said.append(
                (
                    message.name,
                    message.ids,
                    raw,
                    physical,
                    len(known) > 1 and _which(subject, known, data),
                )
            )
        except codec.CodecError as error:
            said.append((message.name, str(error)))
    return said


def _which(subject: Subject, known: list[Message], data: bytes) -> str | None:
    found = codec.message_of_frame(subject.icd, known, data)
    return found.name if found else None


def _show(subject: Subject) -> object:
    pages = [
        people.to_text(subject.icd, (subject.node.name, message.name))
        for message in subject.node.messages
    ]
    return (
        pages,
        people.to_text(subject.icd, (subject.node.name,)),
        _without_source(machine.to_json(subject.icd)),
    )


def _without_source(tree: object) -> object:
    """What tells of files and places is no word of the ICD."""
    if isinstance(tree, dict):
        return {
            key: _without_source(value)
            for key, value in tree.items()
            if key not in ("file", "line", "column", "digest")
        }
    return [_without_source(one) for one in tree] if isinstance(tree, list) else tree


def _decode(subject: Subject) -> object:
    said: list[object] = []
    for message, data in subject.messages():
        with suppress(UserError):
            key = (
                message.name
                if len(subject.sharing(message)) == 1
                else str(message.ids[0])
            )
            found = recognize(subject.icd, data.hex(), subject.node.name, key)
            said += [
                (values_text.to_text(one.frame), one.frame.to_json()) for one in found
            ]
    return said


def words_of(icd: Icd, frames: dict[str, list[bytes]]) -> dict[str, list[list[str]]]:
    """For each frame of a message what a user would write to get it: physical values,
    names of members, texts.
    """
    node, found = icd.nodes[-1], {}
    for message in node.messages:
        rows = [
            decoded_frame(icd, node, message, data).rows
            for data in _some(frames[message.name], WORDS)
        ]
        found[message.name] = [
            [f"{row.field.name}={row.text}" for row in one if row.field.is_raw]
            for one in rows
        ]
        if any(row.field.special for row in rows[0]):
            found[message.name].append(
                [
                    f"{row.field.name}={row.field.special[0].meaning if row.field.special else row.text}"
                    for row in rows[0]
                ]
            )
    return found


def _encode(subject: Subject) -> object:
    said: list[object] = []
    for name, rows in subject.words.items():
        for words in rows:
            try:
                said.append(
                    values_text.to_text(
                        encode(subject.icd, subject.node.name, name, words)
                    )
                )
            except UserError as error:
                said.append(str(error))
    return said


def _simulator(subject: Subject) -> object:
    """What it answers after its values were set, and after it was sent what was made
    for the example.
    """
    icd, name = subject.linked
    node = icd.node(name)
    if subject.has_framed_link:
        return framed.simulator(icd, node, subject.frames, subject.words)
    program = Program(icd, node, DeviceStorage(), SimulationSettings(strict=True), 0)
    said: list[object] = []
    for message, data in subject.messages():
        if message.telecommand_id is not None:
            said.append(
                program.take(len(said), bytes([message.telecommand_id]) + data, "uart")
            )
            said.append(_answers(program, len(said)))
    for message in node.messages:
        for words in (
            subject.words.get(message.name, ())
            if message.telemetry_id is not None
            else ()
        ):
            try:
                for key, value in (word.split("=", 1) for word in words):
                    for own, one, given in fields_of(
                        icd, node, message.name, key, value
                    ):
                        program.values.update(
                            own, {one.name: raw_value_of(own, one, given)}
                        )
            except (UserError, codec.CodecError) as error:
                said.append(str(error))
            said.append(_answers(program, len(said)))
    return said


def _answers(program: Program, now: int) -> list[bytes | None]:
    return [program.frame(now, id) for id in program.facts.telemetry]


def _recordings(subject: Subject) -> tuple[object, object]:
    """As CSV and as Parquet; of framed links what is made of the bytes that the example
    sends.
    """
    icd, name = subject.linked
    if subject.has_framed_link:
        example = replace(subject, content=subject.feature.example)
        sent = framed.recorded(
            example.linked[0], example.linked[0].node(name), subject.frames
        )
        return framed.log(icd, icd.node(name), sent, subject.folder)
    link = links.link(icd, name)
    mask = bytes([(1 << len(link.mask.bits)) - 1, 0])
    slots = link.mask.selected(mask)
    names = {message.telemetry_id: message.name for message in subject.node.messages}
    entries = []
    for number in range(FRAMES):
        frames = [(subject.frames[names[slot.id]], slot.length) for slot in slots]
        cut = [
            rows[number % len(rows)][:length].ljust(length, b"\0")
            for rows, length in frames
        ]
        entries.append((1_600_000_000, number, cut))
    file = Path(tempfile.mkdtemp(dir=subject.folder)) / "log.bin"
    file.write_bytes(links.log_file(link, mask, entries))
    opened = open_log(icd, icd.node(name), file, "telemetry", [])
    written = io.StringIO()
    text.to_csv(opened.names, opened.rows(None, lambda _: None), written)
    opened.to_parquet(file.with_suffix(".parquet"), None, lambda _: None)
    import pyarrow.parquet

    table = pyarrow.parquet.read_table(file.with_suffix(".parquet"))
    return written.getvalue(), (
        table.schema.remove_metadata().to_string(),
        table.to_pylist(),
    )


def _columns(subject: Subject) -> object:
    """Tables of numpy and Arrow from the generated Python, which agree with single
    frames.
    """
    package = packages.write(
        subject.icd, Path(tempfile.mkdtemp(dir=subject.folder)), next(_names)
    )
    module, said = package.module(subject.node.name), []
    errors = package.module("_errors")
    for message in subject.node.messages:
        known, id = (
            (module.TELEMETRY, message.telemetry_id)
            if message.telemetry_id is not None
            else (module.TELECOMMANDS, message.telecommand_id)
        )
        cls = next(one for one in known.of(id) if message.name == one.NAME)
        frames = [
            frame
            for frame in subject.frames.get(message.name, ())
            if frame and _taken(cls, frame, errors.LengthError)
        ]
        if not frames:
            continue
        given = frames if len(message.layout.lengths) > 1 else b"".join(frames)
        columns, table = cls.decode_many(given), cls.decode_table(given)
        assert len(table) == len(frames)
        said.append(
            (
                message.name,
                {key: _plain(column) for key, column in columns.items()},
                str(table.schema),
                str(table.to_pylist()),
            )
        )
    return said


def _taken(cls: type, frame: bytes, refusal: type[Exception]) -> bool:
    try:
        cls.from_bytes(frame)  # type: ignore[attr-defined]
    except refusal:
        return False
    return True


def _plain(column: object) -> str:
    return f"{getattr(column, 'dtype', '')} {column.tolist() if hasattr(column, 'tolist') else column!r}"


def _xtce(subject: Subject) -> object:
    """What other programs may read of the file: what comes back of it."""
    folder = Path(tempfile.mkdtemp(dir=subject.folder))
    return {
        name: readback.read_back(file, folder)
        for name, file in readback.write(subject.icd, folder).items()
    }


def differs(old: Subject, new: Subject) -> bool:
    """Whether the diff tells of the change."""
    return bool(compare(old.icd, new.icd).changes)


def laid_out(subject: Subject) -> bool:
    """Whether the layout command makes the example, but for its comments, of the same
    values in another layout.
    """
    tree = yaml.safe_load(subject.content)
    made = format_text(json.dumps(tree), "example.yaml")
    return (
        yaml.safe_load(made) == tree
        and format_text(made, "example.yaml") == made
        and "{at: " in made
    )


SAYS: dict[str, Callable[[Subject], object]] = {
    "codec": _codec,
    "c": generated("c"),
    "python": generated("python"),
    "rust": generated("rust"),
    "vectors": generated("vectors"),
    "show": _show,
    "decode": _decode,
    "encode": _encode,
    "site": generated("html"),
    "simulator": _simulator,
    "log": lambda subject: subject.recordings[0],
    "numpy": _columns,
    "arrow": lambda subject: subject.recordings[1],
    "xtce": _xtce,
}
LINKED = ("simulator", "log", "arrow")  # of the ICD with a line and a log
