"""The root element of an XML file determines its kind, and untrusted XML loads nothing."""

from __future__ import annotations

import pytest

from icdgen.definitions import safe_xml
from icdgen.diagnostics import Findings


@pytest.mark.parametrize(
    ("start", "root"),
    [
        ("<mavlink/>", "mavlink"),
        ("\n  <mavlink>", "mavlink"),
        ('<?xml version="1.0"?>\n<mavlink version="3">', "mavlink"),
        ('<xtce:SpaceSystem xmlns:xtce="a">', "SpaceSystem"),
        ("<my.ns-1:Data-Sheet_2.0>", "Data-Sheet_2.0"),
        ("<!-- was <old><older/></old> -->\n<mavlink>", "mavlink"),
        ("<!-- a > b --><!-- <c> --><mavlink>", "mavlink"),
        ("<!--\n<old>\n--><mavlink>", "mavlink"),
        ("<?format <old>?><mavlink>", "mavlink"),
        ("<!DOCTYPE old><mavlink>", "mavlink"),
        ("", ""),
        ("mavlink <mavlink>", ""),
        ('{"a": "<mavlink>"}', ""),
        ("<", ""),
        ("<1>", ""),
    ],
)
def test_the_root_element_is_found_behind_comments_and_instructions(start, root):
    assert safe_xml.root_of(start) == root


@pytest.mark.parametrize(
    ("data", "line", "message"),
    [
        (b"<a>\n<b>\n</a>", 3, "not XML: mismatched tag: line 3, column 2"),
        (b"", 1, "not XML: no element found: line 1, column 0"),
        (
            b"<!DOCTYPE a [<!ENTITY x 'y'>]><a>&x;</a>",
            1,
            "the XML has a document type, which could load other files",
        ),
        (b'<?xml version="1.0" encoding="none"?><a/>', 1, "not XML: unknown encoding"),
    ],
)
def test_xml_that_cannot_be_read_is_one_finding(data, line, message):
    with pytest.raises(Findings) as caught:
        safe_xml.parse("a.xml", data)
    (finding,) = caught.value.findings
    assert finding.message.startswith(message)
    assert (finding.place.file, finding.place.line) == ("a.xml", line)
