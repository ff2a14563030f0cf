"""An older release of the shipped ICDs, reconstructed: see ``reconstruction.yaml``."""
