"""``.icdgen-accepted.yaml``: accepted changes do not fail again, and entries that no
longer apply are reported.
"""

from __future__ import annotations

import json

import pytest

ID = "  - {code: DIF103, node: demo, message: Set Roll, was: '20', now: '21', reason: Agreed in review 7.}\n"
FACTOR = "  - {code: DIF201, node: demo, message: Estimated Roll, field: Roll Angle, reason: The new sensor.}\n"
HEAD = "accepted: 1\nchanges:\n"


def accept(folder, *entries: str):
    (folder / ".icdgen-accepted.yaml").write_text(HEAD + "".join(entries))


def test_an_accepted_change_does_not_fail(icdgen, releases, tmp_path):
    accept(tmp_path, ID)
    assert icdgen("diff", "old", "new", "--fail-on", "wire").status == 0
    assert icdgen("diff", "old", "new", "--fail-on", "wire,meaning").status == 1
    accept(tmp_path, ID, FACTOR)
    assert icdgen("diff", "old", "new", "--fail-on", "wire,meaning,source").status == 0


def test_an_accepted_change_is_listed_with_its_reason_and_counts_for_the_version(
    icdgen, releases, tmp_path
):
    accept(tmp_path, ID, FACTOR)
    out = icdgen("diff", "old", "new").out
    assert (
        "accepted: 2 changes" in out
        and "Agreed in review 7. (.icdgen-accepted.yaml:3:12)" in out
    )
    assert "generated packages: major" in out
    document = json.loads(icdgen("diff", "old", "new", "--format", "json").out)
    assert [change["accepted"] for change in document["changes"]] == [
        "Agreed in review 7.",
        "The new sensor.",
    ]
    assert document["counts"] == {"wire": 0, "meaning": 0, "source": 0, "text": 0}


def test_the_file_is_searched_in_parent_folders_up_to_the_repository(
    icdgen, releases, tmp_path, monkeypatch
):
    accept(tmp_path, ID)
    inner = tmp_path / "deep" / "er"
    inner.mkdir(parents=True)
    monkeypatch.chdir(inner)
    assert icdgen_in(monkeypatch, inner, icdgen) == 0
    (tmp_path / "deep" / ".git").mkdir()
    assert icdgen_in(monkeypatch, inner, icdgen) == 1


def icdgen_in(monkeypatch, folder, icdgen) -> int:
    return icdgen("diff", "../../old", "../../new", "--fail-on", "wire").status


def test_another_file_can_be_named(icdgen, releases, tmp_path):
    (tmp_path / "ours.yaml").write_text(HEAD + ID)
    assert (
        icdgen(
            "diff", "old", "new", "--fail-on", "wire", "--accepted", "ours.yaml"
        ).status
        == 0
    )


@pytest.mark.parametrize(
    "change",
    [
        ("'21'", "'22'"),
        ("Set Roll", "Set Yaw"),
        ("node: demo", "node: other"),
        ("DIF103", "DIF106"),
        ("was: '20'", "was: '19'"),
    ],
)
def test_an_entry_that_no_longer_applies_is_reported(
    icdgen, releases, tmp_path, change
):
    accept(tmp_path, ID.replace(*change))
    result = icdgen("diff", "old", "new", "--fail-on", "wire")
    assert result.status == 1
    assert (
        ".icdgen-accepted.yaml:3:12: warning[DIF901]: this accepted change does not happen"
        in result.out
    )
    for form, expected in (
        ("markdown", "does not happen"),
        ("html", "does not happen"),
        ("github", "::warning"),
        ("sarif", "DIF901"),
    ):
        assert expected in icdgen("diff", "old", "new", "--format", form).out
    (stale,) = json.loads(icdgen("diff", "old", "new", "--format", "json").out)["stale"]
    assert stale["place"]["line"] == 3 and stale["reason"] == "Agreed in review 7."


def test_the_first_of_two_entries_about_a_change_gives_the_reason(
    icdgen, releases, tmp_path
):
    """Neither entry is unused: a general one can follow one about a single message."""
    general = "  - {code: DIF103, node: demo, reason: All ids are new.}\n"
    for entries, reason in (
        ((ID, general), "Agreed in review 7."),
        ((general, ID), "All ids are new."),
    ):
        accept(tmp_path, *entries)
        document = json.loads(icdgen("diff", "old", "new", "--format", "json").out)
        accepted = [change.get("accepted") for change in document["changes"]]
        assert (accepted, document["stale"]) == ([reason, None], [])


def test_an_unused_entry_is_reported_if_nothing_changed(icdgen, releases, tmp_path):
    accept(tmp_path, ID)
    assert "does not happen" in icdgen("diff", "old", "old").out


def test_an_entry_about_a_node_covers_all_changes_of_its_kind(
    icdgen, releases, tmp_path
):
    accept(tmp_path, "  - {code: dif103, node: demo, reason: All ids are new.}\n")
    assert icdgen("diff", "old", "new", "--fail-on", "wire").status == 0


@pytest.mark.parametrize(
    "text, expected",
    [
        (
            "accepted: 1\nchanges:\n  - {code: DIF103, node: demo}\n",
            "`reason` is missing",
        ),
        (
            "accepted: 1\nchanges:\n  - {code: DIF103, reason: R.}\n",
            "`node` is missing",
        ),
        (
            "accepted: 1\nchanges:\n  - {code: DIF999, node: demo, reason: R.}\n",
            "there is no rule `DIF999`",
        ),
        (
            "accepted: 1\nchanges:\n  - {code: DIF103, node: demo, reason: R., messag: X}\n",
            "did you mean `message`?",
        ),
        ("accepted: 2\nchanges: []\n", "`accepted`"),
        ("accepted: [\n", "not YAML"),
        ("", "the file is empty"),
    ],
)
def test_a_bad_file_is_a_finding(icdgen, releases, tmp_path, text, expected):
    (tmp_path / ".icdgen-accepted.yaml").write_text(text)
    result = icdgen("diff", "old", "new")
    assert (
        result.status == 2
        and expected in result.err
        and ".icdgen-accepted.yaml:" in result.err
    )
