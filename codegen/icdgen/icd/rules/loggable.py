"""Table of loggable frames: ids, mask bits and the frames that they select.

The rules compare the entries of `loggable` with the telemetry of the node and its
included nodes (ICD043, ICD045), and with each other and the mask (ICD044). `log_mask`
of the protocol section gives the sizes of mask and frame. A frame listed in `missing`
counts as existing.
"""

from __future__ import annotations

from collections.abc import Iterator

from icdgen.diagnostics import Related
from icdgen.icd.fault import Fault
from icdgen.icd.located import Map
from icdgen.icd.model import KEYS_OF_IDS, TELECOMMAND, TELEMETRY, Message, Node
from icdgen.icd.rules.context import Context
from icdgen.icd.rules.rule import rule
from icdgen.icd.rules.wording import line_of
from icdgen.suggest import close_to
from icdgen.wording import count, quote


def _telemetry(ctx: Context, node: Node) -> dict[int, Message]:
    """Return the telemetry messages of a node by id."""
    return {
        message.telemetry_id: message
        for message in ctx.messages_of(node)
        if message.telemetry_id is not None
    }


def _id_key(message: Message) -> str:
    """Return the key of the telemetry id of a message: `id` or `get_id`."""
    return next(
        key for key, direction in KEYS_OF_IDS[message.kind] if direction == TELEMETRY
    )


@rule("ICD043", needs_complete=True)
def loggable_frames_exist(ctx: Context) -> Iterator[Fault]:
    for node in ctx.icd.nodes:
        frames = _telemetry(ctx, node)
        # Frames that the manual lists in the table but does not describe.
        missing: set[int] = set()
        for owner in ctx.scope(node):
            missing.update(
                entry.id for entry in owner.missing if entry.kind != TELECOMMAND
            )
        by_name = {
            frame.name: (frame.source, _id_key(frame)) for frame in frames.values()
        }
        for row in node.loggable:
            if row.id not in frames and row.id not in missing:
                close = close_to(row.name, by_name) if row.name else ""
                help, fix = "correct `id`", ""
                if close:
                    fix = ctx.written(*by_name[close])
                    help = f"{quote(close)} has id {fix}"
                message = f"loggable bit {row.bit} points nowhere: there is no telemetry {ctx.written(row.source, 'id')}"
                yield Fault.at(row.source, "id", message, help, fix)


@rule("ICD044")
def loggable_entries_are_unique(ctx: Context) -> Iterator[Fault]:
    for node in ctx.icd.nodes:
        size = ctx.fact(node, "log_mask", "bytes")
        bits: dict[int, Map] = {}
        ids: dict[int, Map] = {}
        for row in node.loggable:
            source = row.source
            for key, value, seen in (("bit", row.bit, bits), ("id", row.id, ids)):
                if value in seen:
                    first = seen[value].at(key)
                    what = f"{'mask bit' if key == 'bit' else 'frame'} {ctx.written(source, key)}"
                    message = (
                        f"{what} is in the table twice, first in line {first.line}"
                    )
                    related = Related(first, f"the first `{key}` of this value")
                    yield Fault.at(
                        source, key, message, f"correct one `{key}`", related=related
                    )
                seen.setdefault(value, source)
            if isinstance(size, int) and row.bit >= size * 8:
                message = f"bit {row.bit} is outside the mask of {count(size, 'byte')}"
                yield Fault.at(
                    source, "bit", message, f"its bits are 0 to {size * 8 - 1}"
                )


@rule("ICD045")
def loggable_entries_match_the_messages(ctx: Context) -> Iterator[Fault]:
    for node in ctx.icd.nodes:
        frames, size = _telemetry(ctx, node), ctx.fact(node, "log_mask", "frame_bytes")
        for row in node.loggable:
            frame = frames.get(row.id)
            if frame is None:
                continue
            source = row.source
            if row.name and row.name != frame.name:
                here = f"telemetry {ctx.written(source, 'id')}"
                other = f"{quote(frame.name)} ({line_of(frame.source.at('name'), source.at('name'))})"
                text = f"{here} is called {other}, not {quote(row.name)}"
                yield Fault.at(source, "name", text, "correct `name` or `id`")
            if isinstance(size, int) and frame.length != size:
                message = f"{quote(frame.name)} has {count(frame.length, 'byte')}, a frame in the log has {size}"
                yield Fault.at(
                    source, "id", message, "correct `id`, or the `length` of the frame"
                )
