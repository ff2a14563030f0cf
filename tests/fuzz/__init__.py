"""Fuzz harnesses on the dispatchers of all languages.

``python -m tests.fuzz c --seconds 600``; see ``README.md``.
"""
