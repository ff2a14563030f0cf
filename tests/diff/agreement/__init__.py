"""The diff and the generated code agree about what changed on the wire."""
