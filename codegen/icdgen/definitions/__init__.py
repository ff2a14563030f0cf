"""Definitions of messages that exist, in the forms that others have given them -> ICDs. One reader a kind: see `kinds`."""
