"""``--check`` shows the first differing lines of outdated files, and the number of
further ones.
"""

from __future__ import annotations

from pathlib import PurePosixPath

from icdgen.generation import write
from icdgen.generation.differences import short_diff


def lines(*numbers: int, text: str = "line") -> str:
    return "".join(f"{text} {number}\n" for number in numbers)


def shown(out, before: dict[str, str], after: dict[str, str]) -> list[str]:
    """Return the lines that are shown when ``before`` was generated earlier."""
    for files in (before, after):
        paths = [(PurePosixPath(name), text) for name, text in files.items()]
        plan = write.plan(out, "c", paths)
        if files is before:
            write.apply(plan)
    return short_diff([plan]).splitlines()


def test_a_line_that_differs_is_shown_with_its_neighbours(tmp_path):
    path = tmp_path / "a.h"
    after = lines(1, 2) + "new\n" + lines(4, 5)
    assert shown(tmp_path, {"a.h": lines(1, 2, 3, 4, 5)}, {"a.h": after}) == [
        f"--- {path} (on disk)",
        f"+++ {path} (generated)",
        "@@ -2,3 +2,3 @@",
        " line 2",
        "-line 3",
        "+new",
        " line 4",
    ]


def test_a_file_without_an_end_of_its_last_line_is_shown_in_lines(tmp_path):
    text = shown(tmp_path, {"a.h": "old"}, {"a.h": "new"})
    assert text[-2:] == ["-old", "+new"]


def test_a_file_shows_12_lines_and_the_number_of_the_others(tmp_path):
    def last_line(changed: int, same: str = "") -> str:
        folder = tmp_path / f"{changed}{same}"
        folder.mkdir()
        before, after = lines(*range(changed)), lines(*range(changed), text="new")
        *_, last = shown(folder, {"a.h": before + same}, {"a.h": after + same})
        return last

    # Two lines for the names, one for the place, and two for each line that changed.
    assert last_line(4) == "+new 3"
    assert last_line(4, "same") == " same", "12 lines"
    assert last_line(5) == "... 1 more lines"
    assert last_line(9) == "... 9 more lines"


def test_five_files_are_shown_and_the_number_of_the_others(tmp_path):
    def files_shown(count: int) -> tuple[int, str]:
        folder = tmp_path / str(count)
        folder.mkdir()
        names = [f"{number}.h" for number in range(count)]
        before, after = dict.fromkeys(names, "old\n"), dict.fromkeys(names, "new\n")
        text = shown(folder, before, after)
        return sum(line.startswith("+++") for line in text), text[-1]

    assert files_shown(5) == (5, "+new")
    assert files_shown(6) == (5, "... and 1 more files differ")
    assert files_shown(9) == (5, "... and 4 more files differ")


def test_missing_and_stale_files_are_named(tmp_path):
    before = {"a.h": "a\n", "b.h": "b\n"}
    assert shown(tmp_path, before, {"a.h": "a\n"}) == [f"stale: {tmp_path / 'b.h'}"]
    (tmp_path / "b.h").unlink()
    assert shown(tmp_path, {}, {"c.h": "c\n"})[0] == f"missing: {tmp_path / 'c.h'}"


def test_nothing_is_shown_of_files_that_are_current(tmp_path):
    assert shown(tmp_path, {"a.h": "a\n"}, {"a.h": "a\n"}) == []
