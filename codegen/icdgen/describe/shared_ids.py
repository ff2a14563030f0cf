"""Comments on messages that share an id: with which messages, and how a frame is
recognised.

`icdgen.icd.variants` decides which message a frame belongs to; this module states the
decision as a sentence.
"""

from __future__ import annotations

from icdgen.describe.comments import words
from icdgen.describe.numbers import length_text, value_text
from icdgen.icd.model import Message
from icdgen.icd.variants import Ids, Variant, common_length, is_narrower
from icdgen.wording import listing


def sharing_sentence(ids: Ids, message: Message) -> str:
    """Return ``Shares its id with Ephemeris and Almanac, and has Type 1.``; empty if no
    message of its node has the same id.
    """
    # A dict, because a configuration message can have the same sentence for both of its
    # ids.
    sentences: dict[str, None] = {}
    for id, groups in (
        (message.telecommand_id, ids.telecommand),
        (message.telemetry_id, ids.telemetry),
    ):
        group = groups[id] if id is not None else ()
        if len(group) > 1:
            own = next(variant for variant in group if variant.message is message)
            name = {message.set_id: "set id", message.get_id: "get id"}.get(id, "id")
            sentences[f"Shares its {name} with {_sentence(own, group)}"] = None
    return " ".join(sentences)


def _sentence(own: Variant, group: tuple[Variant, ...]) -> str:
    other_variants = [variant for variant in group if variant is not own]
    has = [length_text(own.message)] if common_length(group) is None else []
    has += (
        f"{words(field.name)} {value_text(field.const or 0)}" for field in own.constants
    )
    clauses = [f"has {listing(has)}"] if has else []
    if any(
        is_narrower((variant.message, variant.node), (own.message, own.node))
        for variant in other_variants
    ):
        clauses.append("is what none of the others is")
    return f"{listing([words(variant.message.name) for variant in other_variants])}, and {' and '.join(clauses)}."
