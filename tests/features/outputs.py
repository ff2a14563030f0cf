"""The result of each output for an ICD.

An output supports a feature if it accepts the example and its result differs when the
example uses the feature differently.
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
WORDS = 8  # of these frames, as words on the command line
_names = (f"features_{number}" for number in count())


class Rejected(ValueError):
    """`icdgen check` rejects the ICD; the text is the codes of the rules."""


@dataclass(frozen=True)
class Subject:
    """An ICD that is tried, with frames of its messages and the words that encode them.

    Frames and words are derived from the unchanged example.
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
        """Return the messages with the id and direction of ``message``, itself
        included.
        """
        ids = ids_of(self.icd, self.node)
        variants = (
            ids.telecommand if message.telecommand_id is not None else ids.telemetry
        )
        return [variant.message for variant in variants[message.ids[0]]]

    def messages(self) -> Iterator[tuple[Message, bytes]]:
        """Yield each message with each of its frames."""
        for message in self.node.messages:
            for data in self.frames.get(message.name, ()):
                yield message, data

    @cached_property
    def linked(self) -> tuple[Icd, str]:
        """The ICD with a link, and the name of the node.

        The link is its own, else a line and a log, else a framed link. Raises
        `Rejected`.
        """
        tree = yaml.safe_load(self.content)
        if "protocol" in tree:
            return self.icd, tree["node"]["name"]
        with suppress(Rejected):
            return self._with_log(tree)
        tree |= framed_link(tree["node"].get("id_bits", 8))
        return icd_of(json.dumps(tree), self.folder), tree["node"]["name"]

    @cached_property
    def has_framed_link(self) -> bool:
        """Whether the link of `linked` is framed."""
        icd, name = self.linked
        return facts.of(icd, icd.node(name)).stream is not None

    @cached_property
    def recordings(self) -> tuple[object, object]:
        """A recording as CSV and as Parquet."""
        return _recordings(self)

    def _with_log(self, tree: dict[str, Any]) -> tuple[Icd, str]:
        """Return the ICD with a line and a log of the messages that fit into them.

        Raises `Rejected`.
        """
        tree, link = dict(tree), yaml.safe_load(LINK)
        spoken = [
            message for message in tree["messages"] if message["kind"] != "telecommand"
        ]
        # The frame size of the log is the length of a message with the feature, if
        # there is one.
        size = next(
            (
                message["length"]
                for message in spoken
                if self.feature.places({"messages": [message]})
            ),
            None,
        )
        size = size or next((message["length"] for message in spoken), 1)
        logged = [message for message in spoken if message["length"] == size]
        link["protocol"]["log_mask"]["frame_bytes"] = size
        link["loggable"] = [
            {
                "bit": bit,
                "id": message.get("id", message.get("get_id")),
                "name": message["name"],
            }
            for bit, message in enumerate(logged)
        ]
        for key, value in link.items():
            tree[key] = (
                [*tree.get(key, ()), *value] if isinstance(value, list) else value
            )
        return icd_of(json.dumps(tree), self.folder), tree["node"]["name"]


def icd_of(content: str, folder: Path) -> Icd:
    """Return the checked ICD. Raises `Rejected`."""
    file = Path(tempfile.mkdtemp(dir=folder)) / "example.yaml"
    file.write_text(content, encoding="utf-8")
    loaded = load([file])
    codes = sorted(
        {finding.code for finding in loaded.findings if finding.severity == "error"}
    )
    if codes:
        raise Rejected(", ".join(codes))
    return loaded.icd


def frames_of(icd: Icd) -> dict[str, list[bytes]]:
    """Return frames of each message: some of its golden vectors, evenly selected."""
    frames_by_message = {}
    for vectors in make_vectors(icd, icd.nodes[-1]).messages:
        frames = [row.frame for row in vectors.rows]
        frames_by_message[vectors.message.name] = _some(frames, FRAMES)
    return frames_by_message


def _some(frames: list[bytes], count: int) -> list[bytes]:
    return frames[:: max(1, len(frames) // count)]


def generated(name: str) -> Callable[[Subject], object]:
    """Return a function that generates files with a backend.

    The pages of the site that are the same for each ICD are left out.
    """

    def files(subject: Subject) -> object:
        files_of_icd = backends.get(name).files(subject.icd, renderer(name))
        return list(
            takewhile(
                lambda file: not str(file[0]).startswith(guide.FOLDER), files_of_icd
            )
        )

    return files


def _codec(subject: Subject) -> object:
    results = []
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
            variants = subject.sharing(message)
            results.append(
                (
                    message.name,
                    message.ids,
                    raw,
                    physical,
                    len(variants) > 1 and _variant_of_frame(subject, variants, data),
                )
            )
        except codec.CodecError as error:
            results.append((message.name, str(error)))
    return results


def _variant_of_frame(
    subject: Subject, variants: list[Message], data: bytes
) -> str | None:
    message = codec.message_of_frame(subject.icd, variants, data)
    return message.name if message else None


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
    """Return a tree without files, positions and digests, which are no content of the
    ICD.
    """
    if isinstance(tree, dict):
        return {
            key: _without_source(value)
            for key, value in tree.items()
            if key not in ("file", "line", "column", "digest")
        }
    return (
        [_without_source(entry) for entry in tree] if isinstance(tree, list) else tree
    )


def _decode(subject: Subject) -> object:
    results: list[object] = []
    for message, data in subject.messages():
        with suppress(UserError):
            # A user can name a message, unless several messages share its id.
            key = (
                message.name
                if len(subject.sharing(message)) == 1
                else str(message.ids[0])
            )
            readings = recognize(subject.icd, data.hex(), subject.node.name, key)
            results += [
                (values_text.to_text(reading.frame), reading.frame.to_json())
                for reading in readings
            ]
    return results


def words_of(icd: Icd, frames: dict[str, list[bytes]]) -> dict[str, list[list[str]]]:
    """Return for each message the words by which a user would encode its frames.

    Words are physical values, names of members, and texts.
    """
    node, words_by_message = icd.nodes[-1], {}
    for message in node.messages:
        rows = [
            decoded_frame(icd, node, message, data).rows
            for data in _some(frames[message.name], WORDS)
        ]
        words_by_message[message.name] = [
            [f"{row.field.name}={row.text}" for row in values if row.field.is_raw]
            for values in rows
        ]
        if any(row.field.special for row in rows[0]):
            words_by_message[message.name].append(
                [
                    f"{row.field.name}={row.field.special[0].meaning if row.field.special else row.text}"
                    for row in rows[0]
                ]
            )
    return words_by_message


def _encode(subject: Subject) -> object:
    results: list[object] = []
    for name, rows in subject.words.items():
        for words in rows:
            try:
                results.append(
                    values_text.to_text(
                        encode(subject.icd, subject.node.name, name, words)
                    )
                )
            except UserError as error:
                results.append(str(error))
    return results


def _simulator(subject: Subject) -> object:
    """Return the responses of the simulator after the telecommands of the example, and
    after each change of its values.
    """
    icd, name = subject.linked
    node = icd.node(name)
    if subject.has_framed_link:
        return framed.simulator(icd, node, subject.frames, subject.words)
    program = Program(icd, node, DeviceStorage(), SimulationSettings(strict=True), 0)
    results: list[object] = []
    for message, data in subject.messages():
        if message.telecommand_id is not None:
            results.append(
                program.take(
                    len(results), bytes([message.telecommand_id]) + data, "uart"
                )
            )
            results.append(_answers(program, len(results)))
    for message in node.messages:
        for words in (
            subject.words.get(message.name, ())
            if message.telemetry_id is not None
            else ()
        ):
            try:
                for key, value in (word.split("=", 1) for word in words):
                    for own, field, given in fields_of(
                        icd, node, message.name, key, value
                    ):
                        program.values.update(
                            own, {field.name: raw_value_of(own, field, given)}
                        )
            except (UserError, codec.CodecError) as error:
                results.append(str(error))
            results.append(_answers(program, len(results)))
    return results


def _answers(program: Program, now: int) -> list[bytes | None]:
    return [program.requested_frame(now, id) for id in program.facts.telemetry]


def _recordings(subject: Subject) -> tuple[object, object]:
    """Return a log as CSV and as Parquet; of a framed link, a recording of the
    example's bytes.
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
    """Return numpy and Arrow tables from the generated Python.

    They have one row for each frame that the generated code accepts.
    """
    package = packages.write(
        subject.icd, Path(tempfile.mkdtemp(dir=subject.folder)), next(_names)
    )
    module, results = package.module(subject.node.name), []
    errors = package.module("_errors")
    for message in subject.node.messages:
        table_of_ids, id = (
            (module.TELEMETRY, message.telemetry_id)
            if message.telemetry_id is not None
            else (module.TELECOMMANDS, message.telecommand_id)
        )
        cls = next(
            candidate
            for candidate in table_of_ids.of(id)
            if message.name == candidate.NAME
        )
        frames = [
            frame
            for frame in subject.frames.get(message.name, ())
            if frame and _is_accepted(cls, frame, errors.LengthError)
        ]
        if not frames:
            continue
        given = frames if len(message.layout.lengths) > 1 else b"".join(frames)
        columns, table = cls.decode_many(given), cls.decode_table(given)
        assert len(table) == len(frames)
        results.append(
            (
                message.name,
                {key: _plain(column) for key, column in columns.items()},
                str(table.schema),
                str(table.to_pylist()),
            )
        )
    return results


def _is_accepted(cls: type, frame: bytes, refusal: type[Exception]) -> bool:
    try:
        cls.from_bytes(frame)  # type: ignore[attr-defined]
    except refusal:
        return False
    return True


def _plain(column: object) -> str:
    return f"{getattr(column, 'dtype', '')} {column.tolist() if hasattr(column, 'tolist') else column!r}"


def _xtce(subject: Subject) -> object:
    """Return the contents of the XTCE file after import, as other programs can read it."""
    folder = Path(tempfile.mkdtemp(dir=subject.folder))
    return {
        name: readback.read_back(file, folder)
        for name, file in readback.write(subject.icd, folder).items()
    }


def is_change_reported(old: Subject, new: Subject) -> bool:
    """Return whether the diff reports the change."""
    return bool(compare(old.icd, new.icd).changes)


def is_formatted(subject: Subject) -> bool:
    """Return whether `icdgen fmt` formats the example without a change of its values.

    The tree is given as JSON, so that the input has another layout.
    """
    tree = yaml.safe_load(subject.content)
    formatted = format_text(json.dumps(tree), "example.yaml")
    return (
        yaml.safe_load(formatted) == tree
        and format_text(formatted, "example.yaml") == formatted
        and "{at: " in formatted
    )


RESULTS: dict[str, Callable[[Subject], object]] = {
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
