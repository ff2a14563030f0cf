"""What is said of a message that shares its id: with which others, and what shows that a frame is of this one."""

from __future__ import annotations

from icdgen.describe.comments import listed, words
from icdgen.describe.numbers import length_text, value_text
from icdgen.icd.model import Message
from icdgen.icd.variants import Ids, Variant, common_length, is_narrower


def sharing(ids: Ids, message: Message) -> str:
    """``Shares its id with Ephemeris and Almanac, and has Type 1.`` Empty if it has an id of its own. ``ids``: of its node."""
    said: dict[str, None] = {}
    for id, known in ((message.telecommand_id, ids.telecommand), (message.telemetry_id, ids.telemetry)):
        group = known[id] if id is not None else ()
        if len(group) > 1:
            own = next(one for one in group if one.message is message)
            name = {message.set_id: "set id", message.get_id: "get id"}.get(id, "id")
            said[f"Shares its {name} with {_sentence(own, group)}"] = None
    return " ".join(said)


def _sentence(own: Variant, group: tuple[Variant, ...]) -> str:
    others = [one for one in group if one is not own]
    has = [length_text(own.message)] if common_length(group) is None else []
    has += (f"{words(field.name)} {value_text(field.const or 0)}" for field in own.constants)
    clauses = [f"has {listed(has)}"] if has else []
    if any(is_narrower((one.message, one.node), (own.message, own.node)) for one in others):
        clauses.append("is what none of the others is")
    return f"{listed([words(one.message.name) for one in others])}, and {' and '.join(clauses)}."
