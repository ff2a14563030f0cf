"""The front of every testee: parses JSON, looks up names, validates requests and
refuses bad ones.

It is written once for all languages. The program of a language only implements the
primitives of ``README.md``: lines of words, indices and hex.
"""

from tests.conformance.front.front import Front

__all__ = ["Front"]
