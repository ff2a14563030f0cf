"""The commands of ``icdgen``: options, one call into the library, printing. No logic."""
