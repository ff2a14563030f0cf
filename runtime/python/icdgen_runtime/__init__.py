"""What generated messages run on. Its modules are copied into every generated package, beside its nodes."""
