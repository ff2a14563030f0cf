"""Short profiles read documents with the features of real ones, from the document and
from its table files.
"""

from __future__ import annotations

import pytest
import yaml

from icdgen.importer import profile, run, source_tables, table_files
from tests.importer.rules.shapes import SHAPES


def read(path, words) -> tuple[run.Result, dict]:
    result, trees = run.run(path, profile.load(words), jobs=1)
    return result, next(iter(trees.values()), {})


@pytest.fixture(params=SHAPES)
def shape(request, tmp_path):
    selected = SHAPES[request.param]
    selected.draw(tmp_path / "manual.pdf")
    (tmp_path / "rules.yaml").write_text(selected.profile, encoding="utf-8")
    return selected


def test_a_short_profile_reads_the_document(shape, tmp_path):
    assert len([line for line in shape.profile.splitlines() if line.strip()]) <= 15
    result, tree = read(tmp_path / "manual.pdf", tmp_path / "rules.yaml")
    assert [t.message for t in result.import_findings if t.severity == "error"] == []
    got = {}
    for message in tree["messages"]:
        fields = [
            (
                f["at"],
                f.get("bits", 0) * f.get("count", 1) if "struct" not in f else None,
                f["name"],
            )
            for f in message["fields"]
        ]
        got[message["name"]] = (
            message.get("id", message.get("set_id")),
            message["length"],
            fields,
        )
    wanted = {
        name: (
            id,
            length,
            [
                (at, None if shape.facts.get((name, n), {}).get("struct") else bits, n)
                for at, bits, n in fields
            ],
        )
        for name, (id, length, fields) in shape.messages.items()
    }
    assert got == wanted
    fields = {(m["name"], f["name"]): f for m in tree["messages"] for f in m["fields"]}
    assert {
        key: {k: fields[key].get(k) for k in facts}
        for key, facts in shape.facts.items()
    } == shape.facts
    assert {
        e["name"]: {m["value"]: m["name"] for m in e["members"]}
        for e in tree.get("enums", [])
    } == shape.enums


def test_table_files_give_what_the_document_gives(shape, tmp_path):
    result, tree = read(tmp_path / "manual.pdf", tmp_path / "rules.yaml")
    table_files.write_tables(result.tables, tmp_path / "tables", result.document)
    second, same = read(tmp_path / "tables", tmp_path / "rules.yaml")
    assert same == tree
    assert second.import_findings == result.import_findings
    assert second.tables == result.tables
    texts = {path.name: path.read_bytes() for path in (tmp_path / "tables").iterdir()}
    table_files.write_tables(second.tables, tmp_path / "tables", second.document)
    assert texts == {
        path.name: path.read_bytes() for path in (tmp_path / "tables").iterdir()
    }


def test_without_rules_nothing_becomes_a_message(shape, tmp_path):
    (tmp_path / "rules.yaml").write_text("profile: 1\nrules: []\n", encoding="utf-8")
    result, tree = read(tmp_path / "manual.pdf", tmp_path / "rules.yaml")
    assert tree == {} and result.failed
    assert {t.code for t in result.import_findings if t.severity != "note"} == {
        "IMP004",
        "IMP100",
    }


def test_the_kinds_of_tables_are_a_profile_to_be_completed(shape, tmp_path):
    from icdgen.importer.rules import explore

    result, _ = read(tmp_path / "manual.pdf", tmp_path / "rules.yaml")
    proposal = yaml.safe_load(explore.report(result.tables, "manual.pdf"))
    heads = [tuple(rule["tables"]["head"].split(" | ")) for rule in proposal["rules"]]
    assert heads == [
        tuple(title or "*" for title in group[0].titles)
        for group in source_tables.group_by_headings(result.tables)
    ]
