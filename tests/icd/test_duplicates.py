"""Names that occur twice in files that include each other: which file reports them, and
that it does so once.
"""

from __future__ import annotations

import pytest

from tests.icd.files import findings

NODE = "node: {{name: {}, title: Demo, byte_order: little, bit_order: lsb0}}\n"
ITEMS = {
    "ICD050": "messages: [{name: Same, id: 1, kind: telecommand, length: 0}]\n",
    "ICD052": "enums: [{name: Same, members: [{value: 0, name: A}]}]\n",
    "ICD058": "units: [{symbol: same, identifier: ticks, quantity: time}]\n",
}


def node(name: str, *include: str, item: str = "") -> str:
    files = ", ".join(f"{each}.yaml" for each in include)
    head = f"include: [{files}]\n" if include else ""
    return f"icdgen: 1\n{head}{NODE.format(name)}{item}"


def texts_of(folder, code: str, files: dict[str, str]) -> list[tuple[str, str]]:
    """Return the file and the end of the message of each finding with the code."""
    demo, *others = files
    text = files[demo] + "".join(f"# {name}.yaml\n{files[name]}" for name in others)
    return [
        (finding.place.file.rpartition("/")[2], finding.message.rpartition(", ")[2])
        for finding in findings(folder, text)
        if finding.code == code
    ]


@pytest.mark.parametrize("code", ITEMS)
def test_a_name_of_two_included_files_is_reported_where_they_meet(code, tmp_path):
    """Not again by the file that includes the file where they meet."""
    item = ITEMS[code]
    files = {
        "demo": node("demo", "middle"),
        "middle": node("middle", "one", "two"),
        "one": node("one", item=item),
        "two": node("two", item=item),
    }
    (text,) = texts_of(tmp_path, code, {**files, "demo": node("demo")})
    assert text[1] == "and `middle` includes both"
    assert texts_of(tmp_path, code, files) == [text]


@pytest.mark.parametrize("code", ITEMS)
def test_a_name_of_a_file_and_its_base_is_reported_in_the_file(code, tmp_path):
    """Once, although a third file includes both."""
    item = ITEMS[code]
    files = {
        "demo": node("demo", "device", "base"),
        "device": node("device", "base", item=item),
        "base": node("base", item=item),
    }
    ((file, end),) = texts_of(tmp_path, code, files)
    assert file == "device.yaml" and "includes both" not in end


@pytest.mark.parametrize("code", ITEMS)
def test_a_name_that_a_file_has_twice_is_reported_once(code, tmp_path):
    key, _, entry = ITEMS[code].strip().partition(": ")
    twice = f"{key}: [{entry[1:-1]}, {entry[1:-1]}]\n"
    files = {
        "demo": node("demo", "middle"),
        "middle": node("middle", "base"),
        "base": node("base", item=twice),
    }
    ((file, end),) = texts_of(tmp_path, code, files)
    assert file == "base.yaml" and "includes both" not in end


@pytest.mark.parametrize("code", ITEMS)
def test_files_that_do_not_include_each_other_can_use_the_same_name(code, tmp_path):
    files = {
        "demo": node("demo", item=ITEMS[code]),
        "other": node("other", item=ITEMS[code]),
    }
    assert texts_of(tmp_path, code, files) == []
