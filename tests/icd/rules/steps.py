"""ICDs with procedures, for tests of the rules about them."""

from __future__ import annotations

from pathlib import Path

from tests.icd.rules.marked import reported_by_line

MESSAGES = """\
enums:
  - {name: Area, members: [{value: 0, name: Application}, {value: 1, name: Backup}]}
messages:
  - name: Write
    id: 1
    kind: telecommand
    length: 8
    fields:
      - {at: 0,  bits: 8,  name: Area,   type: enum, enum: Area}
      - {at: 8,  bits: 8,  name: Number, type: uint}
      - {at: 16, bits: 16, name: Offset, type: uint}
      - {at: 32, bits: 32, name: Data,   type: bytes}
  - {name: Next, id: 2, kind: telecommand, length: 0}
  - name: Map
    set_id: 3
    get_id: 131
    kind: configuration
    length: 1
    fields: [{at: 0, bits: 8, name: Bits, type: bytes}]
  - name: More
    set_id: 4
    get_id: 132
    kind: configuration
    length: 1
    fields: [{at: 0, bits: 8, name: Bits, type: bytes}]
  - name: State
    id: 129
    kind: telemetry
    length: 5
    fields:
      - {at: 0,  bits: 1,  name: Busy,   type: bool}
      - {at: 8,  bits: 16, name: Length, type: uint}
      - {at: 24, bits: 16, name: Sum,    type: uint}
  - name: Packet
    id: 130
    kind: telemetry
    length: 5
    fields:
      - {at: 0, bits: 8,  name: Number, type: uint}
      - {at: 8, bits: 32, name: Data,   type: bytes}
"""

# Lists of steps of a procedure -> a step that has a step in such a list.
PLACES = {
    "steps": "{}",
    "blocks": "blocks: {{size: 4, rounds: 1, steps: [{{{}}}]}}",
    "each": "blocks: {{size: 4, rounds: 1, steps: [{{missing: {{packet: 4, each: [{{{}}}]}}}}]}}",
    "round": "blocks: {{size: 4, rounds: 1, steps: [{{missing: {{packet: 4, steps: [{{{}}}]}}}}]}}",
    "repeat": "repeat: [{{{}}}]",
}


def procedure(
    *steps: str,
    inputs: str = "",
    outputs: str = "",
    limits: str = "",
    name: str = "one",
) -> str:
    """Return a procedure with a line for each step."""
    lines = [f"    {name}:", f"      limits: {{time_s: 60, requests: 100{limits}}}"]
    lines += [f"      inputs: {{{inputs}}}"] * bool(inputs)
    lines += [f"      outputs: {{{outputs}}}"] * bool(outputs)
    lines += ["      steps:", *(f"        - {{{step}}}" for step in steps)]
    return "\n".join(lines) + "\n"


def icd(*procedures: str, link: str = "") -> str:
    """Return an ICD with these procedures."""
    return f"protocol:\n{link}  procedures:\n{''.join(procedures)}{MESSAGES}"


def by_step(folder: Path, text: str, code: str) -> dict[int, list[tuple[str, str]]]:
    """Return (marked text, message) by the number of the step, from 0."""
    rows = reported_by_line(folder, text, code, "      steps:")
    return {number - 1: row for number, row in rows.items()}
