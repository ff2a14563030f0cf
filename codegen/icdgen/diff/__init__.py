"""Two sets of ICDs -> what changed between them, on which layer, how badly, and for whom."""
