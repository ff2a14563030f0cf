"""From a checked model to files on disk: what is written, kept, removed, and what need not run at all."""
