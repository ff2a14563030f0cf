"""Layers of changes, in descending order of severity."""

from __future__ import annotations

WIRE, MEANING, SOURCE, TEXT = "wire", "meaning", "source", "text"
LAYERS = (WIRE, MEANING, SOURCE, TEXT)  # most severe first
ABOUT = {
    WIRE: "bytes mean something else",
    MEANING: "same bytes, another sense",
    SOURCE: "generated names and types change",
    TEXT: "words only",
}
