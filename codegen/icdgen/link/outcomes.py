"""Outcomes of requests in words and as JSON, for `icdgen monitor` and `icdgen send`."""

from __future__ import annotations

from typing import Any

from icdgen_runtime.wire.events import Busy, Outcome, Refused, Timeout

from icdgen.icd.model import Icd, Message, Node
from icdgen.icd.responses import declared_responses, echoes_of, reason_of
from icdgen.values.frame import DecodedFrame


def failure_text(outcome: Refused | Busy) -> str:
    """Return a refusal or a busy device with its reason, such as ``refused: Bad length
    (code 2)``.
    """
    is_refusal = isinstance(outcome, Refused)
    word = "refused" if is_refusal else "busy"
    # A busy device often has no reason: its field is 0 then, such as `Nothing`.
    if outcome.code is None or not (is_refusal or outcome.code):
        return word
    name = outcome.reason or "unknown error"
    return f"{word}: {name} (code {outcome.code})"


def outcome_report(
    message: str, outcome: Outcome, response: DecodedFrame | None
) -> dict[str, Any]:
    """Return the outcome of a request of ``message`` as JSON, without the keys that this
    kind of outcome does not have.
    """
    report = {
        "message": message,
        "event": type(outcome).__name__.lower(),
        "reason": getattr(outcome, "reason", None),
        "code": getattr(outcome, "code", None),
        "attempts": outcome.attempts,
        "response": response.to_json() if response else None,
    }
    return {key: value for key, value in report.items() if value is not None}


def attempts_text(outcome: Busy | Timeout) -> str:
    """Return the number of attempts, such as `` after 3 attempts``; empty for one."""
    return f" after {outcome.attempts} attempts" if outcome.attempts > 1 else ""


def has_further_fields(icd: Icd, node: Node, sent: Message, response: Message) -> bool:
    """Return whether a response says more than the telecommand, the status and the
    reason.
    """
    commands = icd.protocol_of(node).get("link", {}).get("commands", {})
    # Fields that a report shows already.
    reported: set[str | None] = set()
    for row in declared_responses(commands, sent).values():
        if row.get("message") == response.name:
            reported |= {*echoes_of(row), row.get("status"), reason_of(row)}
    return any(
        field.name not in reported and field.const is None
        for field in icd.longest_frame(response)
    )
