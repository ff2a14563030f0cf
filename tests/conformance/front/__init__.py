"""The front of every testee: JSON, look-up, validation and refusals, once for all
languages.

What it asks of the program of a language are the few primitives of ``README.md``: lines
of words, indices and hex.
"""

from tests.conformance.front.front import Front

__all__ = ["Front"]
