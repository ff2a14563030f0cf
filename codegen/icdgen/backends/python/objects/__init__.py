"""What a generated package of Python has, as objects: `links.link_of` gives the ``LINK`` of a node without generating anything.

So the tool itself talks to devices by the runtime that users get. Importing this makes that importable, as ``icdgen_runtime``,
from where it lies in the checkout or in the wheel.
"""

from icdgen import shipped

shipped.provide_runtime()
