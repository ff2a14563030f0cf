"""The reader of a definition is found by its content, or else by its suffix; files that
cannot be read are findings.
"""

from __future__ import annotations

import pytest

from icdgen.definitions import kinds
from icdgen.definitions.model import Definitions, unreadable
from icdgen.diagnostics import Findings
from icdgen.errors import UserError
from tests.limits import assert_limits

ALL = ["dbc", "kcd", "sym", "arxml", "mavlink", "mavlink1", "xtce", "eds", "ksy",
       "sunspec"]  # fmt: skip
DBC = 'VERSION ""\n\nBU_: Engine\n'
XTCE = '<?xml version="1.0"?>\n<SpaceSystem name="a"/>\n'
KSY = "meta:\n  id: a\nseq: []\n"


class Reader:
    """Reader of files that do not begin with ``bad``."""

    name, title, needs = "test", "a test", ()

    def knows(self, start):
        return False

    def read(self, file, data):
        if data.startswith(b"bad"):
            raise unreadable(file, "it is bad", "mend it", 7)
        return Definitions(file, total=len(data))


class Set(Reader):
    most_bytes = 4

    def read_set(self, sources):
        return [
            Definitions(",".join(source.file[-1] for source in sources)),
            *(Definitions(source.file, total=len(source.data)) for source in sources),
        ]


def reader_name(path):
    reader = kinds.reader_of_file(path)
    return None if reader is None else reader.name


def write(path, text, encoding="utf-8"):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding=encoding)
    return path


def test_each_kind_has_a_reader_of_its_name_and_plug_ins_follow(monkeypatch):
    assert kinds.names() == ALL
    assert [kinds.reader_of_kind(name).name for name in ALL] == ALL
    plug_ins = {"zeta": "z:Z", "alpha": "a:A"}
    monkeypatch.setattr(kinds, "_plug_ins", lambda: plug_ins)
    assert kinds.names() == [*ALL, "alpha", "zeta"]


def test_a_plug_in_does_not_replace_a_reader_of_icdgen(monkeypatch):
    from importlib import metadata

    points = [
        metadata.EntryPoint("dbc", "json:JSONDecoder", kinds.GROUP),
        metadata.EntryPoint("other", "json:JSONDecoder", kinds.GROUP),
    ]
    asked = []
    monkeypatch.setattr(
        metadata, "entry_points", lambda **keys: asked.append(keys) or points
    )
    assert kinds.names() == [*ALL, "other"]
    assert kinds.reader_of_kind("dbc").name == "dbc"
    assert type(kinds.reader_of_kind("other")).__name__ == "JSONDecoder"
    assert asked[0] == {"group": "icdgen.definitions"}


@pytest.mark.parametrize(
    ("name", "target", "message", "help"),
    [
        ("odt", "json:JSONDecoder", "there is no kind of definition `odt`",
         f"there are {', '.join(ALL)}, other"),
        (
            "other",
            "no_such_module:Reader",
            "the reader of `other`, no_such_module:Reader, cannot be loaded: "
            "No module named 'no_such_module'",
            "",
        ),
        (
            "other",
            "json:Reader",
            "the reader of `other`, json:Reader, cannot be loaded: "
            "module 'json' has no attribute 'Reader'",
            "",
        ),
    ],
)  # fmt: skip
def test_a_kind_without_a_reader_is_an_error(name, target, message, help, monkeypatch):
    monkeypatch.setattr(kinds, "_plug_ins", lambda: {"other": target})
    with pytest.raises(UserError) as caught:
        kinds.reader_of_kind(name)
    assert (str(caught.value), caught.value.help) == (message, help)


@pytest.mark.parametrize(
    ("name", "text", "expected"),
    [
        ("a.txt", DBC, "dbc"), ("a.txt", XTCE, "xtce"), ("a.txt", KSY, "ksy"),
        # The content decides, also against the suffix.
        ("a.dbc", XTCE, "xtce"), ("a.dbc", "", "dbc"), ("a.DBC", "", "dbc"),
        ("a.ksy", "", "ksy"), ("a.txt", "", None), ("dbc", "", None),
        ("a.dbc", "%PDF-1.7 ", None), ("a.dbc", " %PDF-1.7", "dbc"),
    ],
)  # fmt: skip
def test_a_file_is_recognized_by_its_content_or_else_by_its_suffix(
    name, text, expected, tmp_path
):
    assert reader_name(write(tmp_path / name, text)) == expected


def test_a_byte_order_mark_and_invalid_characters_do_not_hide_the_kind(tmp_path):
    assert reader_name(write(tmp_path / "a.txt", XTCE, "utf-8-sig")) == "xtce"
    (tmp_path / "b.txt").write_bytes(XTCE.encode() + b"<!-- \xff -->")
    assert reader_name(tmp_path / "b.txt") == "xtce"


def test_a_file_that_cannot_be_opened_has_no_reader(tmp_path):
    assert reader_name(tmp_path / "missing.dbc") is None
    (tmp_path / "folder.dbc").mkdir()
    assert reader_name(tmp_path / "folder.dbc") is None


def test_only_the_first_65536_bytes_identify_a_file(tmp_path):
    root = '<SpaceSystem name="a"/>'

    def is_recognized(end):
        comment = f"<!--{'x' * (end - len(root) - 7)}-->"
        return reader_name(write(tmp_path / "a.txt", comment + root)) == "xtce"

    # The name of the root is within the first bytes: what follows it does not count.
    behind = len(root) - len("<SpaceSystem")
    assert_limits(lambda end: is_recognized(end + behind), most=65_536)


def test_definitions_of_a_folder_come_by_path_without_hidden_folders(tmp_path):
    for name in ("b/z.dbc", "b/a/x.xml", "b.dbc", "a.ksy", ".git/a.dbc", "b/.h/a.dbc"):
        write(tmp_path / name, XTCE if name.endswith("xml") else "")
    write(tmp_path / "readme.txt", "")
    write(tmp_path / ".hidden.dbc", "")
    (tmp_path / "c.dbc").mkdir()
    definitions = kinds.within(tmp_path)
    assert [
        (str(path.relative_to(tmp_path)), reader.name) for path, reader in definitions
    ] == [
        (".hidden.dbc", "dbc"),
        ("a.ksy", "ksy"),
        ("b/a/x.xml", "xtce"),
        ("b/z.dbc", "dbc"),
        ("b.dbc", "dbc"),
    ]


def test_the_files_of_a_kind_are_read_one_by_one_or_together(tmp_path):
    files = [write(tmp_path / name, "abc"[: n + 1]) for n, name in enumerate("AB")]

    def totals(reader):
        return [
            (each.file.removeprefix(f"{tmp_path}/"), each.total)
            for each in kinds.read_set(files, reader)
        ]

    assert totals(Reader()) == [("A", 1), ("B", 2)]
    assert totals(Set()) == [("A,B", 0), ("A", 1), ("B", 2)]


def findings_of(definitions):
    return [
        (
            finding.code,
            finding.severity,
            finding.message,
            finding.help,
            finding.spot.line,
        )
        for finding in definitions.import_findings
    ]


def test_an_unreadable_file_does_not_prevent_the_others(tmp_path):
    names = {"good": "ab", "bad": "bad!", "long": "abcde"}
    files = [write(tmp_path / name, text) for name, text in names.items()]
    missing, good, bad, *_ = kinds.read_set([tmp_path / "none", *files], Reader())
    assert (good.file, good.total, findings_of(good)) == (str(files[0]), 2, [])
    text = "cannot read the file: No such file or directory"
    assert missing.file == str(tmp_path / "none") and findings_of(missing) == [
        ("IMP005", "error", text, "check the path", None)
    ]
    assert bad.file == str(files[1])
    assert findings_of(bad) == [("IMP005", "error", "it is bad", "mend it", 7)]
    large, together, *_ = kinds.read_set(files, Set())
    assert large.file == str(files[2]) and together.file == "d,d"
    text = "the file has more than the 4 bytes allowed"
    assert findings_of(large) == [("IMP005", "error", text, "import it in parts", None)]


def test_a_file_has_as_many_bytes_as_its_reader_allows(tmp_path, monkeypatch):
    def is_read(size, *more):
        try:
            return len(kinds.contents(write(tmp_path / "a", "a" * size), *more)) == size
        except Findings:
            return False

    assert_limits(lambda size: is_read(size, 4), most=4)
    assert kinds.MAX_BYTES == 8_000_000
    path = write(tmp_path / "a", "abcde")
    with pytest.raises(Findings):
        kinds.read(path, Set())
    assert kinds.read(path, Reader()).total == 5
    monkeypatch.setattr(Set, "most_bytes", 5)
    assert kinds.read(path, Set()).total == 5


@pytest.mark.parametrize(
    ("needs", "text"),
    [
        (("json", "no_such"), "no_such, which is not installed"),
        (("no_such", "none"), "no_such and none, which are not installed"),
    ],
)
def test_a_missing_library_is_named_with_the_command_to_install_it(
    needs, text, tmp_path, monkeypatch
):
    monkeypatch.setattr(Reader, "needs", needs)
    path = write(tmp_path / "a", "abc")
    for read in (
        lambda: kinds.read(path, Reader()),
        lambda: kinds.read_set([path], Reader()),
    ):
        with pytest.raises(UserError) as caught:
            read()
        assert str(caught.value) == f"reading a test takes {text}"
        assert caught.value.help == "pip install 'icdgen[definitions]'"
