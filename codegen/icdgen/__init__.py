"""icdgen: code, vectors and documentation from validated interface control documents
(ICDs).
"""

__version__ = "0.5.0"
