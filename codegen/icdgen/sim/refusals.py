"""Reasons of refusals, as users name them: by a member of the enumeration or a number."""

from __future__ import annotations

from icdgen_runtime.wire.packet_formats import Response

from icdgen.values import numbers


def refusal_names(response: Response) -> tuple[str, ...]:
    """Return the names of the reasons with which a response refuses a telecommand."""
    names = (name for code, name in response.reasons if _refuses_with(response, code))
    return tuple(dict.fromkeys(names))


def first_refusal_code(response: Response) -> int | None:
    """Return the first reason of the ICD with which a response refuses a telecommand;
    None without one.
    """
    codes = (code for code, _ in response.reasons if _refuses_with(response, code))
    return next(codes, None)


def refusal_code(response: Response, text: str) -> int | None:
    """Return the number of a reason, given as a name or a number; None if the response
    cannot refuse with it.
    """
    # Of a range, the first value counts.
    named = {name: value for value, name in reversed(response.reasons)}
    number = named.get(text, numbers.integer(text))
    is_possible = number is not None and _refuses_with(response, number)
    return number if is_possible else None


def _refuses_with(response: Response, number: int) -> bool:
    """Return whether a reason fits into its field and does not mean anything else."""
    place = response.reason
    if place is None or not 0 <= number < 1 << place.bits:
        return False
    is_status = place == response.status
    verdict = dict(response.meanings).get(number, "nak")
    return not is_status or verdict in ("nak", "again")
