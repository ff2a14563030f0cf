"""XML of anybody: without document types, so that nothing is expanded and nothing is fetched."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from icdgen.definitions.model import unreadable

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

_ROOT = re.compile(r"<(?:[\w.-]+:)?([A-Za-z][\w.-]*)")
_SKIPPED = re.compile(r"<!--.*?-->|<\?.*?\?>|<!.*?>", re.DOTALL)


def root_of(start: str) -> str:
    """The name of the outermost element of a text that begins so; nothing if it is no XML."""
    text = start.lstrip()
    found = _ROOT.search(_SKIPPED.sub("", text)) if text.startswith("<") else None
    return found[1] if found else ""


def parse(file: str, data: bytes) -> Element:
    """The outermost element. Raises `Findings` for what is no XML, or has a document type (`<!DOCTYPE`)."""
    from xml.etree.ElementTree import ParseError

    from defusedxml import DefusedXmlException
    from defusedxml.ElementTree import fromstring

    try:
        root: Element = fromstring(data, forbid_dtd=True)
    except ParseError as error:
        raise unreadable(file, f"not XML: {error}", "check the file around there", error.position[0]) from None
    except (DefusedXmlException, ValueError, LookupError) as error:
        if not isinstance(error, DefusedXmlException):
            raise unreadable(file, f"not XML: {error}", "save it as UTF-8") from None
        help = "remove the document type; entities are neither expanded nor fetched"
        raise unreadable(file, "the XML has a document type, with which a file could ask for anything", help) from None
    return root


def local(tag: object) -> str:
    """The name of an element without its namespace."""
    return tag.rsplit("}", 1)[-1] if isinstance(tag, str) else ""
