"""Compatibility of old and new software: ground stations, telecommands and log files.

`directions` answers three questions from a comparison, each for every frame of the old
ICD: can an old ground station read new telemetry, can old telecommands still be sent,
and can old programs read new logs. The report shows the frames that are not compatible.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable

from icdgen.describe.numbers import length_text
from icdgen.diff.changes.numbers import is_derived_otherwise, is_wider
from icdgen.diff.compare import Comparison
from icdgen.diff.context import by_id
from icdgen.diff.facts import AROUND
from icdgen.diff.pairs import FieldPair, MessagePair, NodePair, kind
from icdgen.diff.similar import other_senses
from icdgen.diff.wording import read_as, some
from icdgen.frozen import NamedTuple
from icdgen.icd.formula import RAW
from icdgen.icd.lines import lines
from icdgen.icd.model import Message
from icdgen.wording import quote

YES, PARTLY, NO = "yes", "partly", "no"


class IncompatibleFrame(NamedTuple):
    """Frame that is not fully compatible."""

    node: str
    message: str
    id: int
    verdict: str
    reasons: tuple[str, ...]


class DirectionCompatibility(NamedTuple):
    """Compatibility in one direction.

    ``frames`` are the frames that are not fully compatible. ``general``: reasons that
    concern all frames.
    """

    key: str
    question: str
    verdict: str
    frames: tuple[IncompatibleFrame, ...]
    total: int
    general: tuple[str, ...]

    @property
    def worst_first(self) -> list[IncompatibleFrame]:
        """Frames, incompatible ones first."""
        return sorted(self.frames, key=lambda frame: frame.verdict != NO)


Judge = Callable[[MessagePair], tuple[str, tuple[str, ...]]]


def directions(comparison: Comparison) -> tuple[DirectionCompatibility, ...]:
    """Return the compatibility of telemetry, telecommands and log files."""
    telemetry_facts, log_facts = _facts(comparison, "telemetry")
    telecommand_facts, _ = _facts(comparison, "telecommand")
    old_reads_new = _frames(
        comparison,
        "telemetry_id",
        lambda pair: _read_compatibility(pair, pair.new, pair.old),
    )
    new_obeys_old = _frames(comparison, "telecommand_id", _telecommand_compatibility)
    new_reads_old_logs = _frames(
        comparison,
        "telemetry_id",
        lambda pair: _read_compatibility(pair, pair.old, pair.new),
        logged=True,
    )
    return (
        _answer(
            "telemetry",
            "Can an old ground station read the new device's telemetry?",
            old_reads_new,
            telemetry_facts,
        ),
        _answer(
            "telecommands",
            "Can old telecommands still be sent?",
            new_obeys_old,
            telecommand_facts,
        ),
        _answer(
            "logs",
            "Can new software read old log files?",
            new_reads_old_logs,
            log_facts,
        ),
    )


def _answer(
    key: str,
    question: str,
    frames: list[IncompatibleFrame | None],
    general: tuple[str, ...],
) -> DirectionCompatibility:
    affected = tuple(frame for frame in frames if frame is not None)
    if (
        affected
        and len(affected) == len(frames)
        and all(frame.verdict == NO for frame in affected)
    ):
        verdict = NO
    else:
        verdict = PARTLY if affected or general else YES
    return DirectionCompatibility(
        key, question, verdict, affected, len(frames), general
    )


def _facts(
    comparison: Comparison, direction: str
) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return the changes of protocol facts that concern all frames of a direction in
    transmission, and all frames in a log.
    """
    wires: list[str] = []
    logs: list[str] = []
    for change in comparison.changes:
        if change.code in ("DIF120", "DIF121", "DIF134") and change.breaks:
            fact = change.where.section  # "protocol.link.framing.escape"
            if isinstance(change.pair, NodePair) and not _is_of_all(
                comparison, change.pair, fact, direction
            ):
                continue
            is_of_log = any("log" in step for step in fact.split(".")[1:2])
            (logs if is_of_log else wires).append(change.message)
        elif change.code == "DIF116" and change.breaks:
            wires.append(change.message)
        elif change.code in ("DIF122", "DIF123"):
            logs.append(change.message)
    return tuple(wires), tuple(logs)


def _is_of_all(
    comparison: Comparison, node: NodePair, fact: str, direction: str
) -> bool:
    """Return whether a fact concerns all messages of a direction.

    For nodes with packet formats this requires a changed packet format.
    """
    if not comparison.context.have_packet_formats(node):
        return True
    return bool(
        AROUND.fullmatch(fact)
    ) and direction in comparison.context.changed_packet_formats(node)


def _frames(
    comparison: Comparison, key: str, judge: Judge, logged: bool = False
) -> list[IncompatibleFrame | None]:
    """Return an entry for each frame of the old ICD; None for fully compatible frames.

    A frame of a shared ICD counts once.
    """
    match, seen, results = comparison.match, set(), []
    for node in match.nodes:
        if node.before is None:
            continue
        old = [
            (number, m)
            for m in match.old.messages_of(node.old)
            if (number := getattr(m, key)) is not None
        ]
        new = by_id(match.new.messages_of(node.new) if node.both else (), key)
        # Empty: the node logs all frames
        wanted = {row.id for row in node.old.loggable} if logged else set()
        changed_formats = (
            () if logged else comparison.context.changed_packet_formats(node)
        )
        for number, message in old:
            if wanted and number not in wanted:
                continue
            verdict, reasons = _verdict(
                comparison, key, message, new.get(number, []), judge
            )
            if verdict != NO and key.removesuffix("_id") in changed_formats:
                verdict, reasons = NO, ("its packet format is another",)
            # Nodes that include the same ICD share its messages.
            if (id(message), verdict) in seen:
                continue
            seen.add((id(message), verdict))
            results.append(
                None
                if verdict == YES
                else IncompatibleFrame(
                    node.old.name, message.name, number, verdict, reasons
                )
            )
    return results


def _verdict(
    comparison: Comparison,
    key: str,
    old: Message,
    candidates: list[Message],
    judge: Judge,
) -> tuple[str, tuple[str, ...]]:
    """Return the compatibility of a message of the old ICD, with reasons.

    ``candidates``: messages of the new ICD that have its id.
    """
    pair = comparison.match.messages[id(old)]
    # Multiplexed messages share an id: the counterpart is one of them.
    new = next((message for message in candidates if message is pair.after), None)
    if new is None and len(candidates) == 1:
        new = candidates[0]
    if new is None:
        after = getattr(pair.after, key, None)
        if after is None:
            return NO, ("it is gone",)
        # The message may still have its id, if only the node no longer uses it.
        if after == getattr(old, key):
            return NO, ("the node no longer uses it",)
        return NO, (f"its id is {after} now",)
    # Another message took over the id.
    if comparison.match.messages.get(id(new)) is not pair:
        return NO, (f"the id means {quote(new.name)} now",)
    if not pair.changed:
        return YES, ()
    return judge(pair)


def _read_compatibility(
    pair: MessagePair, sent: Message, reader: Message
) -> tuple[str, tuple[str, ...]]:
    """Return the compatibility of frames with the layout ``sent`` for software with the
    layout ``reader``.
    """
    lengths, length_reasons = _lengths(sent, reader, "come")
    if lengths == NO:
        return NO, length_reasons
    # Overlays repeat bits of other fields
    own = [p for p in pair.parts if not p.any.is_read_only]
    derived = [(p, "another formula") for p in pair.common if is_derived_otherwise(p)]
    # Fields that the reader expects but the sender does not have.
    absent = [
        p.any
        for p in own
        if not p.both and (p.before if reader is pair.old else p.after) is not None
    ]
    wrong = [(p, why) for p in pair.common if (why := _misread(p))]
    if not absent and not wrong and not derived:
        return lengths, length_reasons
    reasons = [
        *length_reasons,
        *_lines_by_reason((p.any.name, why) for p, why in (*wrong, *derived)),
    ]
    if absent:
        reasons.append(f"not carried: {some([f.name for f in absent])}")
    # Without any field that is read correctly, the frame is of no use to the reader.
    expected = sum(not line.is_read_only for line in lines(reader.layout))
    return NO if len(absent) + len(wrong) == expected else PARTLY, tuple(reasons)


def _lines_by_reason(items: Iterable[tuple[str, str]]) -> list[str]:
    """Return one line for each reason with the names it concerns: ``has another unit:
    `a` and `b` ``.
    """
    names_by_reason: dict[str, list[str]] = {}
    for name, why in items:
        names_by_reason.setdefault(why, []).append(name)
    return [f"{why}: {some(names)}" for why, names in names_by_reason.items()]


def _misread(pair: FieldPair) -> str:
    """Return the reason why the sides interpret a value differently; empty if they do
    not.
    """
    old, new = pair.old, pair.new
    # The order of these checks is from the wire to the meaning: the first difference
    # explains the others.
    if not pair.same_bits:
        return "other bits"
    if set(old.conditions) != set(new.conditions):
        return "there in other messages"
    if kind(old) != kind(new):
        return f"read as {read_as(new)}, or as {read_as(old)}"
    if (old.curve or old.scale or RAW) != (new.curve or new.scale or RAW):
        return "another formula"
    if old.unit_symbol != new.unit_symbol:
        return "another unit"
    has_other_senses = (
        old.enum
        and new.enum
        and old.enum is not new.enum
        and other_senses(old.enum, new.enum)
    )
    return "values of another sense" if has_other_senses else ""


def _lengths(sent: Message, reader: Message, verb: str) -> tuple[str, tuple[str, ...]]:
    """Return whether the lengths of sent frames match the expected lengths."""
    lengths, expected = sent.layout.lengths, reader.layout.lengths
    fitting = sum(length in expected for length in lengths)
    if fitting == len(lengths):
        return YES, ()
    if len(lengths) == len(expected) == 1:
        return NO, (f"{lengths[0]} bytes {verb}, {expected[0]} are expected",)
    text = f"{length_text(sent)} {verb}, {length_text(reader)} are expected"
    return (PARTLY if fitting else NO), (text,)


def _telecommand_compatibility(pair: MessagePair) -> tuple[str, tuple[str, ...]]:
    """Return whether the new device obeys telecommands that old software sends."""
    old, new = pair.old, pair.new
    lengths, length_reasons = _lengths(old, new, "are sent")
    if lengths == NO:
        return NO, length_reasons
    results = [
        (part, *_disobeyed(part)) for part in pair.parts if not part.any.is_read_only
    ]
    reasons = [
        *length_reasons,
        *_lines_by_reason((part.any.name, why) for part, why, _ in results if why),
    ]
    if any(is_refused for *_, is_refused in results):
        return NO, tuple(reasons)
    return PARTLY if reasons else YES, tuple(reasons)


def _disobeyed(pair: FieldPair) -> tuple[str, bool]:
    """Return the problem of a field of a telecommand, and whether the device refuses
    the telecommand because of it.
    """
    old, new = pair.before, pair.after
    if new is None:
        return "ignored", False
    if old is None:
        # Old software sends zeros in bits without a field: a constant of 0 accepts
        # them.
        refused = bool(new.const)
        return (f"sent as 0, must be {new.const}" if refused else "sent as 0"), refused
    if new.const is not None and old.const != new.const:
        return (
            f"must be {new.const}, sent as {'anything' if old.const is None else old.const}",
            old.const is not None,
        )
    why = _misread(pair)
    if not why and not is_wider(old.limits, new.limits):
        why = "perhaps refused, the limits are narrower"
    return why, False
