"""Labelled values in the rows above the fields of a message, such as ``ID 132, Frame
Length (bytes) 6``.

They may be distributed over any number of cells: the cells are joined before they are
parsed. The `labels` of the profile give them a meaning.
"""

from __future__ import annotations

import re

from icdgen.frozen import NamedTuple
from icdgen.importer.profile import Profile
from icdgen.importer.words import (
    depends_on_count,
    folded,
    plain,
    without_blanks_in_counts,
)

_VALUE = re.compile(
    r"(?:0[xX][0-9A-Fa-f]+|[0-9]+)(?:\s*/\s*(?:0[xX][0-9A-Fa-f]+|[0-9]+))?\Z"
)
_COUNTED = frozenset({"byte", "bytes", "octet", "octets"})


class Labelled(NamedTuple):
    """A label and its value as text.

    ``what`` is the meaning of the label in the profile, "" if it has none.
    """

    what: str
    label: str
    value: str


def parse_labels(text: str, profile: Profile) -> list[Labelled]:
    """Return all labels with a number after them, in order.

    A label without a number is last, with an empty value.
    """
    labelled: list[Labelled] = []
    label: list[str] = []
    words = (
        re.sub(
            r"(?<=[0-9])\s*/\s*(?=[0-9])", "/", without_blanks_in_counts(plain(text))
        )
        .replace(":", " : ")
        .split()
    )
    for word in words:
        bare = word.strip(",;|")
        if (_VALUE.match(bare) or depends_on_count(bare)) and label:
            labelled.append(
                Labelled(
                    meaning_of_label(" ".join(label), profile), " ".join(label), bare
                )
            )
            label = []
        elif bare in (":", "=", "-", "") and not folded(bare):
            continue
        elif (
            bare.startswith("(")
            and labelled
            and not label
            and _VALUE.match(bare.strip("()"))
        ):
            continue  # the same number in another base
        elif bare.casefold() in _COUNTED and labelled and not label:
            continue  # `Length: 6 bytes`
        else:
            label.append(bare)
    if label:
        labelled.append(
            Labelled(meaning_of_label(" ".join(label), profile), " ".join(label), "")
        )
    return labelled


def meaning_of_label(label: str, profile: Profile) -> str:
    """Return the meaning of a label, or "".

    The order of its words is ignored, because cells may be torn.
    """
    return profile.labels.get(tuple(sorted(folded(label))), "")


def begins_message_table(text: str, profile: Profile) -> bool:
    """Return whether a line can only be the first row of a message table.

    It has the id of the message, and only labelled values.
    """
    labelled = parse_labels(text, profile)
    return (
        bool(labelled)
        and labelled[0].what in ("id", "both_ids", "set_id")
        and bool(labelled[0].value)
        and all(
            label.what and (label.value or label.what in ("description", "fields"))
            for label in labelled
        )
    )


def leading_meaning(text: str, profile: Profile) -> str:
    """Return the meaning of the label at the begin of a line ("description", "fields"
    ...), or "".
    """
    words = plain(text).split()
    meanings = (
        meaning_of_label(" ".join(words[:length]), profile)
        for length in range(min(5, len(words)), 0, -1)
    )
    return next(filter(None, meanings), "")
