"""Text and JSON forms of ICDs with their errata applied, for ``icdgen show``."""
