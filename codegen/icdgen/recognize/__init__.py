"""Frames as people paste them: spelling, node, message and direction are found, framing and checksums come off.

Framing, CAN packets and checksums are those of the Python runtime, which importing this makes importable.
"""

from icdgen import shipped

shipped.provide_runtime()

from icdgen.recognize.frames import recognize  # noqa: E402
from icdgen.recognize.pasted import Pasted, read  # noqa: E402
from icdgen.recognize.reading import Reading  # noqa: E402

__all__ = ["Pasted", "Reading", "read", "recognize"]
