"""Documentation site of ICDs: rendered in memory, written to a folder, or served over
HTTP.
"""

from __future__ import annotations

from icdgen.site.make import Site, make_site, write_site
from icdgen.site.serve import serve

__all__ = ["Site", "make_site", "serve", "write_site"]
