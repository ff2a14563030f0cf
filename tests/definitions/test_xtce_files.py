"""XTCE files that refer to each other are one database; others stay apart."""

from __future__ import annotations

from itertools import permutations
from xml.etree.ElementTree import fromstring

import pytest

from icdgen.definitions.xtce_files import sets

SPACE = "http://www.omg.org/spec/XTCE/20180204"


def system(name, inner):
    return f'<SpaceSystem xmlns="{SPACE}" name="{name}">{inner}</SpaceSystem>'


def defines(*names):
    return "".join(f'<Parameter name="{name}"/>' for name in names)


def refers(*references, key="parameterRef"):
    return "".join(f'<Entry {key}="{reference}"/>' for reference in references)


def grouped(**files):
    roots = {name: fromstring(text) for name, text in files.items()}
    result = sets(roots)
    assert all(root is roots[file] for group in result for file, root in group.items())
    return [" ".join(group) for group in result]


def is_joined(reference, defined=("X",), key="parameterRef", name="s"):
    first = system("s", refers(reference, key=key))
    return grouped(a=first, b=system(name, defines(*defined))) == ["a b"]


@pytest.mark.parametrize(
    "key",
    ["parameterTypeRef", "argumentTypeRef", "typeRef", "arrayTypeRef", "baseType",
     "parameterRef", "containerRef", "metaCommandRef"],
)  # fmt: skip
def test_each_kind_of_reference_joins_files(key):
    assert is_joined("X", key=key)
    assert not is_joined("X", key="shortDescription") and not is_joined("Y", key=key)


@pytest.mark.parametrize(
    ("reference", "is_found"),
    [
        ("X", True),
        ("/s/X", True),
        ("../s/X", True),
        ("./X", True),
        ("X/member/inner", True),  # of an aggregate
        ("/X", False),
        ("/t/X", False),
        ("../X", False),
        ("", False),
    ],
)
def test_a_reference_is_a_path_from_its_system_outwards(reference, is_found):
    assert is_joined(reference) == is_found


def test_names_are_searched_in_the_enclosing_systems():
    inner = system("s", system("t", refers("X")))
    assert grouped(a=inner, b=system("s", defines("X"))) == ["a b"]
    outer = system("s", refers("X"))
    assert grouped(a=outer, b=system("s", system("t", defines("X")))) == ["a", "b"]
    named = system("s", refers("t/X"))
    assert grouped(a=named, b=system("s", system("t", defines("X")))) == ["a b"]


def test_a_file_that_defines_a_name_itself_needs_no_other():
    both = system("s", defines("X") + refers("X"))
    assert grouped(a=both, b=system("s", defines("X"))) == ["a", "b"]


def test_chains_of_files_are_one_database_in_the_order_of_the_files():
    texts = {
        "a": system("s", refers("X")),
        "b": system("s", defines("X") + refers("Y")),
        "c": system("s", defines("Y")),
        "d": system("s", defines("Z")),
    }
    for order in permutations("abcd"):
        result = grouped(**{name: texts[name] for name in order})
        together = " ".join(name for name in order if name != "d")
        assert result == (["d", together] if order[0] == "d" else [together, "d"])
