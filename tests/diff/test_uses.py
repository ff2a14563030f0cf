"""``--uses`` lists exactly the lines of a user's sources that use changed names."""

from __future__ import annotations

import json
import re

import pytest

from icdgen.diff.uses import _LEXERS, MARK, _in_file, _mentions, _sources, _tokens
from icdgen.errors import UserError

C = """\
#include "demo.h"
/* demo_set_roll_t in a comment, "roll_angle" in none */
static void f(const uint8_t *buffer) {
    demo_estimated_roll_t state;
    demo_estimated_roll_decode(&state, buffer, 3);
    printf("demo_estimated_roll_roll_angle_deg \\" roll_angle %f", demo_estimated_roll_roll_angle_deg(&state)); // roll_angle
    int16_t raw = state.roll_angle;
    send(DEMO_SET_ROLL_ID);
}
"""
PYTHON = '''\
"""Uses roll_angle_deg of EstimatedRoll."""
from icdgen_messages.demo import EstimatedRoll

state = EstimatedRoll.from_bytes(data)
print(state.roll_angle_deg)  # roll_angle
print(f"roll_angle {state.roll_angle:d} {{roll_angle}}")
other = r"roll_angle" + """
roll_angle
"""
'''
RUST = """\
use icd::demo::EstimatedRoll;
fn f(bytes: &[u8]) -> f64 {
    let state = EstimatedRoll::from_bytes(bytes).unwrap();
    state.roll_angle_deg() /* roll_angle */
}
"""


@pytest.fixture
def sources(tmp_path):
    folder = tmp_path / "src"
    (folder / "deep").mkdir(parents=True)
    (folder / "main.c").write_text(C)
    (folder / "deep" / "log.py").write_text(PYTHON)
    (folder / "lib.rs").write_text(RUST)
    return folder


def uses(icdgen, *arguments) -> list[tuple]:
    document = json.loads(
        icdgen(
            "diff", "old", "new", "--format", "json", "--uses", "src", *arguments
        ).out
    )
    changes = document["changes"]
    return [
        (
            use["file"],
            use["line"],
            use["name"],
            "/".join(sorted({changes[i]["code"] for i in use["changes"]})),
        )
        for use in document["uses"]
    ]


def test_every_line_that_uses_a_changed_name_is_listed(icdgen, releases, sources):
    assert uses(icdgen) == [
        ("src/lib.rs", 4, "roll_angle_deg", "DIF201"),
        ("src/main.c", 6, "demo_estimated_roll_roll_angle_deg", "DIF201"),
        ("src/main.c", 7, "roll_angle", "DIF201"),
        ("src/main.c", 8, "DEMO_SET_ROLL_ID", "DIF103"),
        ("src/deep/log.py", 5, "roll_angle_deg", "DIF201"),
        ("src/deep/log.py", 6, "roll_angle", "DIF201"),
    ]


def test_columns_point_at_the_name(icdgen, releases, sources):
    document = json.loads(
        icdgen("diff", "old", "new", "--format", "json", "--uses", "src").out
    )
    for use in document["uses"]:
        assert use["text"][use["column"] - 1 :].startswith(use["name"])


def test_the_text_report_shows_line_and_reason(icdgen, releases, sources):
    out = icdgen("diff", "old", "new", "--uses", "src").out
    assert (
        "src/main.c:7:25: roll_angle (DIF201)\n    int16_t raw = state.roll_angle;\n"
        in out
    )
    assert "raw*0.001, was raw*0.01" in out.split("uses in your sources")[1]


def test_a_member_name_is_ignored_in_a_file_without_its_type(icdgen, releases, sources):
    for name in ("main.c", "lib.rs", "deep/log.py"):
        (sources / name).unlink()
    (sources / "other.py").write_text(
        "class Plane:\n    roll_angle = 0\n    roll_angle_deg = 1\n"
    )
    (sources / "other.c").write_text("struct plane { int roll_angle; };\n")
    assert uses(icdgen) == []
    assert (
        "uses in your sources: none"
        in icdgen("diff", "old", "new", "--uses", "src").out
    )


def test_generated_code_is_not_searched(icdgen, releases, sources):
    for name in ("main.c", "lib.rs", "deep/log.py"):
        (sources / name).unlink()
    icdgen("--lang", "c", "--lang", "python", "--lang", "rust", "--out", "src", "old")
    assert uses(icdgen) == []


def test_a_renamed_field_is_found_by_its_old_name(icdgen, releases, sources):
    text = (
        (releases[0] / "demo.yaml")
        .read_text()
        .replace("name: Roll Angle, ", "name: Body Roll Angle, ", 1)
    )
    (releases[1] / "demo.yaml").write_text(text)
    places = uses(icdgen)
    assert ("src/main.c", 7, "roll_angle", "DIF302") in places and len(places) == 5


def test_a_renamed_message_is_found_with_all_its_functions(icdgen, releases, sources):
    text = (
        (releases[0] / "demo.yaml")
        .read_text()
        .replace("name: Estimated Roll\n", "name: Filtered Estimated Roll\n")
    )
    (releases[1] / "demo.yaml").write_text(text)
    names = {name for _, _, name, _ in uses(icdgen)}
    assert {
        "demo_estimated_roll_t",
        "demo_estimated_roll_decode",
        "demo_estimated_roll_roll_angle_deg",
        "EstimatedRoll",
    } <= names


def test_text_changes_affect_no_code(icdgen, releases, sources):
    text = (
        (releases[0] / "demo.yaml")
        .read_text()
        .replace("title: Demo", "title: Another demo")
    )
    (releases[1] / "demo.yaml").write_text(text)
    assert uses(icdgen) == []


def test_a_single_file_can_be_named_and_invalid_bytes_are_accepted(
    icdgen, releases, sources
):
    (sources / "main.c").write_bytes(b"\xff\xfe demo_set_roll_t /* " + C.encode())
    assert uses(icdgen, "--uses", "src/main.c")[0][2] == "roll_angle_deg"
    result = icdgen("diff", "old", "new", "--uses", "old/demo.yaml")
    assert result.status == 2 and "is no C, Python or Rust source" in result.err


def test_the_shipped_examples_show_what_uses_a_frame(icdgen, tmp_path):
    from tests.conftest import ROOT
    from tests.diff.release.make import make

    make(tmp_path / "older")
    path = tmp_path / "older" / "cubeacp.yaml"
    roll = re.compile(r"(name: Estimated Roll Angle, .*formula: )raw\*0\.01")
    path.write_text(roll.sub(r"\g<1>raw*0.02", path.read_text()))
    out = icdgen("diff", "older", ROOT / "icd", "--uses", ROOT / "examples").out
    assert "examples/" in out.split("uses in your sources")[1]


@pytest.mark.parametrize(
    ("language", "text", "names"),
    [
        ("c", 'a "b \\" c" d', ["a", "d"]),
        ("c", "a // b\nc /* d\n e */ f /* g", ["a", "c", "f"]),
        ("c", 'a "b\nc', ["a", "b", "c"]),
        ("c", "if (c == '\"') state.level = '\"';", ["if", "c", "state", "level"]),
        ("c", r"'\'' a '\\' b '\"' c", ["a", "b", "c"]),
        (
            "rust",
            "fn f<'a>(x: &'a str) -> char { '\"' }",
            ["fn", "f", "a", "x", "a", "str", "char"],
        ),
        ("rust", "b'\"' level", ["b", "level"]),
        ("c", "a1_B 2c _d", ["a1_B", "c", "_d"]),
        ("python", "a # b 'c\nd", ["a", "d"]),
        ("python", "'a' b \"c\" d r'e\\' f' rb\"g\" Rb'h' u'i' j", ["b", "d", "j"]),
        ("python", '"""a "b" c""" d \'\'\'e\nf\'\'\' g', ["d", "g"]),
        ("python", '"""a', []),
        ("python", "f'{a} b {{c}} {d!r:>{e}}' g", ["a", "d", "r", "e", "g"]),
        ("python", "rF'{a}' Fr\"{b}\" fr'''{c}\n{d}'''", ["a", "b", "c", "d"]),
        ("python", "b'{a}' '{b}' c", ["c"]),
    ],
)
def test_names_are_those_outside_of_comments_and_texts(language, text, names):
    tokens = list(_tokens(text, _LEXERS[language]))
    assert [name for name, _ in tokens] == names
    assert all(text[at:].startswith(name) for name, at in tokens)


@pytest.mark.parametrize(
    ("language", "mentioned", "stem", "expected"),
    [
        ("c", {"demo_status_t"}, "demo_status", True),
        ("c", {"DEMO_STATUS_LENGTH"}, "demo_status", True),
        ("c", {"demo_status"}, "demo_status", True),
        ("c", {"demo_statuses"}, "demo_status", False),
        ("c", {"my_demo_status_t"}, "demo_status", False),
        ("c", set(), "demo_status", False),
        ("python", {"Status"}, "Status", True),
        ("python", {"Status_x", "STATUS"}, "Status", False),
        ("rust", {"Status"}, "Status", True),
    ],
)
def test_a_source_mentions_a_type_by_its_name_or_in_c_by_its_prefix(
    language, mentioned, stem, expected
):
    assert _mentions(language, mentioned, stem) is expected


def test_sources_are_found_in_the_order_of_folders_and_names(tmp_path):
    names = "a.C b.hpp c.txt deep/d.pyi deep/e.ino .venv/f.py target/g.rs z/.git/h.c"
    for name in [*names.split(), "node_modules/i.py", "z/j.rs", "a/k.cxx", "l.inc"]:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).touch()
    found = [str(path.relative_to(tmp_path)) for path in _sources(tmp_path)]
    assert found == [
        "a.C",
        "b.hpp",
        "l.inc",
        "a/k.cxx",
        "deep/d.pyi",
        "deep/e.ino",
        "z/j.rs",
    ]
    assert list(_sources(tmp_path / "a.C")) == [tmp_path / "a.C"]
    for name, text, help in (
        ("c.txt", "is no C, Python or Rust source", "known are .c, .h, "),
        ("none", "there is no ", "give --uses a folder, or a source file"),
    ):
        with pytest.raises(UserError) as error:
            list(_sources(tmp_path / name))
        assert text in str(error.value) and error.value.help.startswith(help)


def test_a_generated_file_is_known_by_its_first_characters(tmp_path):
    changes = {"level": {"": ["change"]}}
    for before, count in ((0, 0), (400 - len(MARK), 0), (401 - len(MARK), 1)):
        file = tmp_path / f"{before}.c"
        file.write_text(f"{' ' * before}{MARK} */ */\nlevel;\n")
        uses = list(_in_file(file, "c", changes))
        assert len(uses) == count
    assert (uses[0].line, uses[0].column, uses[0].text) == (2, 1, "level;")


def test_a_use_has_its_line_and_each_change_once(tmp_path):
    file = tmp_path / "a.c"
    file.write_bytes(b"x level\r\n\tlevel; // level\r\nlevel")
    both = {"level": {"": ["one"], "x": ["two", "one"], "y": ["three"]}}
    uses = list(_in_file(file, "c", both))
    assert [(use.line, use.column, use.text, use.changes) for use in uses] == [
        (1, 3, "x level", ("one", "two")),
        (2, 2, "\tlevel; // level", ("one", "two")),
        (3, 1, "level", ("one", "two")),
    ]
    assert {use.file for use in uses} == {str(file)}
