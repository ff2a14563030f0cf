"""Recognition of pasted frames: spelling, node, message and direction.

It removes framing and checksums with the Python runtime. Importing this package makes
the runtime importable.
"""

from icdgen import shipped

shipped.provide_runtime()

from icdgen.recognize.frames import recognize  # noqa: E402
from icdgen.recognize.pasted import Pasted, read  # noqa: E402
from icdgen.recognize.reading import Reading  # noqa: E402

__all__ = ["Pasted", "Reading", "read", "recognize"]
