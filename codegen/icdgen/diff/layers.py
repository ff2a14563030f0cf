"""Layers of changes, in descending order of severity: the first digit of a code of the
diff (DIF1xx to DIF4xx) is the position of its layer.
"""

from __future__ import annotations

WIRE, MEANING, SOURCE, TEXT = "wire", "meaning", "source", "text"
LAYERS = (WIRE, MEANING, SOURCE, TEXT)  # most severe first
ABOUT = {
    WIRE: "values are at other bits or are read differently",
    MEANING: "the raw values are the same, their meaning differs",
    SOURCE: "generated names and types change",
    TEXT: "words only",
}
