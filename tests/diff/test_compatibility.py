"""Which release understands which, and the resulting step of the version."""

from __future__ import annotations

import pytest

from icdgen.diff.compare import compare
from icdgen.diff.compatibility import directions
from icdgen.diff.version import step
from icdgen.loading import load
from tests.icd.files import HEAD, write

BASE = """\
enums:
  - name: Mode
    members: [{value: 0, name: Idle}, {value: 1, name: Run}]
messages:
  - name: Status
    id: 130
    kind: telemetry
    length: 3
    fields:
      - {at: 0,  bits: 16, name: Voltage, type: int, unit: mV, formula: raw*0.5}
      - {at: 16, bits: 4,  name: Mode,    type: enum, enum: Mode}
      - {at: 21, bits: 3,  name: Count,   type: uint}
  - name: Set Mode
    id: 10
    kind: telecommand
    length: 2
    fields:
      - {at: 0, bits: 8, name: Magic, type: uint, const: 0x5A}
      - {at: 8, bits: 4, name: Mode,  type: enum, enum: Mode}
      - {at: 12, bits: 3, name: Level, type: uint, max: 5}
      - {at: 15, bits: 1, name: Last, type: bool}
"""
LOGGED = (
    BASE
    + """\
  - name: Power
    id: 131
    kind: telemetry
    length: 1
    fields: [{at: 0, bits: 8, name: Current, type: uint}]
loggable: [{bit: 0, id: 130}]
protocol:
  link:
    buses:
      uart: {framing: {by: escape, escape: 31, start: 127, end: 255, data: 31}}
"""
)


def compared(tmp_path, old: str, new: str):
    sides = []
    for name, text in (("old", old), ("new", new)):
        (tmp_path / name).mkdir()
        write(tmp_path / name, HEAD + text)
        loaded = load([tmp_path / name], check=False)
        assert loaded.findings == []
        sides.append(loaded.icd)
    return compare(*sides)


def answers(tmp_path, change: tuple[str, str], base: str = BASE) -> dict:
    assert change[0] in base
    return {
        direction.key: direction
        for direction in directions(compared(tmp_path, base, base.replace(*change)))
    }


@pytest.mark.parametrize(
    "change, telemetry, telecommands, logs",
    [
        (("summary", "summary"), "yes", "yes", "yes"),
        (("length: 3", "length: 4"), "no", "yes", "no"),
        (("id: 130", "id: 140"), "no", "yes", "no"),
        (("id: 10", "id: 11"), "yes", "no", "yes"),
        (("raw*0.5", "raw*0.25"), "partly", "yes", "partly"),
        (("unit: mV", "unit: V"), "partly", "yes", "partly"),
        (("name: Count,   type: uint", "name: Count,   type: int"), "partly", "yes", "partly"),
        (("      - {at: 21, bits: 3,  name: Count,   type: uint}\n", ""), "partly", "yes", "yes"),
        (("    kind: telemetry\n", "    kind: telemetry\n    summary: Words.\n"), "yes", "yes", "yes"),
        (("const: 0x5A", "const: 0x5B"), "yes", "no", "yes"),
        (("max: 5", "max: 4"), "yes", "partly", "yes"),
        (("max: 5", "max: 6"), "yes", "yes", "yes"),
        (("name: Level", "name: Power Level"), "yes", "yes", "yes"),
        (("      - {at: 15, bits: 1, name: Last, type: bool}\n", ""), "yes", "partly", "yes"),
        (("{value: 1, name: Run}", "{value: 1, name: Safe}"), "partly", "partly", "partly"),
        (("{value: 1, name: Run}", "{value: 1, name: Run}, {value: 2, name: Safe}"), "yes", "yes", "yes"),
    ],
)  # fmt: skip
def test_each_direction_has_a_verdict(tmp_path, change, telemetry, telecommands, logs):
    change = change if change[0] != "summary" else ("length: 3", "length: 3")
    directions_by_key = answers(tmp_path, change)
    assert [
        directions_by_key[key].verdict for key in ("telemetry", "telecommands", "logs")
    ] == [
        telemetry,
        telecommands,
        logs,
    ]


def test_a_new_field_breaks_old_telecommands_but_not_old_telemetry(tmp_path):
    new = BASE.replace("name: Last", "name: Final").replace(
        "{at: 12, bits: 3,", "{at: 12, bits: 2,"
    )
    (frame,) = {
        direction.key: direction
        for direction in directions(compared(tmp_path, BASE, new))
    }["telecommands"].frames
    assert (
        frame.message == "Set Mode"
        and frame.verdict == "partly"
        and frame.reasons == ("other bits: `Level`",)
    )


def test_an_id_of_another_message_is_incompatible_with_a_reason(tmp_path):
    directions_by_key = answers(
        tmp_path,
        ("  - name: Status\n    id: 130", "  - name: Status\n    id: 131"),
        LOGGED.replace("id: 131", "id: 132"),
    )
    (frame,) = directions_by_key["telemetry"].frames
    assert (frame.verdict, frame.reasons) == ("no", ("its id is 131 now",))


def test_only_frames_that_can_be_logged_matter_to_logs(tmp_path):
    directions_by_key = answers(
        tmp_path, ("name: Current, type: uint", "name: Current, type: int"), LOGGED
    )
    assert (
        directions_by_key["telemetry"].verdict == "partly"
        and directions_by_key["logs"].verdict == "yes"
        and directions_by_key["logs"].total == 1
    )


def test_framing_affects_the_wire_but_not_logs(tmp_path):
    directions_by_key = answers(tmp_path, ("escape: 31,", "escape: 30,"), LOGGED)
    assert [
        directions_by_key[key].verdict for key in ("telemetry", "telecommands", "logs")
    ] == [
        "partly",
        "partly",
        "yes",
    ]
    assert (
        "protocol.link.buses.uart.framing.escape"
        in directions_by_key["telemetry"].general[0]
    )


def test_the_mask_affects_logs(tmp_path):
    directions_by_key = answers(
        tmp_path, ("{bit: 0, id: 130}", "{bit: 0, id: 131}"), LOGGED
    )
    assert (
        directions_by_key["telemetry"].verdict == "yes"
        and directions_by_key["logs"].verdict == "partly"
        and directions_by_key["logs"].general
    )


def test_frames_of_a_removed_node_are_not_understood(tmp_path):
    (tmp_path / "a").mkdir()
    (tmp_path / "b").mkdir()
    write(tmp_path / "a", HEAD + BASE)
    (tmp_path / "a" / "other.yaml").write_text(HEAD.replace("demo", "other") + BASE)
    write(tmp_path / "b", HEAD + BASE)
    comparison = compare(load([tmp_path / "a"]).icd, load([tmp_path / "b"]).icd)
    directions_by_key = {
        direction.key: direction for direction in directions(comparison)
    }
    assert [(f.node, f.verdict) for f in directions_by_key["telemetry"].frames] == [
        ("other", "no")
    ]


@pytest.mark.parametrize(
    "change, expected",
    [
        (("max: 5", "max: 5"), "none"),
        (("kind: telemetry\n", "kind: telemetry\n    summary: Words.\n"), "patch"),
        (
            ("{value: 1, name: Run}", "{value: 1, name: Run}, {value: 2, name: Safe}"),
            "minor",
        ),
        (("name: Level", "name: Power Level"), "major"),
        (("raw*0.5", "raw*0.25"), "major"),
        (("id: 10", "id: 11"), "major"),
    ],
)
def test_the_step_of_the_version_and_its_reason(tmp_path, change, expected):
    comparison = compared(tmp_path, BASE, BASE.replace(*change))
    version_step = step(comparison.changes)
    assert version_step.step == expected and version_step.reason
    assert set(version_step.deciding) <= {change.code for change in comparison.changes}
    assert bool(version_step.deciding) == (expected != "none")


FRAMED = (
    BASE
    + """\
protocol:
  link:
    framing: {by: length}
    header:
      - {at: 0, bits: 8, role: sync, value: {telecommand: 0x55, telemetry: 0x56}}
      - {at: 8, bits: 16, role: length}
      - {at: 24, bits: 8, role: id}
    trailer: [{at: 0, bits: 8, role: checksum, checksum: sum, covers: {from: length, to: data}}]
    commands: {ack: Status}
    checksums:
      sum: {kind: sum, width: 8, init: 0}
"""
)


@pytest.mark.parametrize(
    "change, telemetry, telecommands",
    [
        (("telemetry: 0x56", "telemetry: 0x57"), "no", "yes"),
        (("telecommand: 0x55", "telecommand: 0x54"), "yes", "no"),
        (("width: 8, init: 0}", "width: 8, init: 1}"), "no", "no"),
        (("from: length", "from: id"), "no", "no"),
        (
            ("bits: 16, role: length", "bits: 16, role: length, byte_order: big"),
            "no",
            "no",
        ),
        (
            ("bits: 16, role: length", "bits: 16, role: length, byte_order: little"),
            "yes",
            "yes",
        ),
        (("    commands: {ack: Status}\n", ""), "yes", "yes"),
    ],
)
def test_another_packet_format_is_incompatible(
    tmp_path, change, telemetry, telecommands
):
    got = answers(tmp_path, change, FRAMED)
    assert (got["telemetry"].verdict, got["telecommands"].verdict) == (
        telemetry,
        telecommands,
    )


def test_other_escape_characters_are_incompatible(tmp_path):
    escaped = "framing: {by: escape, escape: 0x10, start: 0x02, end: 0x03}"
    base = FRAMED.replace("framing: {by: length}", escaped)
    got = answers(tmp_path, ("end: 0x03", "end: 0x04"), base)
    assert (got["telemetry"].verdict, got["telecommands"].verdict) == ("no", "no")


def test_stating_the_default_byte_order_breaks_nothing(tmp_path):
    new = FRAMED.replace(
        "bits: 16, role: length", "bits: 16, role: length, byte_order: little"
    )
    assert [change.code for change in compared(tmp_path, FRAMED, new).changes] == [
        "DIF413"
    ]


A, B, C = (
    f"{{at: {at}, bits: 8, name: {name}, type: uint}}"
    for at, name in ((0, "Alpha"), (8, "Beta"), (16, "Gamma"))
)
KIND = A.replace("Alpha", "Kind")


def const(field: str, value: int) -> str:
    return field.replace("}", f", const: {value}}}")


def when(value: int) -> str:
    return f"{KIND}, " + B.replace("}", f", when: {{Kind: {value}}}}}")


def rest(begin: int, most: int) -> str:
    return f"{A}, {{at: {8 * begin}, bits: 8, name: Rows, type: uint, count: rest, up_to: {most}}}"


def points(last: int) -> str:
    return A.replace(
        "}", f", unit: V, points: [[0, 0], [255, {last}]], outside: refuse}}"
    )


VIEW = "{at: 0, bits: 4, name: Low, type: uint, view: true}"
# Kind, length and fields of the old and of the new message; verdict and reason
FRAMES = {
    "Free Zero": ("telecommand", 3, A, f"{A}, {const(C, 0)}", "partly", "sent as 0: `Gamma`"),
    "Free": ("telecommand", 3, A, f"{A}, {const(C, 7)}", "no", "sent as 0, must be 7: `Gamma`"),
    "Any": ("telecommand", 1, A, const(A, 5), "partly", "must be 5, sent as anything: `Alpha`"),
    "Other": ("telecommand", 1, const(A, 0), const(A, 5), "no", "must be 5, sent as 0: `Alpha`"),
    "Gone": ("telecommand", 3, f"{A}, {B}, {C}", A, "partly", "ignored: `Beta` and `Gamma`"),
    "View": ("telecommand", 1, f"{A}, {VIEW}", A, "yes", ""),
    "When": ("telemetry", 2, when(1), when(2), "partly", "there in other messages: `Beta`"),
    "Table": ("telemetry", 1, points(5), points(9), "no", "another formula: `Alpha`"),
    "Same Table": ("telemetry", 1, points(5), points(5).replace("}", ", summary: S}"), "yes", ""),
    "Lost": ("telemetry", 4, A, f"{B}, {C}", "no", "not carried: `Alpha`"),
    "Longer": ("telemetry", 1, rest(1, 2), rest(1, 4), "partly",
               "1 to 5 bytes come, 1 to 3 bytes are expected"),
    "Shorter": ("telemetry", 1, rest(1, 4), rest(1, 2), "yes", ""),
    "Apart": ("telemetry", (1, 5), rest(1, 2), rest(5, 2), "no",
              "5 to 7 bytes come, 1 to 3 bytes are expected"),
}  # fmt: skip


def test_another_log_mask_concerns_logs_only(tmp_path):
    base = BASE + "protocol: {log_mask: {bytes: 1, frame_bytes: 2}}\n"
    got = answers(tmp_path, ("{bytes: 1", "{bytes: 2"), base)
    assert {key: direction.general for key, direction in got.items()} == {
        "telemetry": (),
        "telecommands": (),
        "logs": ("`protocol.log_mask.bytes` is 2, was 1",),
    }
    assert [direction.verdict for direction in got.values()] == ["yes", "yes", "partly"]


@pytest.fixture(scope="module")
def frames(tmp_path_factory) -> dict[str, tuple[str, tuple[str, ...]]]:
    """Return verdict and reasons of each frame that is not fully compatible."""
    old, new = (
        "messages:\n"
        + "".join(
            f"  - {{name: {name}, id: {id}, kind: {kind}, fields: [{fields[side]}], "
            f"length: {length if isinstance(length, int) else length[side]}}}\n"
            for id, (name, (kind, length, *fields)) in enumerate(FRAMES.items(), 1)
        )
        for side in (0, 1)
    )
    telemetry, telecommands, _ = directions(
        compared(tmp_path_factory.mktemp("frames"), old, new)
    )
    assert (telemetry.total, telecommands.total) == (7, 6)
    return {
        frame.message: (frame.verdict, frame.reasons)
        for direction in (telemetry, telecommands)
        for frame in direction.worst_first
    }


@pytest.mark.parametrize("name", FRAMES)
def test_a_frame_has_its_verdict_and_reason(frames, name):
    *_, verdict, reason = FRAMES[name]
    assert frames.get(name, ("yes", ("",))) == (verdict, (reason,))


def test_frames_that_are_not_compatible_come_first(frames):
    verdicts = [verdict for verdict, _ in frames.values()]
    assert verdicts == ["no"] * 3 + ["partly"] * 2 + ["no"] * 2 + ["partly"] * 3
