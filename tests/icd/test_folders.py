"""The search for ICDs in a folder."""

from __future__ import annotations

import os

import pytest

from icdgen.icd import folders, source
from icdgen.loading import load
from tests.conftest import ROOT
from tests.limits import assert_limits

ICD = (
    "icdgen: 1\nnode: {{name: {0}, title: {0}, byte_order: little, bit_order: lsb0}}\n"
)


def write(folder, *names, text=None):
    for name in names:
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text or ICD.format(path.stem))


def nodes(folder):
    loaded = load([folder])
    assert [finding.message for finding in loaded.findings] == []
    return [node.name for node in loaded.icd.nodes]


def test_icds_in_folders_below_are_found(tmp_path):
    write(tmp_path, "icd/battery.yaml", "icd/deep/down/pump.yaml", "top.yaml")
    assert nodes(tmp_path) == ["top", "battery", "pump"]


def test_a_part_that_is_included_is_read_once_and_belongs_to_its_node(tmp_path):
    write(tmp_path, "icd/parts/common.yaml")
    write(
        tmp_path,
        "icd/battery.yaml",
        text=ICD.format("battery") + "include: [parts/common.yaml]\n",
    )
    assert nodes(tmp_path) == ["common", "battery"]


def test_errata_profiles_and_yaml_of_other_tools_are_no_icds(tmp_path):
    write(tmp_path, "icd/battery.yaml")
    write(
        tmp_path,
        "icd/errata/battery.yaml",
        "overlays/battery.yaml",
        text="errata: 1\nnode: battery\nnotes: []\n",
    )
    write(tmp_path, "icd/profiles/vendor.yaml", text="profile: 1\nnodes: []\n")
    write(tmp_path, "compose.yaml", "mkdocs.yaml", text="services: {}\nnode: {}\n")
    write(tmp_path, "deploy/play.yaml", text="- hosts: all\n  messages: []\n")
    assert nodes(tmp_path) == ["battery"]


def test_hidden_folders_output_and_environments_are_not_searched(tmp_path):
    write(tmp_path, "icd/battery.yaml", "environment/lib/one.yaml")
    (tmp_path / "environment" / "pyvenv.cfg").write_text("")
    for name in (
        ".git",
        "build",
        "generated",
        "node_modules",
        "site",
        "target",
        "dist",
    ):
        write(tmp_path, f"{name}/copy.yaml", f"{name}/deep/copy.yaml")
    write(tmp_path, ".hidden.yaml", text="a: 1\n")
    assert nodes(tmp_path) == ["battery"]
    # Named by the user.
    assert nodes(tmp_path / "generated" / "deep") == ["copy"]
    assert nodes(tmp_path / "environment") == ["one"]


def test_a_project_that_is_a_virtual_environment_itself_is_searched(tmp_path):
    write(tmp_path, "battery.yaml", "icd/pump.yaml", "lib/venv/copy.yaml")
    (tmp_path / "pyvenv.cfg").write_text("")
    assert nodes(tmp_path) == ["battery", "pump"]


@pytest.mark.parametrize("text", ["", "node: {name: a}\nmessages: []\n", "\x00\x01"])
def test_a_file_of_the_folder_that_is_meant_as_an_icd_is_reported(tmp_path, text):
    write(tmp_path, "battery.yaml")
    (tmp_path / "broken.yaml").write_text(text)
    assert [finding.place.file for finding in load([tmp_path]).findings][:1] == [
        str(tmp_path / "broken.yaml")
    ]


def test_the_error_for_a_folder_without_icds_explains_icds(tmp_path):
    (finding,) = load([tmp_path]).findings
    assert "no file *.yaml in it, or in a folder below" in finding.message
    write(tmp_path, "compose.yaml", text="services: {}\n")
    (finding,) = load([tmp_path]).findings
    assert "`compose.yaml`" in finding.message and "`icdgen: 1`" in finding.help


def test_links_to_folders_are_not_followed(tmp_path):
    write(tmp_path, "icd/battery.yaml")
    os.symlink(tmp_path, tmp_path / "icd" / "again")
    os.symlink(tmp_path, tmp_path / "icd" / "again.yaml")
    assert nodes(tmp_path) == ["battery"]


def test_a_search_of_too_many_folders_ends_with_a_finding(tmp_path, monkeypatch):
    monkeypatch.setattr(folders, "MOST_FOLDERS", 3)

    def is_complete(count):
        top = tmp_path / str(count)
        write(top, *(f"part{number}/battery.yaml" for number in range(1, count)))
        return folders.search(top).is_complete

    assert_limits(is_complete, most=3)
    finding, *_ = (
        finding
        for finding in load([tmp_path / "4"]).findings
        if finding.code == "ICD001"
    )
    assert "more than 3 folders" in finding.message


def test_a_new_file_invalidates_the_cached_search(tmp_path):
    write(tmp_path, "icd/battery.yaml", "icd/notes.yaml", text="a: 1\n")
    inputs = load([tmp_path]).inputs
    assert {
        tmp_path,
        tmp_path / "icd",
        tmp_path / "icd" / "notes.yaml",
    } <= inputs.keys()


def test_the_examples_of_devices_are_found():
    assert sorted(nodes(ROOT / "examples" / "devices")) == [
        "bme280",
        "mavlink",
        "p31u",
        "ublox",
    ]


def test_the_icds_of_a_project_are_those_in_its_folder_and_in_the_folder_icd(tmp_path):
    write(tmp_path, "battery.yaml", ".hidden.yaml", "other/wheel.yaml")
    write(tmp_path, "compose.yaml", "icd/notes.yaml", text="services: {}\n")
    assert folders.icds_of_project(tmp_path) == [tmp_path / "battery.yaml"]
    write(tmp_path, "icd/pumps/pump.yaml")
    assert folders.icds_of_project(tmp_path) == [
        tmp_path / "battery.yaml",
        tmp_path / "icd",
    ]
    assert folders.icds_of_project(tmp_path / "missing") == []


def test_a_file_that_is_too_large_is_reported_only_in_the_folder_itself(
    tmp_path, monkeypatch
):
    write(tmp_path, "battery.yaml", "deep/pump.yaml")
    monkeypatch.setattr(source, "MAX_BYTES", 10)
    result = folders.search(tmp_path)
    assert (result.icds, result.other_files) == (
        [tmp_path / "battery.yaml"],
        [tmp_path / "deep" / "pump.yaml"],
    )


def test_files_are_told_apart_by_their_keys(tmp_path):
    for name, text in {
        "a": "icdgen: 1\n",
        "b": '"icdgen": 1\n',
        "c": "{icdgen: 1}\n",
        "d": "'icdgen' : 1\n",
        "e": "errata: 1\n",
        "f": "messages: []\n",
        "g": "# empty\n",
        "h": "  icdgen: 1\nother: 2\n",
    }.items():
        (tmp_path / f"{name}.yaml").write_text(text)
    result = folders.search(tmp_path)
    names = ["".join(path.stem for path in paths) for paths in (result.icds, result.overlays, result.other_files)]  # fmt: skip
    assert names == ["abcdfg", "e", "h"]
