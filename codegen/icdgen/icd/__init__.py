"""The ICD: files, checks and the model of one device interface."""
