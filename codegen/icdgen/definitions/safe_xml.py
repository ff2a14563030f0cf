"""Parser for untrusted XML.

Document types are rejected, so entities are neither expanded nor fetched.
"""

from __future__ import annotations

import re
from typing import Any
from xml.etree.ElementTree import Element, ParseError, TreeBuilder

from icdgen.definitions.accounting import Account, AccountedElement
from icdgen.definitions.model import unreadable

_ROOT = re.compile(r"<(?:[\w.-]+:)?([A-Za-z][\w.-]*)")
_SKIPPED = re.compile(r"<!--.*?-->|<\?.*?\?>|<!.*?>", re.DOTALL)


def root_of(start: str) -> str:
    """Return the name of the root element from the beginning of a text, or an empty
    string if it is not XML.
    """
    text = start.lstrip()
    match = _ROOT.search(_SKIPPED.sub("", text)) if text.startswith("<") else None
    return match[1] if match else ""


def parse(
    file: str,
    data: bytes,
    lines: dict[Element, int] | None = None,
    account: Account | None = None,
) -> Element:
    """Return the root element. ``lines`` receives the line of each element.

    With an ``account``, all elements are `AccountedElement`, which store their line and
    record read access. Raises `Findings` if the text is not XML, or has a document type
    (`<!DOCTYPE`).
    """
    from defusedxml import DefusedXmlException
    from defusedxml.ElementTree import DefusedXMLParser

    class Noting(TreeBuilder):
        def start(self, tag: Any, attributes: Any, /) -> Element:
            element = super().start(tag, attributes)
            if isinstance(element, AccountedElement):
                element.line = parser.parser.CurrentLineNumber
            if lines is not None:
                lines[element] = parser.parser.CurrentLineNumber
            return element

    target = TreeBuilder()
    if lines is not None or account is not None:
        target = Noting(element_factory=None if account is None else AccountedElement)
    parser = DefusedXMLParser(target=target, forbid_dtd=True)
    try:
        parser.feed(data)
        root: Element = parser.close()
    except ParseError as error:
        raise unreadable(
            file, f"not XML: {error}", "check the file around there", error.position[0]
        ) from None
    except (DefusedXmlException, ValueError, LookupError) as error:
        if not isinstance(error, DefusedXmlException):
            raise unreadable(file, f"not XML: {error}", "save it as UTF-8") from None
        help = "remove the document type; entities are neither expanded nor fetched"
        raise unreadable(
            file, "the XML has a document type, which could load other files", help
        ) from None
    for element in root.iter():
        if isinstance(element, AccountedElement):
            # the builder reads the text when it appends to it
            element.is_text_read = False
    return root


def local(tag: object) -> str:
    """Return the name of an element without its namespace."""
    return tag.rsplit("}", 1)[-1] if isinstance(tag, str) else ""
