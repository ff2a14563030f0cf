"""Reports of the diff in each format: JSON with its schema, SARIF, annotations,
Markdown, HTML.
"""

from __future__ import annotations

import json
from contextlib import chdir
from dataclasses import replace
from functools import cache
from html.parser import HTMLParser

import jsonschema
import pytest

from icdgen.diagnostics import Place
from icdgen.diff import inputs, report, reports
from icdgen.diff.reports.findings import of_change
from icdgen.diff.reports.groups import groups
from icdgen.diff.reports.html import coded
from icdgen.diff.reports.json import SCHEMA
from tests.conftest import ROOT
from tests.diff.cases import CASES, FOLDER, compared
from tests.diff.release.make import facts, make

FORMATS = sorted(reports.FORMATS)


@pytest.fixture(scope="module")
def older(tmp_path_factory):
    return make(tmp_path_factory.mktemp("older"))


@pytest.fixture(scope="module")
def release(older) -> report.DiffReport:
    with chdir(ROOT):
        return report.make_report(*inputs.sides([str(older), "icd"], []))


@cache
def schema() -> jsonschema.Draft202012Validator:
    return jsonschema.Draft202012Validator(
        json.loads(SCHEMA.read_text(encoding="utf-8"))
    )


class TestJson:
    @pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
    def test_every_report_fits_the_schema(self, case):
        document = json.loads(reports.get("json")(compared(case)))
        schema().validate(document)
        assert case.name in {change["code"] for change in document["changes"]}

    def test_the_report_of_a_release_fits_the_schema(self, release):
        document = json.loads(reports.get("json")(release))
        schema().validate(document)
        assert sum(document["counts"].values()) == len(document["changes"])

    def test_the_schema_is_valid_and_refuses_other_json(self, release):
        jsonschema.Draft202012Validator.check_schema(schema().schema)
        document = json.loads(reports.get("json")(release))
        document["changes"][0]["layer"] = "wine"
        with pytest.raises(jsonschema.ValidationError):
            schema().validate(document)


class TestSarif:
    def test_results_have_the_new_and_the_old_place(self, release):
        run = json.loads(reports.get("sarif")(release))["runs"][0]
        rules = run["tool"]["driver"]["rules"]
        assert len(run["results"]) == len(release.changes)
        for result, change in zip(run["results"], release.changes, strict=True):
            assert rules[result["ruleIndex"]]["id"] == result["ruleId"] == change.code
            region = result["locations"][0]["physicalLocation"]["region"]
            place = change.new or change.old
            assert (region["startLine"], region["startColumn"]) == place[1:3]
            assert ("relatedLocations" in result) == (
                change.old is not None and change.new is not None
            )
        assert all(
            rule["help"]["text"].startswith(f"# {rule['id']}: ") for rule in rules
        )

    def test_a_change_is_at_its_place_in_the_new_icd_and_related_to_the_old_one(self):
        run = json.loads(reports.get("sarif")(compared(FOLDER / "DIF134")))["runs"][0]
        places = [
            [
                (where["artifactLocation"]["uri"], *where["region"].values())
                for where in (
                    location["physicalLocation"]
                    for key in ("locations", "relatedLocations")
                    for location in result.get(key, ())
                )
            ]
            for result in run["results"]
        ]
        assert places == [
            [("current/demo.yaml", 7, 45, 49), ("previous/demo.yaml", 7, 45, 49)],
            [("current/demo.yaml", 12, 75, 81), ("previous/demo.yaml", 11, 75, 77)],
            [("current/demo.yaml", 10, 9, 10)],
        ]


class TestGithub:
    def test_each_change_is_one_command_with_its_severity(self, release):
        lines = reports.get("github")(release).splitlines()
        assert len(lines) == len(release.changes)
        words = {"error": "::error ", "warning": "::warning ", "note": "::notice "}
        for line, change in zip(lines, release.changes, strict=True):
            assert line.startswith(words[change.severity]) and change.code in line

    def test_a_command_has_the_place_in_the_new_icd_and_the_message(self):
        _, line, _ = reports.get("github")(compared(FOLDER / "DIF134")).splitlines()
        assert line == (
            "::error title=icdgen DIF120,file=current/demo.yaml,line=12,endLine=12,"
            "col=75,endColumn=81::DIF120: wire: "
            "`protocol.link.trailer.checksum.covers.from` is length, was id"
        )


MARKDOWN = """\
## ICD changes: previous → current

Version of the generated packages: **major** – 1 change of the wire format, the first: ids of `demo` have 16 bits, had 8.

| layer | changes | additions | |
|---|---:|---:|---|
| **wire** | 1 |  | values are at other bits or are read differently |
| **meaning** | 0 |  | the raw values are the same, their meaning differs |
| **source** | 0 |  | generated names and types change |
| **text** | 0 |  | words only |

| | | frames as before |
|---|---|---|
| Can an old ground station read the new device's telemetry? | **partly** | 1 of 1 |
| Can old telecommands still be sent? | **partly** | 0 of 0 |
| Can new software read old log files? | **yes** | 1 of 1 |

<details><summary>Can an old ground station read the new device's telemetry? <b>partly</b></summary>

- ids of `demo` have 16 bits, had 8

</details>

<details><summary>Can old telecommands still be sent? <b>partly</b></summary>

- ids of `demo` have 16 bits, had 8

</details>

### wire: values are at other bits or are read differently

**demo** (node, demo)

- error `DIF116` ids of `demo` have 16 bits, had 8 – previous/demo.yaml:2 → current/demo.yaml:2
  - An id is sent as 2 bytes, was as 1 byte.
"""


class TestMarkdown:
    def test_the_report_has_the_verdicts_and_every_change(self, release):
        text = reports.get("markdown")(release)
        assert "**major**" in text and text.count("frames as before") >= 1
        assert sum(
            text.count(f"`{code}`") for code in {c.code for c in release.changes}
        ) >= len(release.changes)
        assert text.count("<details>") == text.count("</details>")

    def test_a_change_that_concerns_all_frames_is_a_reason_of_each_direction(self):
        assert reports.get("markdown")(compared(FOLDER / "DIF116")) == MARKDOWN


class Page(HTMLParser):
    """Parser that checks that every element is closed, and records links and fields."""

    VOID = frozenset(("meta", "br", "input", "rect", "polygon"))

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.links: list[str] = []
        self.fields: list[tuple[str, str]] = []
        self.drawings = 0

    def handle_starttag(self, tag, attributes):
        values = dict(attributes)
        self.links += [values[key] for key in ("href", "src") if key in values]
        if tag == "g":
            self.fields.append((values["class"], values["data-key"]))
        self.drawings += tag == "svg"
        if tag not in self.VOID or (
            tag == "rect" and self.get_starttag_text()[-2:] != "/>"
        ):
            self.open.append(tag)

    def handle_startendtag(self, tag, attributes):
        pass

    def handle_endtag(self, tag):
        assert self.open.pop() == tag


class TestHtml:
    def page(self, release) -> tuple[str, Page]:
        text = reports.get("html")(release)
        page = Page()
        page.feed(text)
        page.close()
        assert page.open == []
        return text, page

    def test_the_page_is_complete_and_self_contained(self, release):
        text, page = self.page(release)
        assert all(link.startswith("#") for link in page.links)
        assert "http" not in text and "url(" not in text and "@import" not in text
        assert "prefers-color-scheme: dark" in text

    def test_the_page_draws_both_layouts_of_every_changed_frame(self, release):
        text, page = self.page(release)
        assert page.drawings >= len(facts()["lengths"])
        assert ">old</text>" in text and ">new</text>" in text
        for name in (
            "ECEF Position X",
            "Redundant Magnetometer Temperature",
            "Z-Rate Sensor Temperature",
        ):
            assert f"<title>{name}, bit" in text
        kinds = [kind for kind, _ in page.fields]
        assert kinds.count("field come") >= 14 and kinds.count("field moved") == 2 * 5

    def test_a_moved_field_links_to_its_new_position(self, release):
        text, _ = self.page(release)
        assert 'class="link moved"' in text

    @pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
    def test_the_complete_page_contains_every_change(self, case):
        text, _ = self.page(compared(case))
        assert case.name in text


class TestRelease:
    """The reconstructed older release of the device compared with the current ICDs."""

    def test_the_older_frames_have_their_documented_lengths(self, release):
        lengths = {
            m.name: m.length for node in release.old.icd.nodes for m in node.messages
        }
        assert {name: lengths[name] for name in facts()["lengths"]} == facts()[
            "lengths"
        ]

    def test_the_diff_reports_exactly_the_removed_fields(self, release):
        reported = {
            (c.code, c.where.message) for c in release.changes if c.layer == "wire"
        }
        expected = {("DIF106", name) for name in facts()["lengths"]} | {
            ("DIF108", "Power and Temperature Measurements")
        }
        assert reported == expected
        assert [c for c in release.changes if c.layer == "meaning"] == []
        added = {c.where.field for c in release.changes if c.code == "DIF311"}
        assert added == {
            name for names in facts()["removed"].values() for name in names
        }

    def test_only_the_changed_frames_are_no_longer_understood(self, release):
        telemetry, telecommands, _ = release.directions
        assert {frame.message for frame in telemetry.frames} == set(facts()["lengths"])
        assert telecommands.verdict == "yes"

    @pytest.mark.parametrize("form", FORMATS)
    def test_every_format_supports_the_release(self, release, form):
        assert len(reports.get(form)(release)) > 2000


@pytest.fixture(scope="module")
def renamed() -> report.DiffReport:
    """Return the report on another member, without places of its first change."""
    result = compared(FOLDER / "DIF205")
    first, *rest = result.changes
    first = replace(
        first,
        old=None,
        new=None,
        confidence=0.87649,
        errata=("D-1 is new", "D-2 is gone"),
        message="a|b *c* `d|e`",
    )
    result.changes = result.comparison.changes = [first, *rest]
    return result


class TestChanges:
    """Values of a change that other reports leave out or shorten."""

    NOTES = (
        "Used by `Status: State`.",
        "Matched by similarity, likely (88%).",
        "Because erratum D-1 is new, D-2 is gone.",
    )

    def test_a_change_without_a_place_is_a_finding_about_the_icd(self, renamed):
        finding = of_change(renamed.changes[0])
        assert finding.place == Place("icd") and finding.severity == "error"
        assert finding.message == "meaning: a|b *c* `d|e`"
        assert finding.help == " ".join(self.NOTES)

    def test_json_has_the_confidence_with_three_digits_and_no_places(self, renamed):
        change = json.loads(reports.get("json")(renamed))["changes"][0]
        assert (change["sure"], change["old"], change["new"]) == (0.876, None, None)
        assert change["errata"] == ["D-1 is new", "D-2 is gone"]
        where = {"node": "demo", "enum": "Mode", "member": "Safe"}
        assert change["where"] == where
        # The names that sources of the old ICD have
        names = {"c": ["DEMO_MODE_RUN"], "python": ["RUN"], "rust": ["Run"]}
        assert change["generated"] == names

    def test_text_and_markdown_have_each_note(self, renamed):
        text = reports.get("text")(renamed)
        lines = [
            "  Mode (enumeration, demo)",
            "    error[DIF205] a|b *c* `d|e`",
            *(f"        {note}" for note in self.NOTES),
            "        no file",
        ]
        assert "\n".join(lines) in text
        markdown = reports.get("markdown")(renamed).splitlines()
        start = markdown.index("**Mode** (enumeration, demo)")
        assert markdown[start + 2] == r"- error `DIF205` a\|b \*c\* `d\|e` – "
        assert markdown[start + 4] == "  - Matched by similarity, likely (88%)."

    def test_sarif_has_no_related_place_without_both_places(self, renamed):
        (run,) = json.loads(reports.get("sarif")(renamed))["runs"]
        assert run["results"][0]["properties"]["sure"] == 0.876
        assert "relatedLocations" not in run["results"][0]
        assert "relatedLocations" in run["results"][1]

    def test_changes_are_grouped_by_enumeration_node_and_message(self):
        found = groups(
            [
                *compared(FOLDER / "DIF204").changes,
                *compared(FOLDER / "DIF205").changes,
                *compared(FOLDER / "DIF105").changes,
                *compared(FOLDER / "DIF413").changes,
            ]
        )
        assert [
            (group.title, group.about, group.node, group.layers) for group in found
        ] == [
            ("Status", "telemetry 130", "demo", ["meaning", "source"]),
            ("Mode", "enumeration", "demo", ["meaning", "source"]),
            ("Limits", "telecommand 20", "demo", ["wire"]),
            ("demo", "node", "demo", ["text"]),
        ]

    def test_the_explanation_of_an_addition_is_left_out_unless_everything_is_shown(
        self,
    ):
        added = compared(FOLDER / "DIF133")
        (note,) = added.changes[0].details
        assert note not in reports.get("text")(added)
        assert note in reports.get("text")(added, everything=True)
        assert note in reports.get("markdown")(added)

    def test_the_page_folds_only_changes_of_words(self):
        words = "<summary>1 with changes of words only</summary>"
        page = reports.get("html")(compared(FOLDER / "DIF403"))
        assert "<h2>Changes</h2>" in page
        before, after = page.split(words)
        assert "DIF202" in before and "DIF202" not in after
        assert "DIF403" in after and "DIF403" not in before
        page = reports.get("html")(compared(FOLDER / "DIF405"))
        assert words in page and "<h2>Changes</h2>" not in page
        assert "No change." not in page

    @pytest.mark.parametrize(
        ("text", "parts"),
        [
            ("a `b` c", [("a ", False), ("b", True), (" c", False)]),
            ("`b`", [("b", True)]),
            ("one ` only", [("one ` only", False)]),
            ("``", []),
            ("", []),
        ],
    )
    def test_words_between_back_ticks_are_code_on_the_page(self, text, parts):
        assert coded(text) == parts
