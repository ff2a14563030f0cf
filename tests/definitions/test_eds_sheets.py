"""References of data sheets lead to types and design parameters of the file and of its
folder, or are reported.
"""

from __future__ import annotations

import pytest

from icdgen.definitions import eds_sheets, safe_xml
from icdgen.definitions.accounting import Account
from icdgen.definitions.eds_sheets import Sheets, beside
from icdgen.definitions.model import Definitions, NotSupported
from icdgen.diagnostics import Findings
from tests.limits import assert_limits

TOGETHER = (
    "import it together with the file that has it: icdgen import FILE FILE, "
    "or the folder of both"
)


def parse(text, file="a.xml"):
    return safe_xml.parse(file, text.encode(), account=Account())


def package(name, inner="", types=""):
    types = f"<DataTypeSet>{types}</DataTypeSet>" if types else ""
    return f'<Package name="{name}">{inner}{types}</Package>'


def define(**values):
    return "".join(
        f'<Define name="{name}" value="{value}"/>' for name, value in values.items()
    )


def sheets(*packages, neighbours=()):
    """Return the index of a file and of neighbours, each a root and its packages."""
    to = Definitions("x/a.xml")
    root = parse(f"<PackageFile>{''.join(packages)}</PackageFile>")
    others = [
        (f"x/{name}.xml", parse(f"<{tag}>{inner}</{tag}>"))
        for name, tag, inner in neighbours
    ]
    return Sheets(root, others, to)


def rows(index):
    return [
        (each.code, each.severity, each.message, each.help)
        for each in index.to.import_findings
    ]


def value_of(index, text, where=None):
    """Return an attribute of the first type with its parameters resolved."""
    element = index.own[0] if where is None else where
    element.set("text", text)
    return index.attribute(element, "text")


def refusal(call, *arguments):
    with pytest.raises(NotSupported) as caught:
        call(*arguments)
    return str(caught.value), caught.value.help


def test_packages_and_types_are_those_of_the_file_and_its_neighbours():
    component = (
        '<ComponentSet><Component name="C"><DataTypeSet><T name="inner"/></DataTypeSet>'
        "</Component></ComponentSet>"
    )
    index = sheets(
        package("p", component, '<T name="outer"/>'),
        neighbours=[
            ("b", "DataSheet", package("q", types='<T name="other"/>')),
            ("c", "DesignParameters", package("r", define(A=1), '<T name="none"/>')),
        ],
    )
    assert [each.get("name") for each in index.own] == ["p"]
    assert [each.get("name") for each in index.all] == ["p", "q"]
    types = list(index.types(index.own[0]))
    assert [each.get("name") for each in types] == ["outer", "inner"]
    assert [index.package(each) for each in types] == ["p", "p"]
    other = index.find_element("type", "q/other", types[0])
    assert (index.line(types[0]), index.line(other)) == (1, None)


def test_a_name_is_searched_in_its_component_its_package_and_as_a_whole():
    def component(name, *types):
        listed = "".join(f'<T name="{type_}" in="{name}"/>' for type_ in types)
        return (
            f'<Component name="{name}"><DataTypeSet>{listed}</DataTypeSet></Component>'
        )

    components = component("C", "a", "b") + component("D", "a", "c")
    index = sheets(
        package(
            "p",
            f"<ComponentSet>{components}</ComponentSet>",
            '<T name="a" in="p"/><T name="b" in="p"/><T name="d" in="p"/>'
            '<T name="d" in="twice"/>',
        ),
        package("q", types='<T name="a" in="q"/><T name="e" in="q"/>'),
    )
    seats = {each.get("in") + each.get("name"): each for p in index.own
             for each in index.types(p)}  # fmt: skip
    for seat, reference, owner in (
        ("Ca", "a", "C"), ("Da", "a", "D"), ("Da", "b", "p"), ("pa", "a", "p"),
        ("qa", "a", "q"), ("qa", "p/a", "p"), ("Ca", "q/a", "q"), ("Ca", "d", "p"),
        ("qa", "p/C//a", "C"),
    ):  # fmt: skip
        found = index.find_element("type", reference, seats[seat])
        assert found.get("in") == owner, (seat, reference)
    for seat, reference in (("pa", "c"), ("pa", "e"), ("qa", "b"), ("Ca", "p/c")):
        text = f"there is no type `{reference}`"
        assert refusal(index.find_element, "type", reference, seats[seat]) == (text, "")
    where = "which is neither in the file nor in its folder"
    text = f"`r/s/t` is of the package `r/s`, {where}"
    assert refusal(index.find_element, "type", "r/s/t", seats["pa"]) == (text, TOGETHER)


def test_interfaces_and_types_are_different_names():
    declared = '<DeclaredInterfaceSet><Interface name="a"/></DeclaredInterfaceSet>'
    index = sheets(package("p", declared, '<T name="a"/><T name="b"/>'))
    (type_, _) = index.types(index.own[0])
    assert index.find_element("interface", "a", type_).tag == "Interface"
    assert index.find_element("type", "a", type_).tag == "T"
    text = "there is no interface `b`"
    assert refusal(index.find_element, "interface", "b", type_) == (text, "")


def alias(name, of):
    return f'<AliasDataType name="{name}" type="{of}"/>'


def test_an_alias_is_its_type_in_the_package_of_the_alias():
    types = alias("a", "b") + alias("b", "c") + '<T name="c"/>'
    index = sheets(
        package("p", types='<T name="c" in="p"/>'), package("q", types=types)
    )
    (seat,) = index.types(index.own[0])
    assert index.find_element("type", "q/a", seat).get("in") is None
    loop = sheets(package("p", types=alias("a", "b") + alias("b", "a")))
    seat = next(loop.types(loop.own[0]))
    text = "the type `a` is an alias of itself"
    assert refusal(loop.find_element, "type", "a", seat) == (text, "")


def test_design_parameters_are_replaced_by_their_values():
    index = sheets(
        package("p", define(A=3, B="${A}+1", C="${ q/D }", N="name", H="1/2")),
        package("q", define(D="${E}", E=" 8 ", A=9)),
    )
    for text, value in (
        ("${A}", "3"), ("x${A}y${B}", "x3y4"), ("${p/B}", "4"), ("${C}", "8"),
        ("${q/A}", "9"), (" ${N} ", "name"), ("2*${H}", "2*(1/2)"), (" 5 ", "5"),
        ("$A", "$A"), ("${", "${"), ("${A", "${A"),
    ):  # fmt: skip
        assert value_of(index, text) == value, text
    assert value_of(index, "${A}", index.own[1]) == "9"
    assert index.attribute(index.own[0], "none") == ""
    assert index.attribute(index.own[0], "none", "${A}") == "${A}"
    numbers = {name: index.defined(name) for name in ("p/B", "p/H", "p/N", "p/x", "A")}
    assert numbers == {"p/B": 4, "p/H": None, "p/N": None, "p/x": None, "A": None}


def test_parameters_of_neighbours_count_also_of_pure_parameter_files():
    index = sheets(
        package("p"),
        neighbours=[
            ("b", "DesignParameters", package("q", define(A=5))),
            ("c", "PackageFile", package("r", define(B="${q/A}*2"))),
        ],
    )
    assert value_of(index, "${r/B}") == "10"
    with pytest.raises(NotSupported):
        value_of(index, "${other}")


def test_an_undefined_or_circular_parameter_is_refused():
    index = sheets(package("p", define(A="${B}", B="${A}", C="${missing}")))
    text = "no file in the folder defines `${missing}`"
    assert refusal(value_of, index, "${C}") == (text, TOGETHER)
    text, _ = refusal(value_of, index, "${A}")
    assert text.endswith("is defined by itself, or by more than 20 others")


def test_parameters_refer_to_at_most_20_others():
    def is_value(count):
        defines = {f"P{at}": f"${{P{at + 1}}}" for at in range(1, count)}
        index = sheets(package("p", define(**defines, **{f"P{count}": 7})))
        try:
            return value_of(index, "${P1}") == "7"
        except NotSupported:
            return False

    assert_limits(is_value, most=20)


def test_a_value_has_at_most_2000_characters():
    def is_value(size):
        index = sheets(package("p", define(A="x" * 1000, B="x" * (size - 1000))))
        try:
            return len(value_of(index, "${A}${B}")) == size
        except NotSupported as why:
            assert str(why) == "`${A}${B}` becomes longer than 2000 characters"
            return False

    assert_limits(is_value, most=2000)


def test_labels_count_on_from_the_previous_value():
    def enumeration(*values):
        listed = "".join(
            f'<Enumeration label=" L{at} "'
            + ("/>" if value is None else f' value="{value}"/>')
            for at, value in enumerate(values)
        )  # fmt: skip
        return parse(f"<T><EnumerationList>{listed}</EnumerationList></T>")

    index = sheets(package("p"))
    assert list(index.labels(enumeration(None, None, 7, None, -1, None, "0x10"))) == [
        ("L0", 0), ("L1", 1), ("L2", 7), ("L3", 8), ("L4", -1), ("L5", 0), ("L6", 16),
    ]  # fmt: skip
    text = "the value of a label is ``"
    assert refusal(list, index.labels(enumeration(""))) == (text, "")


@pytest.mark.parametrize(
    ("text", "expected"),
    [("true", True), ("1", True), ("TRUE", True), (" true ", True), ("false", False),
     ("0", False), ("", False), ("yes", False)],
)  # fmt: skip
def test_a_flag_is_true_or_1(text, expected):
    index = sheets(package("p"))
    assert index.is_true(parse(f'<T a="{text}"/>'), "a") == expected


def test_a_duplicate_is_reported_once_at_its_first_use():
    types = '<T name="a"/>'
    index = sheets(
        package("p", define(A=1, B=2), types),
        neighbours=[
            ("b", "PackageFile", package("p", define(A=9, B=2), '<T name="b"/>')),
            ("c", "PackageFile", package("p", define(A=7))),
        ],
    )
    (seat,) = index.types(index.own[0])
    assert rows(index) == []
    assert [value_of(index, "${A}"), value_of(index, "${p/A}")] == ["1", "1"]
    assert value_of(index, "${B}") == "2"
    for _ in range(2):
        index.find_element("type", "a", seat)
    help = "the first one is taken"
    assert rows(index) == [
        (
            "IMP076",
            "warning",
            "`${p/A}` is in `a.xml` and otherwise in `b.xml`",
            help,
        ),
        (
            "IMP076",
            "warning",
            "package `p` is in `a.xml` and otherwise in `b.xml`",
            help,
        ),
    ]
    # The second package of a name is not used.
    text = "there is no type `b`"
    assert refusal(index.find_element, "type", "b", seat) == (text, "")


def write(folder, **files):
    for name, text in files.items():
        (folder / f"{name}.xml").write_text(text)
    return str(folder / "own.xml")


def names(file, size=0):
    return [path.rsplit("/", 1)[-1] for path, _ in beside(file, size)]


def test_the_neighbours_of_a_file_are_data_sheets_and_parameters_by_name(tmp_path):
    file = write(
        tmp_path,
        own="<PackageFile/>",
        d="<x:DataSheet xmlns:x='urn:x'/>",
        b="\ufeff<?xml version='1.0'?><!-- a --><DesignParameters/>",
        c="<PackageFile/>",
        other="<SpaceSystem/>",
        text="no XML",
    )
    (tmp_path / "folder.xml").mkdir()
    (tmp_path / "a.txt").write_text("<PackageFile/>")
    assert names(file) == ["b.xml", "c.xml", "d.xml"]


def test_the_neighbours_of_a_file_are_limited(tmp_path, monkeypatch):
    monkeypatch.setattr(eds_sheets, "MOST_FILES", 2)
    file = write(tmp_path, a="<DataSheet/>", b="<DataSheet/>")
    assert names(file) == ["a.xml", "b.xml"]
    write(tmp_path, c="<DataSheet/>")
    with pytest.raises(Findings) as caught:
        names(file)
    (finding,) = caught.value.findings
    assert (finding.code, finding.message, finding.help, finding.place.file) == (
        "IMP005",
        "its folder has more than 2 data sheets, or 32,000,000 bytes of them",
        "move those away that it does not need",
        file,
    )

    def is_read(size):
        try:
            return len(names(file, size)) == 3
        except Findings:
            return False

    monkeypatch.undo()
    monkeypatch.setattr(eds_sheets, "MOST_BYTES", 100)
    # Three files of 12 bytes each.
    assert_limits(is_read, most=100 - 3 * 12)
