"""An older release of the shipped ICDs, reconstructed from ``reconstruction.yaml``."""
