"""ICDs after errata, for machines and for people: ``icdgen show``."""
