"""Files of ``icdgen init``: names, and what is never replaced."""

from __future__ import annotations

import tomllib

import pytest

from icdgen import config
from icdgen.errors import UserError
from icdgen.icd import schema, source
from icdgen.icd.fmt import read, scalars
from icdgen.starter import TEMPLATES, _package, write
from icdgen.starter.style import Style, _lengthen, _renumber, in_style
from tests.limits import assert_limits


def names(paths) -> list[str]:
    return [path.as_posix() for path in paths]


@pytest.mark.parametrize("link", TEMPLATES)
def test_the_first_files_have_the_name_and_the_title_of_the_device(tmp_path, link):
    written = write(tmp_path, "star_tracker", link=link)
    assert names(written) == [
        "icd/star_tracker.yaml",
        "icd/errata/star_tracker.yaml",
        config.NAME,
        f"icd/{schema.COPY}",
    ]
    texts = [(tmp_path / path).read_text("utf-8") for path in written]
    assert not any("{{" in text for text in texts[:3])
    assert "  name: star_tracker\n  title: Star tracker\n" in texts[0]
    assert "node: star_tracker\n" in texts[1]
    assert tomllib.loads(texts[2]) == {
        "name": "star_tracker",
        "icds": ["icd"],
        "out": "generated",
        "python": {"package": "star_tracker"},
        "rust": {"crate": "star_tracker"},
        "c": {},
    }
    assert "import star_tracker.star_tracker`" in texts[2]
    assert texts[3] == schema.PATH.read_text("utf-8")
    # A second device shares schema and configuration.
    (tmp_path / config.NAME).write_text("kept")
    (tmp_path / "icd" / schema.COPY).write_text("kept")
    assert names(write(tmp_path, "radio", link=link)) == [
        "icd/radio.yaml",
        "icd/errata/radio.yaml",
    ]
    assert (tmp_path / config.NAME).read_text() == "kept"


@pytest.mark.parametrize("name", ["icd/battery.yaml", "icd/errata/battery.yaml"])
def test_an_existing_file_is_never_replaced(tmp_path, name):
    (tmp_path / name).parent.mkdir(parents=True)
    (tmp_path / name).symlink_to(tmp_path / "nowhere")
    with pytest.raises(UserError) as error:
        write(tmp_path, "battery")
    assert str(error.value) == f"{name} already exists"
    assert error.value.help == "take another name, or move the file away"
    assert not (tmp_path / config.NAME).exists()


@pytest.mark.parametrize(
    ("name", "proposal"),
    [
        ("Star Tracker", "star_tracker"),
        ("2nd-Radio!", "nd_radio"),
        ("_9_x_", "x"),
        ("Größe", "grosse"),
        ("", "battery"),
        ("123", "battery"),
        ("a" * 65, "a" * 64),
        ("battery\n", "battery"),
    ],
)
def test_a_name_that_is_no_node_is_refused_with_a_proposal(tmp_path, name, proposal):
    with pytest.raises(UserError) as error:
        write(tmp_path, name)
    assert error.value.help == f"for instance `icdgen init {proposal}`"
    assert str(error.value).startswith(f"`{name}` cannot name a node: ")
    assert not list(tmp_path.iterdir())


def test_the_name_of_a_node_has_64_characters_at_most(tmp_path):
    def is_accepted(size: int) -> bool:
        try:
            return bool(write(tmp_path / str(size), "a" * size))
        except UserError:
            return False

    assert_limits(is_accepted, most=64)


def test_a_package_has_another_name_where_a_language_reserves_it():
    names = ["battery", "class", "json", "std", "crate", "icdgen"]
    assert [_package(name) for name in names] == [
        "battery",
        *(f"{name}_icd" for name in names[1:]),
    ]
    assert_limits(lambda size: _package("a" * size) == "a" * size, most=40)
    assert _package("a" * 41) == "a" * 36 + "_icd"


def style_with(**values) -> Style:
    parts = {"node": {}, "protocol": {}, "units": [], "enums": [], "messages": []}
    return Style(**(parts | values), lacks_responses=False)


def messages_of(text: str):
    root = read.read_commented(text, source.parse(text.encode(), "demo.yaml"))
    return root.children[0].value.children


def entries(message) -> dict[str, object]:
    return {
        scalars.name(child.key): child.value.value for child in message.value.children
    }


MESSAGES = """\
messages:
  - {name: A, id: 3, kind: telecommand, length: 0}
  - {name: B, id: 3, kind: telecommand, length: 1}
  - {name: C, id: 3, kind: telemetry, length: 4}
  - {name: D, set_id: 12, get_id: 40, kind: configuration, length: 5}
  - {name: E, id: 200, kind: telemetry, length: 8}
"""


def test_ids_that_are_taken_or_out_of_range_are_replaced_by_the_first_free_ones():
    """Those of telecommands and of telemetry are independent."""
    ids = {
        "telecommand": {"first": 3, "last": 12},
        "telemetry": {"first": 3, "last": 99},
    }
    framing = {"by": "escape", "escape": 4, "end": 5, "data": 6}
    copied = [
        {"name": "Y", "kind": "telecommand", "id": 7},
        {"name": "Z", "kind": "configuration", "set_id": 12, "get_id": 3},
    ]
    style = style_with(
        protocol={"link": {"ids": ids, "framing": framing}}, messages=copied
    )
    messages = messages_of(MESSAGES)
    _renumber(messages, style)
    shown = [
        {key: value for key, value in entries(message).items() if key.endswith("id")}
        for message in messages
    ]
    assert shown == [
        {"id": 3},
        {"id": 8},
        {"id": 7},
        {"set_id": 9, "get_id": 40},
        {"id": 8},
    ]


@pytest.mark.parametrize(
    ("unit", "lengths"),
    [
        (1, [(0, None), (1, None), (4, None), (5, None), (8, None)]),
        (4, [(0, None), (4, 3), (4, None), (8, 3), (8, None)]),
    ],
)
def test_lengths_are_multiples_of_the_unit_of_the_link(unit, lengths):
    """The greatest unit counts if lengths are sent in several."""
    rows = [{"bits": 8, "role": "length"}, {"bits": 8, "role": "length", "unit": unit}]
    link = {"framing": {"by": "length"}, "header": rows}
    messages = messages_of(MESSAGES)
    _lengthen(messages, style_with(protocol={"link": link}))
    shown = [entries(message) for message in messages]
    assert [(each["length"], each.get("reserved")) for each in shown] == lengths
    keys = list(shown[1])
    assert unit == 1 or keys[keys.index("length") + 1] == "reserved"


TEXT = """\
# about the file
icdgen: 1
node: {name: demo, title: Demo, byte_order: little, bit_order: lsb0}
protocol:
  link: {framing: {by: cobs}}
enums:
  - {name: Error, members: [{value: 0, name: None}]}
  - {name: Mode, members: [{value: 0, name: Safe}]}
  - {name: Own, members: [{value: 0, name: One}]}
messages:
  - {name: State, id: 1, kind: telemetry, length: 0}  # kept
  - {name: Stop, id: 2, kind: telecommand, length: 0}
"""


def test_a_style_replaces_the_link_and_items_of_the_same_name():
    style = style_with(
        node={"byte_order": "big", "id_bits": 16},
        protocol={"link": {"framing": {"by": "slip"}}},
        units=[{"symbol": "clicks", "identifier": "clicks", "quantity": "count"}],
        enums=[
            {"name": "Mode", "members": [{"value": 5, "name": "Run"}]},
            {"name": "State", "members": [{"value": 0, "name": "On"}]},
            {
                "name": "Stop",
                "identifier": "Halt",
                "members": [{"value": 0, "name": "On"}],
            },
        ],
        messages=[{"name": "Stop", "id": 9, "kind": "telecommand", "length": 3}],
    )
    text = in_style(TEXT, style, "wheel")
    tree = source.parse(text.encode(), "demo.yaml")
    assert tree["node"] == {
        "name": "demo",
        "title": "Demo",
        "byte_order": "big",
        "bit_order": "lsb0",
        "id_bits": 16,
    }
    assert tree["protocol"] == style.protocol
    assert [(enum["name"], enum.get("identifier")) for enum in tree["enums"]] == [
        ("Mode", None),
        ("State", "Link State"),
        ("Stop", "Halt"),
        ("Own", None),
    ]
    assert tree["enums"][0]["members"] == [{"value": 5, "name": "Run"}]
    assert [(each["name"], each["id"]) for each in tree["messages"]] == [
        ("Stop", 9),
        ("State", 1),
    ]
    assert tree["units"] == style.units
    for comment in (
        "# about the file",
        "# kept",
        "# how messages travel, as wheel has it",
    ):
        assert comment in text
    assert "units" not in source.parse(
        in_style(TEXT, style_with(protocol=style.protocol), "wheel").encode(),
        "demo.yaml",
    )
