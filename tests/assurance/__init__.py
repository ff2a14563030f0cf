"""The papers for a review: what they say is so."""
