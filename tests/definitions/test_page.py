"""The pages about definitions: each file gives the output shown, from the definition to
a running program.
"""

from __future__ import annotations

import re
import subprocess
import sys

import pytest

from icdgen.definitions import kinds, run
from icdgen.icd.fmt import emit
from icdgen.loading import load
from tests import documents

PAGE = "".join(documents.text(f"guides/import-{name}") for name in documents.IMPORTS)


def blocks(language: str) -> list[str]:
    return documents.blocks(PAGE, language)


def ends_as_shown(icd: str, number: int) -> bool:
    """Return whether an ICD ends with the YAML block of this number."""
    return bool(re.search(documents.layout(blocks("yaml")[number]) + r"\Z", icd))


@pytest.mark.needs("cc")
def test_the_example_goes_from_a_database_to_a_program_as_printed(tmp_path):
    (tmp_path / "train.dbc").write_text(blocks("dbc")[0])
    for name, program in zip(("main.c", "send.c"), blocks("c"), strict=False):
        (tmp_path / name).write_text(program)
    sessions = blocks("console")
    for session in sessions[:3]:
        expected = [line for line in session.splitlines() if not line.startswith("$ ")]
        output = []
        for command in re.findall(r"^\$ (.*)$", session, re.MULTILINE):
            line = (
                command.replace("icdgen ", f"{sys.executable} -m icdgen ", 1)
                if command.startswith("icdgen")
                else command
            )
            run = subprocess.run(
                line, shell=True, cwd=tmp_path, capture_output=True, text=True
            )
            assert run.returncode == 0, run.stdout + run.stderr
            output += (
                run.stdout.splitlines()
                if not command.startswith("icdgen --lang")
                else []
            )
        assert output == expected
    written = (tmp_path / "icd" / "train.yaml").read_text()
    assert re.fullmatch(documents.layout(blocks("yaml")[0]), written)

    (tmp_path / "icd" / "errata").mkdir()
    (tmp_path / "icd" / "errata" / "train.yaml").write_text(blocks("yaml")[1])
    loaded = load([tmp_path / "icd"])
    assert loaded.findings == [] and [
        message.kind for message in loaded.icd.nodes[0].messages
    ] == ["telecommand"]


@pytest.mark.needs("cargo")
def test_the_program_in_rust_prints_what_the_page_shows(tmp_path):
    (tmp_path / "train.dbc").write_text(blocks("dbc")[0])
    app = tmp_path / "app"
    (app / "src").mkdir(parents=True)
    head = '[package]\nname = "app"\nversion = "0.1.0"\nedition = "2021"\n\n'
    (app / "Cargo.toml").write_text(head + blocks("toml")[0])
    (app / "src" / "main.rs").write_text(blocks("rust")[0])
    for command in ("import train.dbc --out icd", "--lang rust --out train-code icd"):
        subprocess.run(
            [sys.executable, "-m", "icdgen", *command.split()],
            cwd=tmp_path,
            check=True,
            capture_output=True,
        )
    run = subprocess.run(
        ["cargo", "run", "-q", "--offline"], cwd=app, capture_output=True, text=True
    )
    assert (run.stdout, run.returncode) == (blocks("text")[0], 0), run.stderr


def test_the_space_packet_becomes_what_the_page_shows(tmp_path):
    (tmp_path / "probe.xml").write_text(blocks("xml")[0])
    read = run.read(tmp_path / "probe.xml", kinds.reader_of_kind("xtce"))
    (tree,) = read.trees.values()
    assert ends_as_shown(emit.canonical_yaml({"messages": tree["messages"]}), 2)


def test_the_format_of_kaitai_becomes_what_the_page_shows(tmp_path):
    (tmp_path / "beacon.ksy").write_text(blocks("ksy")[0])
    read = run.read(
        tmp_path / "beacon.ksy", kinds.reader_of_file(tmp_path / "beacon.ksy")
    )
    (tree,) = read.trees.values()
    assert ends_as_shown(emit.canonical_yaml({"messages": tree["messages"]}), 3)
    assert read.definitions.import_findings == []


def test_the_model_of_sunspec_becomes_what_the_page_shows(tmp_path):
    (tmp_path / "meter.json").write_text(blocks("json")[0])
    read = run.read(
        tmp_path / "meter.json", kinds.reader_of_file(tmp_path / "meter.json")
    )
    (tree,) = read.trees.values()
    assert ends_as_shown(emit.canonical_yaml({"messages": tree["messages"]}), 4)


@pytest.mark.needs("cc")
def test_the_electronic_data_sheet_goes_from_its_files_to_a_program_as_printed(
    tmp_path,
):
    for name, text in zip(
        ("link.xml", "mission.xml", "heater.xml"), blocks("xml")[1:], strict=True
    ):
        (tmp_path / name).write_text(text)
    read = run.read(
        tmp_path / "heater.xml", kinds.reader_of_file(tmp_path / "heater.xml")
    )
    (tree,) = read.trees.values()
    text_of_tree = emit.canonical_yaml(
        {key: tree[key] for key in ("structs", "messages")}
    )
    assert read.definitions.import_findings == [] and text_of_tree.endswith(
        blocks("yaml")[5]
    )
    (tmp_path / "heater.yaml").write_text(emit.canonical_yaml(tree))
    (tmp_path / "main.c").write_text(blocks("c")[2])
    generated = f"{sys.executable} -m icdgen --lang c --out include heater.yaml"
    for command in (
        generated,
        "cc -std=c99 -Wall -Werror -Iinclude main.c -o main",
        "./main",
    ):
        result = subprocess.run(
            command, shell=True, cwd=tmp_path, capture_output=True, text=True
        )
        assert result.returncode == 0, result.stdout + result.stderr
    assert result.stdout == blocks("text")[1]
