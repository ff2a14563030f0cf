"""Declared protocol facts in the notation of each language."""
