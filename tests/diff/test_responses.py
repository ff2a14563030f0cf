"""Changes of the responses to telecommands are reported in words that a reader of the
report understands.
"""

from __future__ import annotations

import pytest

from icdgen.diff.compare import compare
from icdgen.loading import load
from tests.conftest import ROOT

WHEEL = (ROOT / "examples" / "links" / "wheel.yaml").read_text()
NAK = "nak: {message: Nak, echo: Command, reason: Reason}"


@pytest.mark.parametrize(
    ("old", "new", "message", "severity", "effect"),
    [
        (
            "busy: {message: Busy, echo: Command}",
            "",
            "the response `busy` to telecommands is gone; it was {message: Busy, echo: Command}",
            "warning",
            "",
        ),
        (
            NAK,
            NAK.replace(", echo: Command", ""),
            "`echo` of the response `nak` to telecommands is gone; it was Command",
            "error",
            "may not recognize this response, or take it for the response to another",
        ),
        (
            NAK.replace(", echo: Command", ""),
            NAK,
            "`echo` of the response `nak` to telecommands is new: Command",
            "error",
            "may not recognize this response, or take it for the response to another",
        ),
        (
            "unknown_id: Unknown command, ",
            "",
            "`reasons.unknown_id` in `commands` is gone; it was Unknown command",
            "warning",
            "",
        ),
    ],
)
def test_a_change_names_the_response_and_the_behaviour_of_an_old_program(
    tmp_path, old, new, message, severity, effect
):
    text = WHEEL.replace(NAK, old) if old.startswith("nak") else WHEEL
    (change,) = changes(tmp_path, text, old, new)
    assert (change.message, change.severity) == (message, severity)
    assert effect in " ".join(change.details)


def test_another_spelling_of_a_response_is_no_change(tmp_path):
    text = WHEEL.replace("ack: {message: Ack, echo: Command}", "ack: Ack")
    assert changes(tmp_path, text, "ack: Ack", "ack: {message: Ack}") == []


def changes(folder, text, old, new):
    """Return the changes of the rule DIF216 after a replacement in an ICD."""
    assert old in text
    icds = []
    for name, content in (("previous", text), ("current", text.replace(old, new))):
        file = folder / f"{name}.yaml"
        file.write_text(content)
        icds.append(load([file]).icd)
    return [each for each in compare(*icds).changes if each.code == "DIF216"]
