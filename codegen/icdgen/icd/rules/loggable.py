"""The table of loggable frames: its ids, its mask bits, and the frames that they select."""

from __future__ import annotations

from collections.abc import Iterator

from icdgen.icd.model import Message, Node
from icdgen.icd.rules.context import Context
from icdgen.icd.rules.fault import Fault
from icdgen.icd.rules.rule import rule
from icdgen.icd.rules.wording import count, line_of, quote
from icdgen.suggest import close_to


def _telemetry(ctx: Context, node: Node) -> dict[int, Message]:
    return {m.telemetry_id: m for m in ctx.messages_of(node) if m.telemetry_id is not None}


def _log_mask(ctx: Context, node: Node, key: str) -> int | None:
    """A number of the protocol section `log_mask`, if it is given."""
    section = ctx.protocol_of(node).get("log_mask")
    value = section.get(key) if isinstance(section, dict) else None
    return value if isinstance(value, int) else None


@rule("ICD043", whole=True)
def frame_exists(ctx: Context) -> Iterator[Fault]:
    for node in ctx.icd.nodes:
        if not node.loggable:
            continue
        frames = _telemetry(ctx, node)
        missing = {m.id for n in ctx.scope(node) for m in n.missing if m.kind != "telecommand"}
        by_name = {m.name: i for i, m in frames.items()}
        for row in node.loggable:
            if row.id not in frames and row.id not in missing:
                close = close_to(row.name, by_name) if row.name else ""
                help = f"{quote(close)} has id {by_name[close]}" if close else "correct `id`"
                message = f"loggable bit {row.bit} points nowhere: there is no telemetry {row.id}"
                yield Fault(row.source, row.source.at("id"), message, help)


@rule("ICD044")
def bits_distinct(ctx: Context) -> Iterator[Fault]:
    for node in ctx.icd.nodes:
        size = _log_mask(ctx, node, "bytes")
        bits: dict[int, int] = {}
        ids: dict[int, int] = {}
        for row in node.loggable:
            source = row.source
            for key, value, seen in (("bit", row.bit, bits), ("id", row.id, ids)):
                if value in seen:
                    what = f"the mask bit {value}" if key == "bit" else f"the frame {value}"
                    message = f"{what} stands twice in the table, first in line {seen[value]}"
                    yield Fault(source, source.at(key), message, f"correct one `{key}`")
                seen.setdefault(value, source.at(key).line)
            if size is not None and row.bit >= size * 8:
                message = f"bit {row.bit} is outside the mask of {count(size, 'byte')}"
                yield Fault(source, source.at("bit"), message, f"its bits are 0 to {size * 8 - 1}")


@rule("ICD045")
def frame_fits(ctx: Context) -> Iterator[Fault]:
    for node in ctx.icd.nodes:
        if not node.loggable:
            continue
        frames, size = _telemetry(ctx, node), _log_mask(ctx, node, "frame_bytes")
        for row in node.loggable:
            frame = frames.get(row.id)
            if frame is None:
                continue
            source, here = row.source, f"telemetry {row.id}"
            if row.name and row.name != frame.name:
                place = source.at("name")
                other = f"{quote(frame.name)} ({line_of(frame.source.at('name'), place)})"
                yield Fault(source, place, f"{here} is called {other}, not {quote(row.name)}", "correct `name` or `id`")
            if size is not None and frame.length != size:
                message = f"{quote(frame.name)} has {count(frame.length, 'byte')}, a frame in the log has {size}"
                yield Fault(source, source.at("id"), message, "correct `id`, or the `length` of the frame")
