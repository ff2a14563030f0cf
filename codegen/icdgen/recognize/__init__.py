"""Recognition of pasted frames: spelling, node, message and direction.

`recognize` returns the messages in a text or in received bytes. ``pasted`` turns a text
into bytes or CAN packets; ``frames`` then tries the framings of the ICD: ``framed`` for
links with a packet format, ``bus`` for CAN, ``match`` for an id and data alone.
``faults`` explains packets that cannot be decoded.

Framing and checksums are removed by the Python runtime. Importing this package makes
the runtime importable.
"""

from icdgen import shipped

shipped.provide_runtime()

from icdgen.recognize.frames import recognize  # noqa: E402
from icdgen.recognize.pasted import Pasted, read_pasted  # noqa: E402
from icdgen.recognize.reading import FrameReading  # noqa: E402

__all__ = ["FrameReading", "Pasted", "read_pasted", "recognize"]
