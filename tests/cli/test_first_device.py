"""``icdgen init``: from an empty folder to a device that answers."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import tomllib

import jsonschema
import pytest
import yaml

from icdgen.loading import load
from icdgen.recognize import recognize
from tests.conftest import ROOT
from tests.sim.device import simulator


@pytest.mark.parametrize("link", ["uart", "framed"])
def test_the_first_icd_is_clean_formatted_and_generates_every_language(
    icdgen, tmp_path, link
):
    result = icdgen("init", "battery", "--link", link)
    assert result.status == 0 and "icd/battery.yaml written" in result.out
    checked = icdgen("check")
    assert checked.status == 0 and "no findings" in checked.out, checked.out
    assert icdgen("fmt", "--check").status == 0
    assert (
        icdgen(
            *"--lang c --lang python --lang rust --lang vectors --lang html".split()
        ).status
        == 0
    )
    assert (tmp_path / "generated" / "c" / "battery.h").is_file()


def test_placeholders_are_not_generated(icdgen, tmp_path):
    icdgen("init", "battery")
    icdgen(*"--lang c --lang python --lang rust --lang html".split())
    node = json.loads(icdgen("show", "--format", "json").out)["nodes"][0]
    assert not node.get("summary") and not node.get("source")
    for path in (tmp_path / "generated").rglob("*.*"):
        assert b"Name of the manual" not in path.read_bytes(), path


@pytest.mark.parametrize(
    "arguments",
    [
        ("decode", "cubeacp", "146", "2efb0a000000"),
        ("show", "cubeacp"),
        ("encode", "cubeacp", "Set Wheel Speed", "x=1"),
        ("sim", "--node", "CubeACP"),
    ],
)
def test_a_shipped_node_is_reported_as_outside_the_project_with_its_option(
    icdgen, arguments
):
    icdgen("init", "battery")
    result = icdgen(*arguments)
    assert result.status == 2 and "icdgen.toml does not name it" in result.err, result
    folder = re.search(r"give `--icd (.*?)`", result.err)[1]
    if arguments[0] == "decode":
        assert "-12.34" in icdgen(*arguments, "--icd", folder).out
    assert "comes with" not in icdgen("show", "batery").err


@pytest.mark.pty
def test_the_first_device_answers_in_the_simulator(icdgen, tmp_path):
    icdgen("init", "battery")
    simulator = subprocess.Popen(
        [sys.executable, "-m", "icdgen", "sim"],
        cwd=tmp_path,
        stdout=subprocess.PIPE,
        text=True,
        env=os.environ,
    )
    try:
        path = simulator.stdout.readline().split()[-1]
        port = path.removeprefix("pty:")
        result = icdgen("monitor", "battery", "Status", "--port", port, "--once")
        assert result.status == 0 and "Temperature" in result.out, result
    finally:
        simulator.terminate()
        simulator.wait()
        simulator.stdout.close()


def test_a_first_device_with_frames_accepts_refuses_and_answers(icdgen, tmp_path):
    icdgen("init", "pump", "--link", "framed")
    with simulator("--tcp", "0", "--strict", "--icd", str(tmp_path / "icd")) as (
        place,
        _,
    ):
        outcomes = {
            words: icdgen("send", *words, "--port", place)
            for words in (
                ("Set Mode", "mode=Normal"),
                ("Set Mode", "mode=9", "--raw"),
                ("Get Identification",),
                ("Reset", "--yes"),
            )
        }
        shown = icdgen("monitor", "--port", place, "--once")
    results = [
        (each.status, (each.out or each.err).splitlines()[0])
        for each in outcomes.values()
    ]
    assert results == [
        (0, "Set Mode: acknowledged with Ack"),
        (1, "Set Mode: refused: Out of range (code 3)"),
        (0, "Get Identification: answered with Identification"),
        (
            0,
            "Reset with Magic number 90 (0x5A): sent; the ICD describes no response to it",
        ),
    ]
    assert shown.status == 0 and "Temperature" in shown.out


def test_the_link_of_a_first_device_is_named_or_copied(icdgen, tmp_path):
    result = icdgen("init", "pump", "--link", "framed", "--from", "cubeacp")
    assert result.status == 2 and "leave out one of the two" in result.err
    assert list(tmp_path.iterdir()) == []


def test_frames_of_a_first_device_are_recognised(icdgen, tmp_path):
    icdgen("init", "battery")
    from icdgen.loading import load

    (decoded,) = recognize(
        load([tmp_path / "icd"]).icd, "10 02 81 01 03 10 10 27 88 13 10 03"
    )
    assert [row.text for row in decoded.frame.rows] == [
        "Normal",
        "true",
        "true",
        "100",
        "5000",
    ]


def test_existing_files_stay_unchanged(icdgen, tmp_path):
    (tmp_path / "icdgen.toml").write_text("# mine\n")
    icdgen("init", "battery")
    (tmp_path / "icd" / "battery.yaml").write_text("mine\n")
    result = icdgen("init", "battery")
    assert result.status == 2 and "already exists" in result.err
    assert (tmp_path / "icd" / "battery.yaml").read_text() == "mine\n"
    assert (tmp_path / "icdgen.toml").read_text() == "# mine\n"


@pytest.mark.parametrize(
    ("name", "proposal"),
    [("My Battery", "my_battery"), ("3cell", "cell"), ("../x", "x"), ("", "battery")],
)
def test_an_invalid_node_name_gets_a_valid_suggestion(icdgen, tmp_path, name, proposal):
    result = icdgen("init", name)
    assert result.status == 2 and f"icdgen init {proposal}`" in result.err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("word", "answer"),
    [
        ("chekc", "did you mean `check`?"),
        ("Check", "did you mean `check`?"),
        ("quux", "`icdgen --help` lists the commands"),
    ],
)
def test_a_mistyped_command_gets_a_suggestion(icdgen, word, answer):
    result = icdgen(word)
    assert (
        result.status == 2
        and f"`{word}` is neither a command nor a file" in result.err
        and answer in result.err
    )


def test_a_folder_named_like_a_mistyped_command_is_still_an_icd(icdgen, tmp_path):
    (tmp_path / "chek").mkdir()
    assert "neither a command" not in icdgen("chek", "--lang", "c").err


def test_units_are_listed_with_the_spellings_they_replace(icdgen):
    lines = icdgen("units").out.splitlines()
    assert any(line.split()[0] == "C" and "degC" in line for line in lines)


BIG = """\
icdgen: 1
node: {name: relay, title: Relay, byte_order: big, bit_order: msb0}
units: [{symbol: clicks, identifier: clicks, quantity: count}]
protocol:
  link:
    ids:
      direction_bit: 5
      telecommand: {direction: 0, first: 10, last: 20}
      telemetry: {direction: 1, first: 32, last: 40}
  identification: {source: {table: 3}, message: Identification, fields: {node_type: Model, interface_version: Clicks}}
  boot: {bootloader_s: 5, stop_request: Identification}
enums:
  - name: Mode
    members: [{value: 0, name: Safe}, {value: 1, name: Normal}, {value: 2, name: Test}]
messages:
  - name: Identification
    id: 32
    kind: telemetry
    length: 2
    fields:
      - {at: 0, bits: 8, name: Model,  type: uint, const: 0x1F}
      - {at: 8, bits: 8, name: Clicks, type: uint, unit: clicks}
  - name: Set Mode
    id: 10
    kind: telecommand
    length: 1
    fields:
      - {at: 0, bits: 8, name: Mode, type: enum, enum: Mode}
"""


@pytest.mark.parametrize("origin", ["cubeacp", "bootloader", "common"])
def test_a_device_in_the_style_of_another_is_clean_and_formatted(
    icdgen, tmp_path, origin
):
    result = icdgen("init", "pump", "--from", origin)
    assert result.status == 0, result.err
    checked = icdgen("check")
    assert checked.status == 0 and "no findings" in checked.out, checked.out
    assert icdgen("fmt", "--check").status == 0
    text = (tmp_path / "icd" / "pump.yaml").read_text()
    assert (
        f"# how messages travel, as {origin} has it" in text
        and "# `at`: offset in bits" in text
    )
    assert "escape: 0x1F" in text and "CAN" not in text.partition("messages:")[2]
    assert (
        "table:" not in text.partition("protocol:")[2]
        and "No time is given" not in text
    )
    assert icdgen(*"--lang c --lang python --lang rust".split()).status == 0


def test_orders_ids_units_and_names_follow_the_style(icdgen, tmp_path):
    (tmp_path / "relay.yaml").write_text(BIG)
    assert icdgen("init", "pump", "--from", "relay", "--icd", "relay.yaml").status == 0
    assert "no findings" in icdgen("check").out
    shown = json.loads(icdgen("show", "--format", "json").out)["nodes"][0]
    assert (shown["byte_order"], shown["bit_order"]) == ("big", "msb0")
    ids = {m["name"]: m.get("id") for m in shown["messages"]}
    assert ids == {
        "Identification": 32,
        "Status": 33,
        "Set Mode": 10,
        "Reset": 11,
        "Limits": None,
    }
    text = (tmp_path / "icd" / "pump.yaml").read_text()
    assert "0x1F" in text and "clicks" in text
    assert "boot" not in text


def test_an_icd_of_the_user_can_be_the_style(icdgen, tmp_path):
    assert icdgen("init", "battery").status == 0
    assert icdgen("init", "pump", "--from", "battery").status == 0
    assert "no findings" in icdgen("check").out
    assert icdgen("decode", "pump", "10 02 81 01 03 10 10 27 88 13 10 03").status == 0
    # A shipped device can be the style too.
    assert icdgen("init", "valve", "--from", "cubeacp").status == 0


@pytest.mark.parametrize(
    ("origin", "answer"),
    [
        ("cubemag", "does not say how its messages travel"),
        ("cubeapc", "did you mean `cubeacp`"),
        ("", "there is no node"),
    ],
)
def test_an_unknown_style_is_reported_and_nothing_is_written(
    icdgen, tmp_path, origin, answer
):
    result = icdgen("init", "pump", "--from", origin)
    assert result.status == 2 and answer in result.err
    assert list(tmp_path.iterdir()) == []


def test_a_missing_icd_argument_lists_the_available_nodes(icdgen, tmp_path):
    (tmp_path / "icd").mkdir()
    (tmp_path / "icd" / "battery.yaml").write_text(BIG)
    result = icdgen("show", "battery")
    assert result.status == 2
    assert (
        "cubewheel, which come with icdgen; name yours with --icd, or in icdgen.toml"
        in result.err
    )


@pytest.mark.parametrize(
    "file",
    sorted((ROOT / "examples" / "links").glob("*.yaml")),
    ids=lambda file: file.stem,
)
def test_a_device_in_the_style_of_one_with_a_framed_link_has_one(
    icdgen, tmp_path, file
):
    origin = load([file]).icd.nodes[0]
    result = icdgen("init", "pump", "--from", origin.name, "--icd", file)
    assert result.status == 0, result.err
    checked = icdgen("check")
    assert checked.status == 0 and "no findings" in checked.out, checked.out
    pump = load([tmp_path / "icd" / "pump.yaml"]).icd.nodes[0]
    assert pump.protocol["link"].keys() == origin.protocol["link"].keys() - {"commands"}
    ours, theirs = pump.protocol["link"], origin.protocol["link"]
    assert ours.get("header") == theirs.get("header")
    packets = ours.get("packets", {})
    assert packets.items() <= theirs.get("packets", {}).items()
    assert bool(packets) == ("packets" in theirs)
    has_responses = "commands" in origin.protocol["link"]
    assert ("`commands` is not copied" in result.out) == has_responses


def test_editors_find_the_schema_that_is_written_beside_the_first_device(
    icdgen, tmp_path
):
    icdgen("init", "battery")
    schema = icdgen("schema").out
    for name in ("icd/battery.yaml", "icd/errata/battery.yaml"):
        path = tmp_path / name
        named = re.match(r"# yaml-language-server: \$schema=(\S+)\n", path.read_text())[
            1
        ]
        assert (path.parent / named).read_text() == schema
        jsonschema.validate(yaml.safe_load(path.read_text()), json.loads(schema))
    wrong = yaml.safe_load((tmp_path / "icd" / "battery.yaml").read_text()) | {
        "mesages": []
    }
    assert not jsonschema.Draft202012Validator(json.loads(schema)).is_valid(wrong)


def test_init_keeps_the_copy_of_the_schema_and_schema_updates_it(icdgen, tmp_path):
    icdgen("init", "battery")
    copy = tmp_path / "icd" / "icdgen.schema.json"
    copy.write_text("{}")
    assert (
        "icdgen.schema.json" not in icdgen("init", "pump").out
        and copy.read_text() == "{}"
    )
    assert (
        icdgen("schema", "--out", "icd/icdgen.schema.json").out
        == "icd/icdgen.schema.json written\n"
    )
    assert copy.read_text() == icdgen("schema").out


@pytest.mark.parametrize(
    ("name", "package"),
    [("battery", "battery"), ("match", "match_icd"), ("json", "json_icd")],
)
def test_the_packages_of_a_first_device_are_called_like_it(
    icdgen, tmp_path, name, package
):
    icdgen("init", name)
    # No Rust module can have that name.
    assert icdgen("check").err == "" or name == "match"
    config = tomllib.loads((tmp_path / "icdgen.toml").read_text())
    assert (config["name"], config["python"]["package"], config["rust"]["crate"]) == (
        name,
        package,
        package,
    )
