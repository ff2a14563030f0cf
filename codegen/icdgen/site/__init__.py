"""The documentation site as a whole: made in memory, written to a folder, or served."""

from __future__ import annotations

from icdgen.site.make import Site, make, write
from icdgen.site.serve import serve

__all__ = ["Site", "make", "serve", "write"]
